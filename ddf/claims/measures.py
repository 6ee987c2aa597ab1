"""Measures of wrinkles that do not depend on the grid: directions, severity, sites; and what chance would give."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ddf.claims.formed import Formed, FormedPly, Row
from ddf.compare.sites import apart, chord

Array = NDArray[np.float64]

RADIAL_CHANCE_DEG = 45.0  # mean angle of random directions to the radius
FIBRE_CHANCE_DEG = 22.5  # of random directions to the nearer of two square families
FOUR_FIBRES_CHANCE_DEG = 11.25  # to the nearest of four families 45 deg apart
ONE_SIDED_5_PERCENT = 1.645  # standard deviations of a normal distribution
SITE_REACH_MM = 15.0  # wrinkles farther apart are not at one site
SITE_TURN_DEG = 30.0  # nor are those that run more across each other
TURN_STEP_DEG = 5.0  # of the turned wrinkles that say what chance gives
DRAWS = 2000  # random patterns
DIRECTION_REACH_DEG = 15.0  # a wrinkle runs along a flat fibre direction within this


@dataclass(frozen=True)
class Severity:
    """How severe the wrinkles of some plies are."""

    ridge_mm2: float  # sum of length times mean amplitude
    largest_mm: float  # largest amplitude
    area_percent: float  # wrinkled share of the plies' area


def severity(plies: Sequence[FormedPly]) -> Severity:
    """Severity of plies together: ridges summed, the largest amplitude, mean share of area."""
    rows = [row for ply in plies for row in ply.wrinkles]
    return Severity(
        float(sum(row["length_mm"] * row["mean_amplitude_mm"] for row in rows)),
        float(max((row["amplitude_mm"] for row in rows), default=0.0)),
        float(np.mean([ply.wrinkled_percent for ply in plies])),
    )


def mean_by_length(rows: Sequence[Row], values: Sequence[float]) -> float:
    """Mean weighted by the wrinkles' lengths; NaN where there are none."""
    weights = np.array([row["length_mm"] for row in rows])
    return float((weights * np.array(values)).sum() / weights.sum()) if len(rows) else math.nan


def below_chance(rows: Sequence[Row], chance_deg: float) -> float:
    """Mean angle [deg] that says the wrinkles keep to a direction: half of chance, or less where they are few.

    Angles of random lines are even over 0 .. 2 chance; their weighted mean has the standard deviation
    2 chance/sqrt(12) sqrt(sum w^2)/sum w. The bound is never above its lower 5 %.
    """
    weights = np.array([row["length_mm"] for row in rows])
    if not len(rows):
        return 0.5 * chance_deg
    deviation = 2 * chance_deg / math.sqrt(12.0) * float(np.sqrt((weights**2).sum()) / weights.sum())
    return min(0.5 * chance_deg, chance_deg - ONE_SIDED_5_PERCENT * deviation)


def radial_angle(rows: Sequence[Row]) -> float:
    """Mean angle in plan between wrinkle and radius from the tool's axis, by length [deg]."""
    return mean_by_length(rows, [row["angle_to_radial_deg"] for row in rows])


def own_fibre_angle(rows: Sequence[Row]) -> float:
    """Mean angle between wrinkle and the nearer family of its own ply, by length [deg]."""
    return mean_by_length(rows, [_own(row) for row in rows])


def any_fibre_angle(plies: Sequence[FormedPly]) -> float:
    """Mean angle between wrinkle and the nearest family of any ply of the stack, by length [deg]."""
    rows, angles = [], []
    for ply in plies:
        others = [other for other in plies if other is not ply]
        for row in ply.wrinkles:
            rows.append(row)
            angles.append(min([_own(row), *(angle_to_fibres(row, other) for other in others)]))
    return mean_by_length(rows, angles)


def _own(row: Row) -> float:
    return float(min(row["angle_to_family_1_deg"], row["angle_to_family_2_deg"]))


