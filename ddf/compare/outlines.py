"""Distances between outlines in plan, and the rigid motion that lays measured points best on an outline."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ddf.errors import UsageError

Array = NDArray[np.float64]

SAMPLE_MM = 1.0  # between the points that distances are taken at
STARTS = 12  # rotations from which the fit begins
FIT_SAMPLE_MM = 0.2  # between the points of the outline that the fit goes by
CHUNK = 512


@dataclass(frozen=True)
class Distances:
    """How far two outlines are apart in plan [mm]."""

    mean_mm: float
    largest_mm: float
    largest_at: tuple[float, float]  # point of the first outline, or of the second, that is farthest


@dataclass(frozen=True)
class RigidFit:
    """A turn about the origin, then a shift: p -> R p + t."""

    turn_deg: float
    shift_mm: tuple[float, float]

    def apply(self, points: Array) -> Array:
        """Points (k, 2) after the motion."""
        moved: Array = points @ _turn(np.radians(self.turn_deg)).T + np.array(self.shift_mm)
        return moved


def along(loops: list[Array], step_mm: float = SAMPLE_MM) -> Array:
    """Points (k, 2) evenly along closed loops, `step_mm` apart or a little less."""
    parts = []
    for loop in loops:
        closed = np.vstack([loop, loop[:1]])
        arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
        places = np.arange(max(3, int(np.ceil(arc[-1] / step_mm)))) / max(3, int(np.ceil(arc[-1] / step_mm)))
        parts.append(np.stack([np.interp(places * arc[-1], arc, column) for column in closed.T], axis=1))
    return np.concatenate(parts)


def nearest(points: Array, loops: list[Array]) -> Array:
    """The nearest point of closed loops to each of points (k, 2), as (k, 2)."""
    starts = np.concatenate(loops)
    edges = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops]) - starts
    square = np.maximum((edges**2).sum(axis=1), 1e-300)
    found = np.empty_like(points)
    for low in range(0, len(points), CHUNK):
        p = points[low : low + CHUNK, None]
        share = np.clip(((p - starts) * edges).sum(axis=2) / square, 0.0, 1.0)
        feet = starts + share[..., None] * edges
        best = ((p - feet) ** 2).sum(axis=2).argmin(axis=1)
        found[low : low + CHUNK] = feet[np.arange(len(feet)), best]
    return found


def outline_distances(first: list[Array], second: list[Array]) -> Distances:
    """Distance of every point of each outline from the other: mean over both, and the largest (Hausdorff)."""
    points = [along(first), along(second)]
    away = [np.linalg.norm(points[0] - nearest(points[0], second), axis=1),
            np.linalg.norm(points[1] - nearest(points[1], first), axis=1)]  # fmt: skip
    return _distances(np.concatenate(points), np.concatenate(away))


def point_distances(points: Array, loops: list[Array]) -> Distances:
    """Distance of measured points (k, 2) from an outline; parts of the outline nobody measured do not count."""
    return _distances(points, np.linalg.norm(points - nearest(points, loops), axis=1))


def _distances(points: Array, away: Array) -> Distances:
    k = int(away.argmax())
    return Distances(float(away.mean()), float(away[k]), (float(points[k, 0]), float(points[k, 1])))


def fit_points(points: Array, loops: list[Array]) -> RigidFit:
    """The turn and shift that bring points (k, 2) closest to an outline (least squares).

    Iterated closest points (Besl and McKay 1992) from several turns about the middle, on the outline's sampled
    points; the best one is brought to its end on the outline itself.
    """
    samples = along(loops, FIT_SAMPLE_MM)
    tree, middle = cKDTree(samples), samples.mean(axis=0)

    def sampled(moved: Array) -> Array:
        nearest: Array = samples[tree.query(moved)[1]]
        return nearest

    starts = [_turn(2 * np.pi * k / STARTS) for k in range(STARTS)]
    tried = [_iterate(points, sampled, turn, middle - turn @ points.mean(axis=0)) for turn in starts]
    _, turn, shift = min(tried, key=lambda fit: fit[0])
    _, turn, shift = _iterate(points, lambda moved: nearest(moved, loops), turn, shift)
    return RigidFit(float(np.degrees(np.arctan2(turn[1, 0], turn[0, 0]))), (float(shift[0]), float(shift[1])))


def _iterate(
    points: Array, closest: Callable[[Array], Array], turn: Array, shift: Array, rounds: int = 100
) -> tuple[float, Array, Array]:
    """Mean square distance, turn and shift after going to the closest points until that helps no more."""
    last = np.inf
    for _ in range(rounds):
        target = closest(points @ turn.T + shift)
        p, q = points - points.mean(axis=0), target - target.mean(axis=0)
        turn = _turn(np.arctan2((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum(), (p * q).sum()))
        shift = target.mean(axis=0) - turn @ points.mean(axis=0)
        error = float(((points @ turn.T + shift - target) ** 2).sum(axis=1).mean())
        if last - error < 1e-6 * error:
            break
        last = error
    return error, turn, shift


def _turn(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def read_points(path: Path) -> Array:
    """Points (k, 2) [mm] of a CSV: columns x_mm, y_mm (or x, y), or two columns without names."""
    try:
        rows = [row for row in csv.reader(io.StringIO(path.read_text(encoding="utf-8-sig"))) if row]
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path} cannot be read: {error}", "a CSV of x and y in mm") from error
    columns, first = (0, 1), 0
    if rows and not _number(rows[0][0]):
        names = [name.strip().lower() for name in rows[0]]
        pair = next((p for p in (("x_mm", "y_mm"), ("x", "y")) if set(p) <= set(names)), None)
        if pair is None:
            raise UsageError(f"{path}: no columns x_mm and y_mm among {', '.join(names)}")
        columns, first = (names.index(pair[0]), names.index(pair[1])), 1
    points = []
    for number, row in enumerate(rows[first:], start=first + 1):
        values = [row[k] if k < len(row) else "" for k in columns]
        if not all(_number(value) for value in values):
            raise UsageError(f"{path}, row {number}: {values} are not two finite numbers")
        points.append([float(value) for value in values])
    if len(points) < 3:
        raise UsageError(f"{path} has {len(points)} points", "an outline needs at least 3")
    return np.array(points)


def _number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False
