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
    meets = _meet(start, end, start, end, touching=True)
    i, j = np.indices((count, count))
    gap = (j - i) % count
    meets &= (gap != 0) & (gap != 1) & (gap != count - 1)
    direction, following = end - start, np.roll(end - start, -1, axis=0)
    turn = direction[:, 0] * following[:, 1] - direction[:, 1] * following[:, 0]
    ahead = np.einsum("ij,ij->i", direction, following)
    for edge in np.flatnonzero((np.abs(turn) <= 1e-12 * np.abs(ahead)) & (ahead < 0)):
        meets[edge, (edge + 1) % count] = True
    hits = np.argwhere(np.triu(meets | meets.T))
    return (int(hits[0, 0]) + 1, int(hits[0, 1]) + 1) if len(hits) else None


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
    return bool(_meet(starts[0], ends[0], starts[1], ends[1], touching=touching).any())


def inside(points: Points, polygon: Points) -> np.ndarray:
    """Return for each point whether it lies inside `polygon` (even-odd rule) or on its edge. Shape (n,)."""
    p = np.asarray(points, float)[:, None, :]
    a = np.asarray(polygon, float)[None, :, :]
    b = np.roll(a, -1, axis=1)
    straddles = (a[..., 1] > p[..., 1]) != (b[..., 1] > p[..., 1])
    rise = np.where(straddles, b[..., 1] - a[..., 1], 1.0)
    crossing_x = a[..., 0] + (p[..., 1] - a[..., 1]) * (b[..., 0] - a[..., 0]) / rise
    odd = (straddles & (p[..., 0] < crossing_x)).sum(axis=1) % 2 == 1
    edge = b - a
    square = np.maximum((edge**2).sum(axis=-1), 1e-300)
    along = np.clip(((p - a) * edge).sum(axis=-1) / square, 0.0, 1.0)
    distance = np.linalg.norm(p - a - along[..., None] * edge, axis=-1).min(axis=1)
    return odd | (distance <= TOUCH_MM)


def _meet(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, *, touching: bool) -> np.ndarray:
    """Return the (n, m) table of whether segment a-b meets segment c-d, by the signs of four areas."""
    a, b, c, d = a[:, None], b[:, None], c[None], d[None]
    c_side, d_side = _side(a, b, c), _side(a, b, d)
    a_side, b_side = _side(c, d, a), _side(c, d, b)
    if not touching:
        return (c_side * d_side < 0) & (a_side * b_side < 0)
    boxes = (np.minimum(a, b) <= np.maximum(c, d)) & (np.minimum(c, d) <= np.maximum(a, b))
    return (c_side * d_side <= 0) & (a_side * b_side <= 0) & boxes.all(axis=-1)


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return the sign of the area of the triangle a-b-p, 0 within rounding."""
    first = (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1])
    second = (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])
    area = first - second
    return np.where(np.abs(area) <= 1e-12 * (np.abs(first) + np.abs(second)), 0.0, np.sign(area))
