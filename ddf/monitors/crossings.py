"""Where a sheet passes through itself or the next: edges of one cell through the triangles of another, exactly.

A wrinkle that closes on itself without self-contact does so unseen by all else. Only cells that lie near each other in
space are looked at, and of those that are neighbours on the grid only the ones beside a sharp kink, so a sheet without
folds costs one search of neighbours.

Contact keeps nodes off the smooth surface of the next sheet (`contact.patch`), which lies inside a bend of its cells:
over an apex hardly wider than the cells, the cells of two sheets can cut each other though no node is deep.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.spatial import cKDTree

from ddf.model import DIAPHRAGM, sheet_scalars, sheet_vectors
from ddf.scene import Scene

Array = NDArray[np.float64]

APART = 2
"""Cells at most this far apart on the grid along both directions are neighbours."""

KINK = 0.6
"""Cosine of the angle between triangles of cells side by side from which on neighbours can cross."""

FLATTEST = 1e-9
"""Sine of the angle below which an edge lies in a triangle's plane (cells on the platform do) and does not pass it."""

CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 2))
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


def layer_crossings(scene: Scene) -> dict[tuple[str, str], int]:
    """Edges of sheets that pass through a sheet beside them, by both names; pairs without any are left out.

    Cells that an outline cuts are left out: not all of them is cloth.
    """
    shapes, pairs = [_shape(scene, k) for k in range(len(scene.sheets))], {(0, len(scene.sheets) - 1)}
    pairs |= {(k, k + 1) for k in range(len(scene.sheets) - 1)}
    found = {}
    for a, b in sorted(pairs):
        count = _crossings_between(shapes[a], shapes[b])
        if count:
            found[scene.sheets[a].name, scene.sheets[b].name] = count
    return found


def _shape(scene: Scene, k: int) -> tuple[Array, NDArray[np.intp]]:
    """Corners (c, 4, 3) of the cells of a sheet that are full of it, and these nodes' numbers (c, 4)."""
    x, cell = sheet_vectors(scene.model, scene.state.x, k), sheet_scalars(scene.model, scene.model.cell, k)[:-1, :-1]
    sheet = scene.model.sheets[k]
    full = 0.0 if sheet["kind"] == DIAPHRAGM else (1.0 - 1e-9) * float(sheet["a1"] * sheet["a2"])
    cells = np.argwhere((cell > 0.0) & (cell >= full))
    return _corners(x, cells), (cells[:, None] + CORNERS) @ [x.shape[2], 1]


def _corners(x: Array, cells: NDArray[np.intp]) -> Array:
    """Corners (c, 4, 3) of cells (c, 2) of a sheet x (3, n, m)."""
    points = x[:, (cells[:, None] + CORNERS)[..., 0], (cells[:, None] + CORNERS)[..., 1]]
    return np.moveaxis(points, 0, -1)


def _crossings_between(one: tuple[Array, NDArray[np.intp]], other: tuple[Array, NDArray[np.intp]]) -> int:
    """Edges of two sheets that pass through the other; corners (c, 4, 3) of cells, and numbers (c, 4), of both."""
    points, nodes = (np.concatenate([a, b]) for a, b in zip(one, other, strict=True))
    if not np.isfinite(points).all():
        return 0
    middle = points.mean(axis=1)
    reach = np.linalg.norm(points - middle[:, None], axis=2).max(axis=1)
    pairs = np.sort(_near(middle, reach), axis=1)
    pairs = pairs[(pairs[:, 0] < len(one[0])) & (pairs[:, 1] >= len(one[0]))]
    # most lie on two sides of the first one's mean plane
    first, second = points[pairs[:, 0]], points[pairs[:, 1]]
    normal = np.cross(first[:, 2] - first[:, 0], first[:, 3] - first[:, 1])[:, None]
    own, others = ((part * normal).sum(axis=2) for part in (first, second))
    meets = (others.min(axis=1) <= own.max(axis=1)) & (others.max(axis=1) >= own.min(axis=1))
    first, second, pairs = first[meets], second[meets], pairs[meets]
    count = 0
    for p, q, cells in ((first, second, pairs[:, 0]), (second, first, pairs[:, 1])):
        edges = []
        for a, b in EDGES:
            crosses = [_through(p[:, a], p[:, b], *(q[:, c] for c in triangle)) for triangle in TRIANGLES]
            edges.append(nodes[cells[np.any(crosses, axis=0)]][:, (a, b)])
        count += len(np.unique(np.sort(np.concatenate(edges), axis=1), axis=0))
    return count


def crossings_of(x: Array, exists: NDArray[np.bool_]) -> int:
    """Pairs of an edge and a triangle of a sheet x (3, n, m), cells (n-1, m-1), that cross."""
    if not np.isfinite(x).all():
        return 0
    cells = np.argwhere(exists)
    points = _corners(x, cells)
    middle = points.mean(axis=1)
    reach = np.linalg.norm(points - middle[:, None], axis=2).max(axis=1)
    pairs = _near(middle, reach)
    apart = np.abs(cells[pairs[:, 0]] - cells[pairs[:, 1]]).max(axis=1) > APART
    kinked = _kinked(x, exists)[exists]
    pairs = pairs[apart | (kinked[pairs[:, 0]] & kinked[pairs[:, 1]])]
    away = np.linalg.norm(middle[pairs[:, 0]] - middle[pairs[:, 1]], axis=1)
    pairs = pairs[away < reach[pairs].sum(axis=1)]
    both = np.concatenate([pairs, pairs[:, ::-1]])
    one, other = points[both[:, 0]], points[both[:, 1]]
    nodes = (cells[:, None] + CORNERS) @ [x.shape[2], 1]
    ends, corners = nodes[both[:, 0]], nodes[both[:, 1]]
    count = 0
    for a, b in EDGES:
        for triangle in TRIANGLES:
            shared = (ends[:, (a, b), None] == corners[:, None, triangle]).any(axis=(1, 2))
            count += int((_through(one[:, a], one[:, b], *(other[:, c] for c in triangle)) & ~shared).sum())
    return count


def _kinked(x: Array, exists: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells within `APART` of a pair of triangles, of one cell or of two side by side, at more than `KINK` says."""
    corners = [x[:, i : i + exists.shape[0], j : j + exists.shape[1]] for i, j in CORNERS]
    normals = [_direction(np.cross(corners[b] - corners[a], corners[c] - corners[a], axis=0)) for a, b, c in TRIANGLES]
    sharp = (normals[0] * normals[1]).sum(axis=0) < KINK
    for a, b in (np.s_[1:, :], np.s_[:-1, :]), (np.s_[:, 1:], np.s_[:, :-1]):
        closest = [(one[:, *a] * other[:, *b]).sum(axis=0) for one in normals for other in normals]
        bent = (np.min(closest, axis=0) < KINK) & exists[a] & exists[b]
        sharp[a] |= bent
        sharp[b] |= bent
    return binary_dilation(sharp & exists, np.ones((3, 3)), iterations=APART)


def _direction(v: Array) -> Array:
    """Vectors (3, ...) made one long."""
    return v / np.maximum(np.linalg.norm(v, axis=0), 1e-300)


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