def angle_to_fibres(row: Row, ply: FormedPly) -> float:
    """Smallest angle [deg] of a wrinkle of another ply to the fibres of this one, along the wrinkle in plan.

    The fibres are those at the nodes nearest in plan to points on the wrinkle's chord; mean over these points.
    """
    x = ply.surface.x
    steps = [np.gradient(x[:2], axis=axis) for axis in (1, 2)]
    known = np.isfinite(x[0]) & np.isfinite(steps[0][0]) & np.isfinite(steps[1][0])
    points = chord(row)
    nearest = cKDTree(x[:2, known].T).query(points)[1]
    line = points[-1] - points[0]
    angles = []
    for step in steps:
        fibre = step[:, known][:, nearest]
        cross, dot = line[0] * fibre[1] - line[1] * fibre[0], line @ fibre
        angles.append(np.degrees(np.arctan2(np.abs(cross), np.abs(dot))))
    return float(np.minimum(*angles).mean())


def directions_with_wrinkles(run: Formed) -> tuple[int, int]:
    """How many of the plies' flat fibre directions have a radial wrinkle along them, and how many there are."""
    directions = sorted({round(angle, 1) % 180.0 for ply in run.plies for angle in ply.fibre_directions_deg})
    radial = [row for row in run.wrinkles if row["angle_to_radial_deg"] <= SITE_TURN_DEG]
    found = [
        any(_turned_apart(row["direction_deg"], angle) <= DIRECTION_REACH_DEG for row in radial)
        for angle in directions
    ]  # fmt: skip
    return sum(found), len(directions)


def same_site(first: Row, second: Row) -> bool:
    """Whether two wrinkles, of whatever plies, are at one site: near in plan and much the same way."""
    turned = _turned_apart(first["direction_deg"], second["direction_deg"])
    return turned <= SITE_TURN_DEG and apart(first, second) <= SITE_REACH_MM


def share_found(rows: Sequence[Row], among: Sequence[Sequence[Row]]) -> float:
    """Share of the length of wrinkles that have one at their site, mean over the patterns of `among`; NaN for none."""
    found = [[any(same_site(row, other) for other in pattern) for pattern in among] for row in rows]
    return mean_by_length(rows, [float(np.mean(there)) for there in found])


def share_by_chance(
    rows: Sequence[Row], among: Sequence[Sequence[Row]], axis: tuple[float, float], seed: int = 0
) -> float:
    """Share found that 95 of 100 random patterns do not exceed, mean over the patterns of `among`.

    Random: each wrinkle of `among` turned about the axis by an angle of its own, so it stays as long, as radial and as
    far out. (Patterns turned as a whole would say little: eight rays turned by 45 deg are the same eight.)
    """
    if not rows or not any(among):
        return 0.0
    weights = np.array([row["length_mm"] for row in rows])
    turns = np.arange(0.0, 360.0, TURN_STEP_DEG)
    random = np.random.default_rng(seed)
    shares = np.zeros(DRAWS)
    for pattern in among:
        found = np.zeros((DRAWS, len(rows)), dtype=bool)
        for other in pattern:
            turned = [turned_row(other, turn, axis) for turn in turns]
            meets = np.array([[same_site(row, one) for row in rows] for one in turned])
            found |= meets[random.integers(len(turns), size=DRAWS)]
        shares += (found * weights).sum(axis=1) / weights.sum() / len(among)
    return float(np.quantile(shares, 0.95))


def amplitude_ratios(rows: Sequence[Row], among: Sequence[Row]) -> list[float]:
    """Largest amplitude of `among` at the site of each wrinkle over its own, where there is one."""
    ratios = []
    for row in rows:
        there = [other["amplitude_mm"] for other in among if same_site(row, other)]
        if there:
            ratios.append(max(there) / row["amplitude_mm"])
    return ratios


def turned_row(row: Row, turn_deg: float, axis: tuple[float, float]) -> Row:
    """The wrinkle turned about the axis."""
    c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    turned = dict(row)
    for end in ("start", "end"):
        x, y = row[f"{end}_x_mm"] - axis[0], row[f"{end}_y_mm"] - axis[1]
        turned[f"{end}_x_mm"], turned[f"{end}_y_mm"] = axis[0] + c * x - s * y, axis[1] + s * x + c * y
    turned["direction_deg"] = row["direction_deg"] + turn_deg
    return turned


def _turned_apart(first_deg: float, second_deg: float) -> float:
    """Angle between two undirected lines, 0 to 90 deg."""
    return abs((first_deg - second_deg + 90.0) % 180.0 - 90.0)
