"""Outlines: polygons with holes, their exact area in every cell of a grid, slits and resampling."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddf.errors import MeshError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def signed_area(loop: FloatArray) -> float:
    """Shoelace area 1/2 sum(u_k v_k+1 - u_k+1 v_k) of a closed loop (k, 2); positive if counterclockwise."""
    shifted = loop - loop[0]
    following = np.roll(shifted, -1, axis=0)
    return 0.5 * float(np.sum(shifted[:, 0] * following[:, 1] - following[:, 0] * shifted[:, 1]))


def clean_loop(points: ArrayLike, clockwise: bool, what: str) -> FloatArray:
    """A simple polygon (k, 2) without repeated points, turned the way asked; else MeshError."""
    loop = np.array(points, dtype=np.float64)
    if loop.ndim != 2 or loop.shape[1] != 2 or not np.isfinite(loop).all():
        raise MeshError(f"{what} must be a list of (x, y) points, not an array of shape {loop.shape}")
    size = float(np.ptp(loop, axis=0).max()) if len(loop) else 0.0
    loop = loop[np.linalg.norm(loop - np.roll(loop, -1, axis=0), axis=1) > 1e-9 * size]
    if len(loop) < 3 or abs(signed_area(loop)) < 1e-9 * size**2:
        raise MeshError(f"{what} encloses no area", "give at least three points that are not on one line")
    if segments_cross(loop, loop):
        raise MeshError(f"{what} crosses itself", "list the points in order around the outline")
    return loop[::-1].copy() if (signed_area(loop) < 0) != clockwise else loop


def segments_cross(first: FloatArray, second: FloatArray) -> bool:
    """Whether any segment of one closed loop properly crosses one of the other (both (k, 2))."""
    a, c = first[:, None], second[None]
    b, d = np.roll(first, -1, axis=0)[:, None], np.roll(second, -1, axis=0)[None]

    def side(p: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
        cross = (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1])
        cross = cross - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0])
        scale = np.linalg.norm(q - p, axis=-1) * np.linalg.norm(r - p, axis=-1)
        return np.where(np.abs(cross) > 1e-9 * scale, np.sign(cross), 0.0)

    return bool(((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)).any())


def contains(loop: FloatArray, points: FloatArray) -> NDArray[np.bool_]:
    """Which points (..., 2) lie inside a closed loop (k, 2), by the number of edges crossed."""
    inside = np.zeros(points.shape[:-1], dtype=bool)
    x, y = points[..., 0], points[..., 1]
    for (ax, ay), (bx, by) in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    return inside


def clean_outline(polygon: ArrayLike, holes: list[ArrayLike], what: str) -> list[FloatArray]:
    """The outer loop, counterclockwise, then the holes, clockwise; MeshError if a hole is not inside."""
    outer = clean_loop(polygon, False, f"the outline of {what}")
    loops = [outer]
    for k, hole in enumerate(holes, start=1):
        loop = clean_loop(hole, True, f"hole {k} of {what}")
        if segments_cross(loop, outer) or not contains(outer, loop).all():
            raise MeshError(f"hole {k} of {what} is not inside the outline")
        for other_k, other in enumerate(loops[1:], start=1):
            if segments_cross(loop, other) or contains(other, loop).any() or contains(loop, other).any():
                raise MeshError(f"holes {other_k} and {k} of {what} overlap")
        loops.append(loop)
    return loops


def split_at_grid(p: FloatArray, q: FloatArray) -> FloatArray:
    """The points (s+1, 2) that cut the segment from p to q at every line u = integer and v = integer."""
    cuts = [np.array([0.0, 1.0])]
    for a, b in zip(p, q, strict=True):
        if a != b:
            lines = np.arange(np.ceil(min(a, b)), np.floor(max(a, b)) + 1.0)
            cuts.append((lines - a) / (b - a))
    t = np.unique(np.clip(np.concatenate(cuts), 0.0, 1.0))
    return p + t[:, None] * (q - p)


def cell_fractions(loops: list[FloatArray], cells: tuple[int, int]) -> FloatArray:
    """Exact part of each unit cell inside the loops, (n-1, m-1), from loops (k, 2) in grid coordinates.

    The area of cell (i, j) is -sum of the integral of clip(v - j, 0, 1) du over the pieces of the boundary
    in column i (Green's theorem with the part of the cell below the curve). A piece in cell (i, j) so adds
    -du (v_mean - j) to its own cell and -du to all cells under it. Loops must lie within the grid.
    """
    own, under = np.zeros(cells), np.zeros(cells)
    for loop in loops:
        for p, q in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            points = split_at_grid(p, q)
            middle, du = 0.5 * (points[1:] + points[:-1]), np.diff(points[:, 0])
            i = np.clip(np.floor(middle[:, 0]).astype(np.int64), 0, cells[0] - 1)
            j = np.clip(np.floor(middle[:, 1]).astype(np.int64), 0, cells[1] - 1)
            np.add.at(own, (i, j), -du * (middle[:, 1] - j))
            np.add.at(under, (i, j), -du)
    fraction = own + np.flip(np.cumsum(np.flip(under, 1), axis=1), 1) - under
    fraction[np.abs(fraction) < 1e-11] = 0.0
    fraction[np.abs(fraction - 1.0) < 1e-11] = 1.0
    return fraction


def crossed_cells(line: FloatArray, cells: tuple[int, int]) -> IntArray:
    """The cells (k, 2) that a polyline (p, 2) in grid coordinates crosses, joined side to side.

    A line along a grid line takes the cells on its upper side; one through a node takes a cell beside the
    diagonal too, so that no two cells left over on opposite sides share a node inside the line.
    """
    found: list[tuple[int, int]] = []
    for p, q in pairwise(line):
        points = split_at_grid(p, q)
        middle = 0.5 * (points[1:] + points[:-1])
        long = np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-6
        for i, j in np.floor(middle[long] + 1e-6).astype(np.int64).tolist():
            if found and found[-1][0] != i and found[-1][1] != j:
                found.append((i, found[-1][1]))
            found.append((i, j))
    places = np.array(sorted(set(found)), dtype=np.int64).reshape(-1, 2)
    return places[((places >= 0) & (places < cells)).all(axis=1)]


def resample(loop: FloatArray, spacing: tuple[float, float], step_mm: float) -> tuple[FloatArray, IntArray]:
    """The loop with segments of at most `step_mm`, (s, 2), vertices kept, and the indices of its corners.

    `spacing` [mm] turns grid coordinates into lengths. A corner is a vertex that turns by over 10 degrees,
    so that a circle given by many points has none.
    """
    scale = np.array(spacing)
    sides = np.roll(loop, -1, axis=0) - loop
    length = np.linalg.norm(sides * scale, axis=1)
    pieces = np.maximum(1, np.ceil(length / step_mm - 1e-9)).astype(np.int64)
    parts = [p + np.arange(k)[:, None] / k * side for p, side, k in zip(loop, sides, pieces.tolist(), strict=True)]
    direction = sides * scale / length[:, None]
    cosine = np.sum(direction * np.roll(direction, 1, axis=0), axis=1)
    starts = np.concatenate(([0], np.cumsum(pieces)[:-1]))
    return np.concatenate(parts), starts[cosine < np.cos(np.deg2rad(10.0))]
