"""The rungs of a speed-accuracy study: settings of a case along its axes, as the points of a sweep.

The finest rung has the last value of every axis. Designs: "star", each other value of an axis by itself on the case as
it is; "cross", that, the cheaper values with every element size too, and with each size all that saves steps at once;
"grid", all combinations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import product
from typing import Any

from ddf.case import Case
from ddf.errors import UsageError
from ddf.study.axes import AXES, Axis, Value
from ddf.sweep.plan import Point

DESIGNS = ("cross", "star", "grid")
FINEST = "finest"
ELEMENT = "element"

Setting = tuple[tuple[str, Value], ...]  # of each axis in turn


@dataclass(frozen=True)
class Rung:
    """A point of the study: its name, and its value on each axis."""

    name: str
    setting: dict[str, Value]
    changes: dict[str, Any]

    @property
    def point(self) -> Point:
        """The rung as a sweep runs it."""
        return Point(self.name, self.changes)


def chosen_axes(names: Sequence[str], values: Mapping[str, Sequence[str]], quick: bool) -> dict[str, tuple[Value, ...]]:
    """Values of each axis asked for (none: all), cheapest first; `quick`: its cheapest and the case's own alone.

    values: those given by hand. Raises UsageError for unknown axes and values.
    """
    for name in (*names, *values):
        if name not in AXES:
            near = get_close_matches(name, AXES, n=1)
            hint = f"did you mean {near[0]}? " if near else ""
            raise UsageError(f"no axis is called {name!r}", f"{hint}axes: {', '.join(AXES)}")
    wanted = [name for name in AXES if not names or name in names or name in values]
    return {name: _values(AXES[name], values.get(name), quick) for name in wanted}


def _values(axis: Axis, given: Sequence[str] | None, quick: bool) -> tuple[Value, ...]:
    if given is not None:
        return tuple(_value(axis, text) for text in given)
    if quick and not axis.choices:
        return (axis.values[0], 1.0)
    return axis.values


def _value(axis: Axis, text: str) -> Value:
    if axis.choices:
        if text not in axis.choices:
            raise UsageError(f"{axis.name} cannot be {text!r}", f"one of {', '.join(axis.choices)}")
        return text
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < 1e3:
        raise UsageError(f"{axis.name} cannot be {text!r}", "a factor on the case's own setting, such as 0.5")
    return value


def make_rungs(case: Case, axes: Mapping[str, Sequence[Value]], design: str) -> list[Rung]:
    """The rungs of a design, the finest first."""
    own: dict[str, Value] = {name: AXES[name].own(case) for name in axes}
    settings = dict.fromkeys([_key(own | {name: values[-1] for name, values in axes.items()})])
    settings |= dict.fromkeys(_key(setting) for setting in _settings(own, axes, design))
    rungs = []
    for number, key in enumerate(settings):
        setting = dict(key)
        rungs.append(Rung(FINEST if number == 0 else _name(case, setting, own), setting, _changes(case, setting, own)))
    return rungs


def _settings(own: dict[str, Value], axes: Mapping[str, Sequence[Value]], design: str) -> Iterator[dict[str, Value]]:
    if design == "grid":
        yield from (dict(zip(axes, values, strict=True)) for values in product(*axes.values()))
        return
    sizes = axes.get(ELEMENT, ())
    others = {name: values for name, values in axes.items() if name != ELEMENT}
    bases = [own | {ELEMENT: size} for size in sizes] if sizes else [own]
    yield from bases
    for base in bases if design == "cross" else [own]:
        for name, values in others.items():
            at = values.index(own[name]) if own[name] in values else len(values)
            tried = values if base == own else values[:at]
            if AXES[name].crossed or design == "star" or base is bases[0]:
                yield from (base | {name: value} for value in tried if value != own[name])
        if design == "cross":
            yield base | _fast(others)


def _fast(axes: Mapping[str, Sequence[Value]]) -> dict[str, Value]:
    """The cheapest values of all axes that save steps."""
    return {name: values[0] for name, values in axes.items() if AXES[name].saves_steps}


def _key(setting: dict[str, Value]) -> Setting:
    return tuple(setting.items())


def _changes(case: Case, setting: dict[str, Value], own: dict[str, Value]) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    for name, value in setting.items():
        if value != own[name]:
            changes |= AXES[name].change(case, value, changes)
    return changes


def _name(case: Case, setting: dict[str, Value], own: dict[str, Value]) -> str:
    """What differs from the case, as a folder's name; the element size always."""
    shown = {ELEMENT: own.get(ELEMENT, 1.0)} | setting
    parts = [AXES[name].label(case, value) for name, value in shown.items()
             if name == ELEMENT or value != own[name]]  # fmt: skip
    return "_".join(parts)
