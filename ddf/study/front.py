"""The Pareto front of time and error, and the rung to recommend for each use."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ddf.study.accuracy import TELLING, Cost, Errors
from ddf.study.rungs import FINEST, Rung

#: uses and the wall time of the steps that each may take [s]
USES = (("look", "in seconds", 10.0), ("design", "in a minute", 60.0), ("publish", "", math.inf))
CLOSE_ENOUGH = 2.0
"""To publish, a rung is as good as the best if its error is at most this many times the least, and it is faster."""


@dataclass(frozen=True)
class Result:
    """A rung that ran, or why it did not finish."""

    rung: Rung
    state: str
    reason: str = ""
    cost: Cost | None = None
    errors: Errors | None = None
    warnings: tuple[str, ...] = ()  # checks of the audit that failed

    @property
    def sound(self) -> bool:
        """Whether it finished, at rest and with its energy in balance."""
        return self.errors is not None and not set(self.warnings) & set(TELLING)

    @property
    def pair(self) -> tuple[float, float]:
        """Wall time of the steps [s] and mean outline distance [mm]."""
        if self.cost is None or self.errors is None:
            return math.inf, math.inf
        return self.cost.steps_s, self.errors.outline_mean_mm


def pareto_front(results: Sequence[Result]) -> list[Result]:
    """Sound results, the finest left out, that no other one beats in both time and outline; fastest first."""
    judged = [r for r in results if r.sound and r.rung.name != FINEST and math.isfinite(r.pair[1])]
    front: list[Result] = []
    for result in sorted(judged, key=lambda r: r.pair):
        if not front or result.pair[1] < front[-1].pair[1]:
            front.append(result)
    return front


def recommended(front: Sequence[Result]) -> dict[str, Result]:
    """For each use the front's least error within its time (the fastest where none is); to publish, the fastest that
    is close to the least of all.
    """
    if not front:
        return {}
    chosen = {}
    for use, _, budget in USES:
        within = [r for r in front if r.pair[0] <= budget] or [front[0]]
        if math.isinf(budget):
            within = [next(r for r in front if r.pair[1] <= CLOSE_ENOUGH * front[-1].pair[1])]
        chosen[use] = within[-1]
    return chosen
