"""Plane geometry for checking outlines: crossing edges and points inside a polygon."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Points = Sequence[tuple[float, float]]
TOUCH_MM = 1e-6


def crossing_edges(points: Points) -> tuple[int, int] | None:
    """Return the numbers (from 1) of the first two edges of a closed polygon that meet where they must not.

    Edge i runs from corner i to the next. Neighbours share a corner, so they count only where they fold back.
    """
    start = np.asarray(points, float)
    end = np.roll(start, -1, axis=0)
    count = len(start)
    i, j = _meetings(start, end, start, end, touching=True)
    apart = (i < j) & (j - i != 1) & (j - i != count - 1)
    hits = [(int(p), int(q)) for p, q in zip(i[apart], j[apart], strict=True)]
    direction, following = end - start, np.roll(end - start, -1, axis=0)
    turn = direction[:, 0] * following[:, 1] - direction[:, 1] * following[:, 0]
    ahead = np.einsum("ij,ij->i", direction, following)
    for edge in np.flatnonzero((np.abs(turn) <= 1e-12 * np.abs(ahead)) & (ahead < 0)):
        low, high = sorted((int(edge), (int(edge) + 1) % count))
        hits.append((low, high))
    return (min(hits)[0] + 1, min(hits)[1] + 1) if hits else None


def coinciding_corners(points: Points) -> tuple[int, int] | None:
    """Return the numbers (from 1) of the first two neighbouring corners of a closed polygon at one place."""
    array = np.asarray(points, float)
    length = np.linalg.norm(np.roll(array, -1, axis=0) - array, axis=1)
    where = np.flatnonzero(length <= TOUCH_MM)
    return (int(where[0]) + 1, (int(where[0]) + 1) % len(array) + 1) if len(where) else None


def lines_meet(a: Points, b: Points, *, closed: tuple[bool, bool], touching: bool) -> bool:
    """Say whether two lines cross, or with `touching` share any point; `closed` makes polygons of them."""
    starts, ends = [], []
    for line, close in zip((a, b), closed, strict=True):
        array = np.asarray(line, float)
        starts.append(array if close else array[:-1])
        ends.append(np.roll(array, -1, axis=0) if close else array[1:])
    return _meetings(starts[0], ends[0], starts[1], ends[1], touching=touching)[0].size > 0


def inside(points: Points, polygon: Points) -> np.ndarray:
    """Return for each point whether it lies inside `polygon` (even-odd rule) or on its edge. Shape (n,)."""
    p = np.asarray(points, float)[:, None, :]
    a = np.asarray(polygon, float)[None, :, :]
    b = np.roll(a, -1, axis=1)
    straddles = (a[..., 1] > p[..., 1]) != (b[..., 1] > p[..., 1])
    rise = np.where(straddles, b[..., 1] - a[..., 1], 1.0)
    crossing_x = a[..., 0] + (p[..., 1] - a[..., 1]) * (b[..., 0] - a[..., 0]) / rise
    found: np.ndarray = (straddles & (p[..., 0] < crossing_x)).sum(axis=1) % 2 == 1
    outer = np.flatnonzero(~found)
    edge = b - a
    square = np.maximum((edge**2).sum(axis=-1), 1e-300)
    along = np.clip(((p[outer] - a) * edge).sum(axis=-1) / square, 0.0, 1.0)
    distance = np.linalg.norm(p[outer] - a - along[..., None] * edge, axis=-1).min(axis=1)
    found[outer] = distance <= TOUCH_MM
    return found


def _meetings(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, *, touching: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers i, j of all segments a-b and c-d that meet, by the signs of four areas.

    Only pairs whose boxes overlap are looked at, and lines whose boxes are apart not at all.
    """
    low, high, other_low, other_high = np.minimum(a, b), np.maximum(a, b), np.minimum(c, d), np.maximum(c, d)
    if (low.min(axis=0) > other_high.max(axis=0)).any() or (high.max(axis=0) < other_low.min(axis=0)).any():
        return np.zeros(0, int), np.zeros(0, int)
    near = np.ones((len(a), len(c)), bool)
    for axis in (0, 1):
        near &= (low[:, None, axis] <= other_high[None, :, axis]) & (other_low[None, :, axis] <= high[:, None, axis])
    i, j = np.nonzero(near)
    a, b, c, d = a[i], b[i], c[j], d[j]
    across, back = _side(a, b, c) * _side(a, b, d), _side(c, d, a) * _side(c, d, b)
    meets = (across <= 0) & (back <= 0) if touching else (across < 0) & (back < 0)
    return i[meets], j[meets]


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return the sign of the area of the triangle a-b-p, 0 within rounding."""
    first = (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1])
    second = (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])
    area = first - second
    return np.where(np.abs(area) <= 1e-12 * (np.abs(first) + np.abs(second)), 0.0, np.sign(area))
