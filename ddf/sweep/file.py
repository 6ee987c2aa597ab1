"""Sweep files: a base case and what to vary, checked with all faults at once."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, TypeGuard

from pydantic import Field, ValidationError

from ddf.case.base import Section
from ddf.case.faults import closest, shown
from ddf.case.load import parse_toml, read_text
from ddf.case.locate import Lines, locate
from ddf.case.words import KeyPath, properties, range_text, type_text
from ddf.errors import CaseError, Fault
from ddf.shipped import file_or_shipped
from ddf.sweep.plan import MAX_CASES, Plan, Point, Range, assignments, grid_points, latin_points, named_points

RANGE_KEYS = {"low", "high", "log"}


class SweepFile(Section):
    """A sweep file."""

    title: str = Field(default="", max_length=500, description="What the sweep is, for its pictures.")
    case: str = Field(
        min_length=1, description="The base case, relative to the sweep file, or a shipped one by its name."
    )
    method: Literal["grid", "list", "latin-hypercube"] = Field(
        description="'grid': every combination of [vary]'s lists; 'list': the [[points]]; 'latin-hypercube': "
        "`samples` draws from [vary]'s ranges {low, high, log}."
    )
    samples: int | None = Field(default=None, ge=1, le=MAX_CASES, description="Draws of a latin hypercube.")
    seed: int = Field(default=0, ge=0, description="Of the latin hypercube: the same seed, the same draws.")
    threads: int | None = Field(default=None, ge=1, le=1024, description="Threads of each case; left out: shared out.")
    workers: int | None = Field(default=None, ge=1, le=1024, description="Cases at once; left out: as cores allow.")
    set: dict[str, Any] = Field(default_factory=dict, description="Keys changed in all cases.")
    vary: dict[str, Any] = Field(default_factory=dict, description="Keys varied: lists, or ranges.")
    points: Annotated[tuple[dict[str, Any], ...], Field(strict=False, max_length=MAX_CASES)] = Field(
        default=(), description="Cases one by one: keys and an optional name."
    )


def load_sweep(path: Path, common: tuple[str, ...] = ()) -> Plan:
    """Read a sweep file and check it and every case it makes. Raises CaseError with every fault found.

    `common`: further changes of all cases, as "key=value", laid over the file's [set].
    """
    text = read_text(path, str(path))
    raw = parse_toml(text, str(path))
    lines = locate(text)
    file = _checked(raw, str(path), lines)
    faults = list(_misuse(file, str(path), lines))
    if faults:
        raise _error(faults)
    every = tuple(assignments(dict(_flat(file.set, ())))) + common
    case = file_or_shipped("cases", Path(os.path.abspath(path.parent / file.case)), file.case)
    plan = Plan(file.title or path.stem, case, _points(file), every, file.threads, file.workers)
    check_cases(plan, str(path), _key_lines(file, lines))
    return plan


def check_cases(plan: Plan, source: str, key_lines: dict[str, int]) -> None:
    """Load the case of every point; raises CaseError with all faults, at the line of the key that caused them."""
    faults: dict[Fault, None] = {}
    for point in plan.points:
        given = [*plan.common, *assignments(point.changes)]
        try:
            plan.load(point)
        except CaseError as error:
            for fault in error.faults:
                if fault.file == "--set" and fault.line <= len(given):
                    key = given[fault.line - 1].partition("=")[0]
                    at = key_lines.get(key, 1)
                    fault = Fault(source, at, fault.key, fault.problem, fault.allowed, fault.suggestion)
                faults[fault] = None
    if faults:
        raise _error(list(faults))


def _error(faults: list[Fault]) -> CaseError:
    return CaseError(sorted(set(faults), key=lambda fault: (fault.file, fault.line, fault.key)), "sweep")


def _checked(raw: dict[str, Any], file: str, lines: Lines) -> SweepFile:
    try:
        return SweepFile.model_validate(raw)
    except ValidationError as error:
        known = properties(SweepFile)
        faults = []
        for detail in error.errors(include_url=False):
            path: KeyPath = tuple(detail["loc"])
            key = str(path[0])
            at, node = lines.at(path), known.get(key, {})
            allowed = range_text(node) or (type_text(node) if node else "")
            if detail["type"] == "extra_forbidden":
                faults.append(Fault(file, at, key, "unknown key", ", ".join(known), closest(key, known)))
            elif detail["type"] == "missing":
                faults.append(Fault(file, 1, key, "required key is missing", allowed))
            else:
                near = closest(str(raw[key]), node.get("enum", ())) if isinstance(raw.get(key), str) else ""
                dotted = ".".join(str(part) for part in path)
                faults.append(Fault(file, at, dotted, f"{shown(detail['input'])} is not right", allowed, near))
        raise _error(faults) from None


def _misuse(file: SweepFile, source: str, lines: Lines) -> Iterator[Fault]:
    """Keys that do not go with the method, and what is varied in a way that makes no sense."""
    wanted = {"grid": {"vary"}, "list": {"points"}, "latin-hypercube": {"vary", "samples"}}[file.method]
    for key in ("vary", "points", "samples"):
        given = bool(getattr(file, key))
        if given != (key in wanted):
            problem = f"means nothing for the method {file.method!r}" if given else f"needed by {file.method!r}"
            yield Fault(source, lines.at((key,)), key, problem)
    count = 1
    for key, value, path in _varied(file):
        at = (source, lines.at(path), f"vary.{key}")
        if file.method == "grid" and (not isinstance(value, list) or not value):
            yield Fault(*at, f"{shown(value)} is nothing to go through", "a list of values")
        elif file.method == "grid":
            count *= len(value)
        elif file.method == "latin-hypercube":
            yield from _range_faults(value, at)
    if count > MAX_CASES:
        yield Fault(source, lines.at(("vary",)), "vary", f"makes {count} cases", f"<= {MAX_CASES}")
    names: dict[str, int] = {}
    for place, point in enumerate(file.points):
        name, where = point.get("name"), ("points", place, "name")
        if name is None:
            continue
        if not isinstance(name, str) or not name or _unsafe(name):
            yield Fault(source, lines.at(where), f"points.{place}.name", f"{shown(name)} is not a name",
                        "letters, digits, '.', '_' and '-'")  # fmt: skip
        elif names.setdefault(name.casefold(), place) != place:
            yield Fault(source, lines.at(where), f"points.{place}.name", f"{name!r} is taken", "a unique name")


def _unsafe(name: str) -> bool:
    return len(name) > 64 or not name[0].isalnum() or not all(c.isalnum() or c in "._-" for c in name) \
        or not name.isascii()  # fmt: skip


def _range_faults(value: Any, at: tuple[str, int, str]) -> Iterator[Fault]:
    allowed = "{low = number, high = larger number, log = true or false}"
    low, high = (value.get("low"), value.get("high")) if isinstance(value, dict) else (None, None)
    if not _is_number(low) or not _is_number(high):
        yield Fault(*at, f"{shown(value)} is not a range", allowed)
    elif not low < high:
        yield Fault(*at, f"{low:g} is not below {high:g}", allowed)
    elif value.get("log") and low <= 0:
        yield Fault(*at, f"a logarithmic range cannot start at {low:g}", "low > 0")


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _flat(tables: dict[str, Any], path: KeyPath) -> Iterator[tuple[str, Any]]:
    """Values by dotted key; quoted dotted keys and nested tables mean the same."""
    for key, value, _ in _leaves(tables, path, ""):
        yield key, value


def _leaves(tables: dict[str, Any], path: KeyPath, prefix: str) -> Iterator[tuple[str, Any, KeyPath]]:
    for name, value in tables.items():
        key = f"{prefix}{name}"
        if isinstance(value, dict) and not ("low" in value and set(value) <= RANGE_KEYS):
            yield from _leaves(value, (*path, name), f"{key}.")
        else:
            yield key, value, (*path, name)


def _varied(file: SweepFile) -> Iterator[tuple[str, Any, KeyPath]]:
    return _leaves(file.vary, ("vary",), "")


def _points(file: SweepFile) -> tuple[Point, ...]:
    if file.method == "grid":
        return grid_points({key: value for key, value, _ in _varied(file)})
    if file.method == "latin-hypercube":
        ranges = {key: Range(v["low"], v["high"], bool(v.get("log"))) for key, v, _ in _varied(file)}
        return latin_points(ranges, file.samples or 1, file.seed)
    changes = [dict(_flat({k: v for k, v in point.items() if k != "name"}, ())) for point in file.points]
    return tuple(
        Point(point.get("name", made.name), made.changes)
        for point, made in zip(file.points, named_points(changes), strict=True)
    )


def _key_lines(file: SweepFile, lines: Lines) -> dict[str, int]:
    """Line of every key that the file sets or varies."""
    found: dict[str, int] = {}
    sources = [(file.set, ("set",)), (file.vary, ("vary",))]
    sources += [(point, ("points", place)) for place, point in enumerate(file.points)]  # type: ignore[misc]
    for tables, path in sources:
        for key, _, where in _leaves(tables, path, ""):
            found.setdefault(key, lines.at(where))
    return found
