"""Wrinkles of two runs matched site by site."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

Array = NDArray[np.float64]
Row = dict[str, Any]

REACH_MM, ASTRIDE_DEG = 25.0, 45.0  # wrinkles farther apart, or that cross at more, are not the same site
SAMPLES = 11


@dataclass(frozen=True)
class Site:
    """A wrinkle site: the wrinkle of either run (a row of wrinkles.csv), None where a run has none there."""

    ply: str
    first: Row | None
    second: Row | None
    distance_mm: float | None  # between the two in plan, see `apart`

    def row(self) -> Row:
        """The site as a flat row of a table."""
        values: Row = {"ply": self.ply}
        for key, wrinkle in (("a", self.first), ("b", self.second)):
            values[f"number_{key}"] = None if wrinkle is None else wrinkle["number"]
        values["distance_mm"] = self.distance_mm
        for name in ("length_mm", "amplitude_mm", "direction_deg"):
            for key, wrinkle in (("a", self.first), ("b", self.second)):
                values[f"{name.replace('_', f'_{key}_', 1)}"] = None if wrinkle is None else wrinkle[name]
        return values


def chord(wrinkle: Row) -> Array:
    """Points (SAMPLES, 2) along the straight line from a wrinkle's start to its end, in plan."""
    ends = np.array([[wrinkle[f"{end}_{axis}_mm"] for axis in "xy"] for end in ("start", "end")])
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    points: Array = (1 - share) * ends[0] + share * ends[1]
    return points


def apart(first: Row, second: Row) -> float:
    """Mean distance in plan [mm] of the shorter chord's points from the longer chord: 0 for a part of it."""
    a, b = sorted((chord(first), chord(second)), key=lambda points: float(np.linalg.norm(points[-1] - points[0])))
    edge = b[-1] - b[0]
    share = np.clip(((a - b[0]) @ edge) / max(float(edge @ edge), 1e-300), 0.0, 1.0)
    return float(np.linalg.norm(a - b[0] - share[:, None] * edge, axis=1).mean())


def across(first: Row, second: Row) -> float:
    """Angle between the directions of two wrinkles [deg], 0 to 90."""
    turn = abs(first["direction_deg"] - second["direction_deg"]) % 180.0
    return float(min(turn, 180.0 - turn))


def _cost(first: Row, second: Row) -> float:
    return apart(first, second) if across(first, second) <= ASTRIDE_DEG else np.inf


def match_wrinkles(ply: str, first: list[Row], second: list[Row], reach_mm: float = REACH_MM) -> list[Site]:
    """Pair the wrinkles of one ply one to one so that the distances sum to least, none over `reach_mm` or ASTRIDE_DEG.

    Pairs first, by falling amplitude; then the wrinkles that only one run has.
    """
    sites = []
    cost = np.array([[_cost(a, b) for b in second] for a in first]).reshape(len(first), len(second))
    # leaving a pair apart costs as much as a pair at the limit, so no pair beyond it is ever worth while
    rows, columns = linear_sum_assignment(np.minimum(cost, reach_mm)) if cost.size else ([], [])
    left, right = set(range(len(first))), set(range(len(second)))
    for i, j in zip(rows, columns, strict=True):
        if cost[i, j] < reach_mm:
            sites.append(Site(ply, first[i], second[j], float(cost[i, j])))
            left.discard(int(i))
            right.discard(int(j))
    sites.sort(key=lambda site: -max(site.first["amplitude_mm"], site.second["amplitude_mm"]))  # type: ignore[index]
    sites += [Site(ply, first[i], None, None) for i in sorted(left)]
    return sites + [Site(ply, None, second[j], None) for j in sorted(right)]
