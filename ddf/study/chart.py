"""The chart of a speed-accuracy study: wall time against outline and wrinkle errors, the front as a line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from ddf.output import figures
from ddf.study.axes import AXES
from ddf.study.front import Result
from ddf.study.rungs import ELEMENT, FINEST

MARKERS = ("o", "s", "^", "v", "D", "P", "X", "*")
SEVERAL = "several at once"


def draw_study(title: str, results: Sequence[Result], front: Sequence[Result], chosen: Mapping[str, Result]) -> Any:
    """Two panels over the time of the steps. Points bear their number in the table, those of the front their name."""
    figure = figures.new_figure(13.0, 6.2)
    panels = figure.subplots(1, 2, sharex=True)
    finest = next(result for result in results if result.rung.name == FINEST)
    groups = _groups(results)
    for axes, key, label in zip(
        panels, ("outline_mean_mm", "wrinkle_amplitude_mm"),
        ("outline, mean distance from the finest [mm]", "wrinkle amplitude, rms difference from the finest [mm]"),
        strict=True,
    ):  # fmt: skip
        least = _floor(results, key)
        for number, (group, members) in enumerate(groups.items()):
            points = [(r.pair[0], max(value, least)) for r in members if (value := _value(r, key)) is not None]
            if points:
                axes.scatter(*zip(*points, strict=True), s=34, marker=MARKERS[number % len(MARKERS)], label=group,
                             color=figures.COLOURS[number % len(figures.COLOURS)], zorder=3, linewidths=0)  # fmt: skip
        for number, result in enumerate(results):
            value = _value(result, key)
            if value is not None and result is not finest:
                _label(axes, (result.pair[0], max(value, least)), str(number), result in front)
        axes.axvline(finest.pair[0], color=figures.MUTED, linewidth=1, linestyle=":")
        axes.set(xscale="log", yscale="log")
        for axis in (axes.xaxis, axes.yaxis):
            figures.label_logarithmic(axis)
        axes.margins(0.12)
        axes.set_xlabel("wall time of the steps [s]", fontsize=figures.LABEL_PT)
        axes.set_ylabel(label, fontsize=figures.LABEL_PT)
        axes.grid(color="#e5e8eb", linewidth=0.6, which="both")
        axes.tick_params(colors=figures.MUTED, labelsize=figures.NOTE_PT, which="both")
        axes.spines[["top", "right"]].set_visible(False)
    _front(panels[0], results, front, chosen)
    figure.suptitle(title, x=0.01, ha="left", fontsize=figures.TITLE_PT, color=figures.INK)
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=min(5, len(names)), fontsize=figures.NOTE_PT,
                  frameon=False, title="changed beside the element size", title_fontsize=figures.NOTE_PT)  # fmt: skip
    return figure


def _value(result: Result, key: str) -> float | None:
    """An error of a rung that can be drawn; None for the finest and those without one."""
    if result.errors is None or result.cost is None or result.rung.name == FINEST:
        return None
    value = float(getattr(result.errors, key))
    return value if math.isfinite(value) else None


def _floor(results: Sequence[Result], key: str) -> float:
    """Errors of nothing are drawn at a third of the least other one."""
    known = [value for result in results if (value := _value(result, key))]
    return min(known, default=1.0) / 3.0


def _groups(results: Sequence[Result]) -> dict[str, list[Result]]:
    """Rungs by the axis on which they leave the case beside the element size."""
    groups: dict[str, list[Result]] = {}
    usual = {name: _commonest([r.rung.setting.get(name) for r in results]) for name in AXES}
    for result in results:
        changed = [name for name, value in result.rung.setting.items() if name != ELEMENT and value != usual[name]]
        group = "nothing" if not changed else changed[0] if len(changed) == 1 else SEVERAL
        groups.setdefault(group, []).append(result)
    return groups


def _commonest(values: list[Any]) -> Any:
    return max(values, key=values.count)


def _label(axes: Any, place: tuple[float, float], text: str, strong: bool) -> None:
    weight, colour = ("bold", figures.INK) if strong else ("normal", figures.MUTED)
    axes.annotate(text, place, (4, 4), textcoords="offset points", fontsize=8, color=colour, fontweight=weight)


def _front(axes: Any, results: Sequence[Result], front: Sequence[Result], chosen: Mapping[str, Result]) -> None:
    """The front as a line on the panel of the outline, with the recommended rungs' uses."""
    least = _floor(results, "outline_mean_mm")
    points = [(r.pair[0], max(r.pair[1], least)) for r in front]
    if points:
        axes.plot(*zip(*points, strict=True), color=figures.INK, linewidth=1.2, zorder=2, label="front")
    uses: dict[int, list[str]] = {}
    for use, result in chosen.items():
        uses.setdefault(front.index(result), []).append(use)
    middle = math.sqrt(points[0][0] * points[-1][0]) if points else 0.0
    for k, names in uses.items():
        left = points[k][0] <= middle
        axes.annotate(
            f"{', '.join(names)}: {front[k].rung.name}", points[k], (14 if left else -14, 30), fontsize=9,
            textcoords="offset points", ha="left" if left else "right", color=figures.INK,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
            arrowprops={"arrowstyle": "-", "color": figures.MUTED, "linewidth": 0.6},
        )  # fmt: skip
