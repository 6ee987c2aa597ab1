"""Where a sheet passes through itself: edges of one cell through the triangles of another, exactly.

A wrinkle that closes on itself without self-contact does so unseen by all else. Only cells that lie near each other in
space and not on the grid are looked at, so a sheet without folds costs one search of neighbours.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ddf.model import sheet_scalars, sheet_vectors
from ddf.scene import Scene

Array = NDArray[np.float64]

APART = 2
"""Cells at most this far apart on the grid along both directions are neighbours."""

FLATTEST = 1e-9
"""Sine of the angle below which an edge lies in a triangle's plane (cells on the platform do) and does not pass it."""

CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))
TRIANGLES = ((0, 1, 2), (0, 2, 3))


def self_crossings(scene: Scene) -> dict[str, int]:
    """Edges of each sheet that pass through the sheet itself, by its name; sheets without any are left out."""
    found = {}
    for k, sheet in enumerate(scene.sheets):
        x = sheet_vectors(scene.model, scene.state.x, k)
        count = crossings_of(x, sheet_scalars(scene.model, scene.model.cell, k)[:-1, :-1] > 0)
        if count:
            found[sheet.name] = count
    return found


def crossings_of(x: Array, exists: NDArray[np.bool_]) -> int:
    """Pairs of an edge and a triangle of a sheet x (3, n, m), cells (n-1, m-1), that cross."""
    if not np.isfinite(x).all():
        return 0
    cells = np.argwhere(exists)
    points = x[:, (cells[:, None] + CORNERS)[..., 0], (cells[:, None] + CORNERS)[..., 1]]  # (3, c, 4)
    points = np.moveaxis(points, 0, -1)  # (c, 4, 3)
    middle = points.mean(axis=1)
    reach = np.linalg.norm(points - middle[:, None], axis=2).max(axis=1)
    pairs = _near(middle, reach)
    pairs = pairs[np.abs(cells[pairs[:, 0]] - cells[pairs[:, 1]]).max(axis=1) > APART]
    away = np.linalg.norm(middle[pairs[:, 0]] - middle[pairs[:, 1]], axis=1)
    pairs = pairs[away < reach[pairs].sum(axis=1)]
    both = np.concatenate([pairs, pairs[:, ::-1]])
    one, other = points[both[:, 0]], points[both[:, 1]]
    return int(sum(_through(one[:, a], one[:, b], *(other[:, c] for c in triangle)).sum()
                   for a, b in EDGES for triangle in TRIANGLES))  # fmt: skip


def _near(middle: Array, reach: Array) -> NDArray[np.intp]:
    """Pairs (k, 2) of cells among which are all whose balls, about `middle` with radius `reach`, meet.

    By classes of size, each with itself and all smaller ones: fine cells need not look as far as coarse ones.
    """
    sizes = np.ceil(np.log2(np.maximum(reach, 1e-300)))
    found = []
    for size in np.unique(sizes):
        own, smaller = np.flatnonzero(sizes == size), np.flatnonzero(sizes < size)
        tree, far = cKDTree(middle[own]), 2.0 * float(reach[own].max())
        found.append(own[tree.query_pairs(far, output_type="ndarray")])
        if smaller.size:
            near = tree.sparse_distance_matrix(cKDTree(middle[smaller]), far, output_type="ndarray")
            found.append(np.stack([own[near["i"]], smaller[near["j"]]], axis=1))
    return np.concatenate(found)


def _through(start: Array, end: Array, a: Array, b: Array, c: Array) -> NDArray[np.bool_]:
    """Whether segments pass through triangles (T. Moeller, B. Trumbore, J. Graphics Tools 2 (1997) 21); all (k, 3)."""
    d, u, v = end - start, b - a, c - a
    h = np.cross(d, v)
    det = (u * h).sum(axis=1)
    size = np.linalg.norm(d, axis=1) * np.linalg.norm(np.cross(u, v), axis=1)
    slant = np.abs(det) > FLATTEST * size
    safe = np.where(slant, det, np.inf)
    s = start - a
    q = np.cross(s, u)
    r, t, w = (s * h).sum(axis=1) / safe, (d * q).sum(axis=1) / safe, (v * q).sum(axis=1) / safe
    return slant & (r >= 0.0) & (t >= 0.0) & (r + t <= 1.0) & (w >= 0.0) & (w <= 1.0)
