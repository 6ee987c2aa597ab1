"""A map of a limit: spots in a plane of two settings, each with a verdict, and the documented rule as lines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

STABLE, REFUSED, STOPPED, WARNED, WRONG = "stable", "refused", "stopped", "warned", "wrong"
#: verdicts and what they mean, in the order of legends
VERDICTS = {
    STABLE: "right",
    REFUSED: "refused before the run",
    STOPPED: "stopped by a guard",
    WARNED: "warned of",
    WRONG: "wrong, and no guard saw it",
}
CAUGHT = (REFUSED, STOPPED, WARNED)


@dataclass(frozen=True)
class Spot:
    """One point of a map."""

    x: float
    y: float
    safe: bool  # by the documented rule
    verdict: str
    measure: float  # what the map measures, see `Map.measure`
    guard: str = ""  # what refused, stopped or warned


@dataclass(frozen=True)
class RuleLine:
    """A line of the documented rule in the map."""

    name: str
    x: FloatArray
    y: FloatArray


@dataclass(frozen=True)
class Map:
    """The spots of a limit."""

    x_label: str
    y_label: str
    measure: str  # what is measured at each spot, with its unit
    spots: tuple[Spot, ...]
    lines: tuple[RuleLine, ...]
    log_x: bool = True
    log_y: bool = True
    symlog_x: float = 0.0  # x logarithmic from here on, with 0 on the axis
    notes: tuple[str, ...] = ()

    @property
    def failures(self) -> list[str]:
        """What should not be: safe spots that are not right, and failing ones that no guard sees."""
        bad = [s for s in self.spots if s.verdict == WRONG or (s.safe and s.verdict != STABLE)]
        return [
            f"{self.x_label} {s.x:.3g}, {self.y_label} {s.y:.3g}: {s.verdict}{' though the rule says safe' * s.safe}"
            f"{f' ({s.guard})' if s.guard else ''}, {self.measure} {s.measure:.3g}"
            for s in bad
        ]


@dataclass(frozen=True)
class Limit:
    """A limit of the method by its name on the command line."""

    name: str
    title: str
    rule: str  # the documented rule in words
    chart: Callable[[bool], Map] = field(repr=False)  # quick: few points


def judge(right: bool, kind: str, guard: str) -> tuple[str, str]:
    """Verdict and guard of a spot: a guard that spoke comes before what the result is."""
    if guard:
        return kind, guard
    return (STABLE if right else WRONG), ""


def grid(xs: tuple[float, ...], ys: tuple[float, ...]) -> list[tuple[float, float]]:
    """All pairs."""
    return [(x, y) for y in ys for x in xs]
