"""What a sweep runs: a base case and points, each a set of changes by dotted key."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

from scipy.stats import qmc

from ddf.case import Case, load_case

MAX_CASES = 2000
DIGITS = 6  # of drawn values
LONGEST_NAME = 60


@dataclass(frozen=True)
class Point:
    """One case of a sweep: its name (a folder's) and what it changes."""

    name: str
    changes: dict[str, Any]


@dataclass(frozen=True)
class Plan:
    """A sweep that can be run."""

    title: str
    case: Path
    points: tuple[Point, ...]
    common: tuple[str, ...] = ()  # changes of all cases, as "key=value"
    threads: int | None = None  # of each case; None: shared out
    workers: int | None = None  # cases at once

    def load(self, point: Point) -> Case:
        """The case of a point. Raises CaseError."""
        return load_case(self.case, [*self.common, *assignments(point.changes)])


@dataclass(frozen=True)
class Range:
    """Values between two bounds, evenly or by their logarithm."""

    low: float
    high: float
    log: bool = False

    def at(self, share: float) -> float:
        """The value at a share 0..1 of the way, to DIGITS digits."""
        value = self.low * (self.high / self.low) ** share if self.log else self.low + share * (self.high - self.low)
        return float(f"{value:.{DIGITS}g}")


@dataclass
class _Names:
    """Names that are free of anything but letters, digits, '.', '_' and '-', each given once."""

    taken: set[str] = field(default_factory=set)

    def give(self, wanted: str) -> str:
        plain = re.sub(r"[^A-Za-z0-9._-]+", "-", wanted).strip("-.")[:LONGEST_NAME] or "case"
        name, copy = plain, 1
        while name.casefold() in self.taken:
            copy += 1
            name = f"{plain}-{copy}"
        self.taken.add(name.casefold())
        return name


def grid_points(values: Mapping[str, Sequence[Any]]) -> tuple[Point, ...]:
    """Every combination of the keys' values, the last key fastest."""
    return named_points([dict(zip(values, choice, strict=True)) for choice in product(*values.values())])


def latin_points(ranges: Mapping[str, Range], samples: int, seed: int) -> tuple[Point, ...]:
    """Latin hypercube: each key's range in `samples` equal parts, each part drawn from once (McKay et al. 1979)."""
    shares = qmc.LatinHypercube(len(ranges), seed=seed).random(samples)
    return named_points([
        {key: span.at(float(share)) for (key, span), share in zip(ranges.items(), row, strict=True)} for row in shares
    ])  # fmt: skip


def named_points(changes: Sequence[Mapping[str, Any]]) -> tuple[Point, ...]:
    """Points numbered and named by what differs."""
    names = _Names()
    width = len(str(len(changes)))
    points = []
    for number, change in enumerate(changes, start=1):
        parts = [f"{key.rsplit('.', 1)[-1]}-{_short(value)}" for key, value in change.items() if _short(value)]
        points.append(Point(names.give("-".join([f"{number:0{width}d}", *parts])), dict(change)))
    return tuple(points)


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else \
        value if isinstance(value, str) and len(value) < 20 else ""  # fmt: skip


def assignments(changes: Mapping[str, Any]) -> list[str]:
    """Changes as `ddf run --set` takes them: key=value, the value as TOML."""
    return [f"{key}={inline(value)}" for key, value in changes.items()]


def inline(value: Any) -> str:
    """A value as TOML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k)} = {inline(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(inline(item) for item in value) + "]"
    if isinstance(value, str | bool):
        return json.dumps(value)
    return repr(value)


def _key(text: str) -> str:
    return text if re.fullmatch(r"[A-Za-z0-9_-]+", text) else json.dumps(text)


def scalar_keys(points: Sequence[Point]) -> list[str]:
    """Keys that points set to numbers or text, in order of appearance."""
    found = {key: None for point in points for key, value in point.changes.items()
             if isinstance(value, bool | int | float | str)}  # fmt: skip
    return list(found)
