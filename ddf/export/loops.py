"""Closed lines in a plane: signed distance, parallel lines, contours of a grid, and reading one from a CSV."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ddf.errors import UsageError
from ddf.mesh.outline import contains, segments_cross, signed_area

Array = NDArray[np.float64]

CHUNK = 4_000_000  # distances worked out at a time


def signed_distance(points: Array, loop: Array) -> Array:
    """Distance [mm] of points (k, 2) from a closed line (s, 2), (k,); negative inside."""
    start, side = loop, np.roll(loop, -1, axis=0) - loop
    length = np.maximum((side * side).sum(axis=1), 1e-300)
    square = np.empty(len(points))
    step = max(1, CHUNK // len(loop))
    for first in range(0, len(points), step):
        away = points[first : first + step, None] - start
        t = np.clip((away * side).sum(axis=2) / length, 0.0, 1.0)
        away -= t[..., None] * side
        square[first : first + step] = (away * away).sum(axis=2).min(axis=1)
    return np.where(contains(loop, points), -1.0, 1.0) * np.sqrt(square)


def zero_lines(values: Array) -> list[Array]:
    """Lines (k, 2) in grid coordinates along which node values (n, m) are zero; closed ones repeat their first point.

    Linear along the edges of the grid; values that are NaN, and the cells around them, are left out.
    """
    from contourpy import contour_generator

    lines = contour_generator(z=np.ma.masked_invalid(values), corner_mask=False).lines(0.0)
    return [np.asarray(line)[:, ::-1].copy() for line in lines if len(line) > 2]


def closed(line: Array) -> bool:
    """Whether a line ends where it began."""
    return bool(np.linalg.norm(line[-1] - line[0]) < 1e-9)


def parallel_line(loop: Array, distance_mm: float, spacing_mm: float = 0.5) -> Array:
    """The line at a distance outside a closed one (s, 2), rounded about its corners; the outermost if it splits."""
    low, high = loop.min(axis=0) - distance_mm - 2.0, loop.max(axis=0) + distance_mm + 2.0
    x, y = (np.arange(a, b + spacing_mm, spacing_mm) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    values = signed_distance(grid.reshape(-1, 2), loop).reshape(grid.shape[:2]) - distance_mm
    lines = [low + spacing_mm * line[:-1] for line in zero_lines(values) if closed(line)]
    return simplified(max(lines, key=lambda line: abs(signed_area(line))), 0.01)


def simplified(loop: Array, tolerance_mm: float) -> Array:
    """The closed line (k, 2) with as few of its points as keep it within a tolerance (Douglas and Peucker 1973)."""
    far = int(np.argmax(np.linalg.norm(loop - loop[0], axis=1)))
    line = np.vstack([loop, loop[:1]])
    kept = np.zeros(len(line), bool)
    kept[[0, far, -1]] = True
    open_ranges = [(0, far), (far, len(loop))]
    while open_ranges:
        first, last = open_ranges.pop()
        if last - first < 2:
            continue
        chord, inner = line[last] - line[first], line[first + 1 : last] - line[first]
        away = np.abs(chord[0] * inner[:, 1] - chord[1] * inner[:, 0]) / max(float(np.linalg.norm(chord)), 1e-300)
        if away.max() > tolerance_mm:
            middle = first + 1 + int(np.argmax(away))
            kept[middle] = True
            open_ranges += [(first, middle), (middle, last)]
    return line[:-1][kept[:-1]]


def chained(segments: Array, tolerance: float = 1e-6) -> list[Array]:
    """Closed lines (k, 2) from loose segments (s, 2, 2) whose ends meet; open remains are left out."""
    keys = [tuple(np.round(p / tolerance).astype(np.int64).tolist()) for p in segments.reshape(-1, 2)]
    ends: dict[tuple[int, ...], list[int]] = {}
    for number, key in enumerate(keys):
        ends.setdefault(key, []).append(number)
    left, loops = set(range(len(segments))), []
    while left:
        number = 2 * min(left)
        first, line = keys[number], [segments.reshape(-1, 2)[number]]
        while number // 2 in left:
            left.discard(number // 2)
            number ^= 1
            line.append(segments.reshape(-1, 2)[number])
            number = next((other for other in ends[keys[number]] if other // 2 in left), number)
        if keys[number] == first or np.allclose(line[-1], line[0], atol=10 * tolerance):
            loops.append(np.array(line[:-1]))
    return loops


def dense(loop: Array, step_mm: float) -> Array:
    """The closed line (s, 2 or 3) with points at most `step_mm` apart, corners kept."""
    sides = np.roll(loop, -1, axis=0) - loop
    pieces = np.maximum(1, np.ceil(np.linalg.norm(sides, axis=1) / step_mm).astype(int))
    return np.concatenate([p + np.arange(k)[:, None] / k * d for p, k, d in zip(loop, pieces, sides, strict=True)])


def read_trim_line(path: Path) -> Array:
    """A closed line (k, 2) or (k, 3) [mm] from a CSV with columns x_mm, y_mm and, for points in space, z_mm.

    A last point that repeats the first is dropped. Raises UsageError for what is not such a line.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = list(csv.DictReader(stream))
        keys = ["x_mm", "y_mm", *(["z_mm"] if rows and "z_mm" in rows[0] else [])]
        line = np.array([[float(row[key]) for key in keys] for row in rows]).reshape(-1, len(keys))
    except (OSError, UnicodeDecodeError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise UsageError(f"{path} is no trim line: {error}", "a CSV with the columns x_mm, y_mm (and z_mm)") from error
    if len(line) > 1 and np.allclose(line[0], line[-1]):
        line = line[:-1]
    if len(line) < 3 or not np.isfinite(line).all():
        raise UsageError(f"{path} is no trim line: {len(line)} points", "give at least three, none of them infinite")
    if line.shape[1] == 2 and (segments_cross(line, line) or abs(signed_area(line)) < 1e-6):
        raise UsageError(f"{path} is no trim line: it crosses itself or encloses nothing", "list the points in order")
    return line
