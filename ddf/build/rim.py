"""How a ply's smooth surface goes on beyond its edges, and how contact fades there."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.spatial import cKDTree

from ddf.build.blocks import block_edges
from ddf.mesh.outline import contains
from ddf.mesh.ply import PlyMesh
from ddf.model import RIM

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

RINGS = 2
"""Rings of nodes around a ply: the patch of a node just beyond the edge reaches the second."""
HALF = 0.5
"""Cells from the edge, inwards and outwards, over which contact fades: the node on a straight edge, of half the mass,
then bears what belongs to half a cell."""
DEEPEST = 3.0
"""Cover that need not be told from more: what is interpolated near such nodes is over 1."""
MISSING = -3.0
"""Cover of nodes of cells that are cut out along slits. With the cover of others there at most 1, none is left where
such a node is the nearest, and patches with nodes of both sides are those of such nodes."""
PATCH_REACH = 3
NEAREST = 4
"""Points of the outline beside which the nearest segment is looked for."""
_AXES = ((1, 0), (-1, 0), (0, 1), (0, -1))
_DIAGONALS = ((1, 1), (1, -1), (-1, 1), (-1, -1))


def rim_entries(exists: BoolArray) -> np.ndarray:
    """RIM records, by rim nodes, numbers in the sheet: up to RINGS rings around the nodes that exist (n, m).

    A node goes on from two others in line with it, those along the grid if there are any, as the mean of all ways.
    """
    n, m = exists.shape
    known = exists.copy()
    weights: dict[int, dict[int, float]] = {int(k): {int(k): 1.0} for k in np.flatnonzero(exists)}
    records = []
    for _ in range(RINGS):
        found = {}
        for i, j in np.argwhere(binary_dilation(known, np.ones((3, 3))) & ~known):
            for ways in (_AXES, _DIAGONALS):
                lines = [((i + a, j + b), (i + 2 * a, j + 2 * b)) for a, b in ways]
                lines = [(a, b) for a, b in lines if 0 <= b[0] < n and 0 <= b[1] < m and known[a] and known[b]]
                if lines:
                    pairs = [(int(a[0] * m + a[1]), int(b[0] * m + b[1])) for a, b in lines]
                    found[int(i * m + j)] = _mean(pairs, weights)
                    break
        weights |= found
        known.ravel()[list(found)] = True
        records += [(node, parent, weight) for node, parents in found.items() for parent, weight in parents.items()]
    return np.sort(np.array(records, dtype=RIM), order=("node", "parent"))


def rim_lists(rims: list[np.ndarray], sheets: np.ndarray, blocks: np.ndarray) -> dict[str, Any]:
    """Fields of a model from the RIM records of each sheet."""
    parts = []
    for rim, sheet in zip(rims, sheets, strict=True):
        part = rim.copy()
        part["node"] += sheet["node"]
        part["parent"] += sheet["node"]
        parts.append(part)
    rim = np.sort(np.concatenate(parts), order=("node", "parent"))
    by_parents = np.sort(rim, order=("parent", "node"))
    edges = block_edges(sheets, blocks)
    return {
        "rim": rim, "rim_first": np.searchsorted(rim["node"], edges),
        "rim_parents": by_parents, "parent_first": np.searchsorted(by_parents["parent"], edges),
    }  # fmt: skip


def rim_nodes(rim: np.ndarray, shape: tuple[int, int]) -> BoolArray:
    """Which nodes (n, m) of a sheet are of the rim."""
    nodes = np.zeros(shape, bool)
    nodes.ravel()[rim["node"]] = True
    return nodes


def no_rims(count: int) -> list[np.ndarray]:
    """RIM records of `count` sheets that have none."""
    return [np.zeros(0, RIM) for _ in range(count)]


def _mean(ways: list[tuple[int, int]], weights: dict[int, dict[int, float]]) -> dict[int, float]:
    """Weights of the mean of 2 x_1 - x_2 over pairs of nodes (1, 2), which have weights themselves."""
    total: dict[int, float] = {}
    for near, next_one in ways:
        for node, factor in ((near, 2.0), (next_one, -1.0)):
            for parent, weight in weights[node].items():
                total[parent] = total.get(parent, 0.0) + factor * weight / len(ways)
    return {parent: weight for parent, weight in total.items() if weight != 0.0}


def ply_cover(ply: PlyMesh) -> FloatArray:
    """A ply's nodes' share in contact (n, m): it takes what is interpolated of it between 0 and 1 (`contact.layers`).

    1/2 + d / (2 HALF) with the depth d of a node inside the outline in cells, below 0 outside.
    """
    size = np.array(ply.spacing)
    n, m = ply.active.shape
    points = np.stack(np.meshgrid(np.arange(n) * size[0], np.arange(m) * size[1], indexing="ij"), axis=-1)
    loops = [loop * size for loop in ply.outline]
    near = _near(ply)
    cover = np.where(ply.active, DEEPEST, MISSING)
    depth = np.where(_inside(points[near], loops), 1.0, -1.0) * _distance(points[near], loops)
    cover[near] = np.minimum(0.5 + depth / (2.0 * HALF * np.sqrt(size.prod())), DEEPEST)
    middles = points[:-1, :-1] + 0.5 * size
    cut = (ply.cell_fraction == 0.0) & _inside(middles, loops)
    slit = np.zeros((n, m), bool)
    for a in (0, 1):
        for b in (0, 1):
            slit[a : n - 1 + a, b : m - 1 + b] |= cut
    beside = binary_dilation(slit, np.ones((3, 3)), iterations=PATCH_REACH) if slit.any() else slit
    return np.where(slit, MISSING, np.where(beside, np.minimum(cover, 1.0), cover))


def _near(ply: PlyMesh) -> BoolArray:
    """Nodes so near to the outline that it matters how far they are."""
    near = np.zeros(ply.active.shape, bool)
    for cells in ply.outline_cells:
        near[tuple(cells.T)] = True
    return binary_dilation(near, np.ones((3, 3)), iterations=int(DEEPEST) + RINGS + 1)


def _inside(points: FloatArray, loops: list[FloatArray]) -> BoolArray:
    """Whether points (..., 2) lie in the outer loop and in no hole."""
    inside = contains(loops[0], points)
    for hole in loops[1:]:
        inside &= ~contains(hole, points)
    return inside


def _distance(points: FloatArray, loops: list[FloatArray]) -> FloatArray:
    """Distance of points (k, 2) from closed loops, by the segments beside the nearest of their points."""
    starts = np.concatenate(loops)
    along = np.concatenate([np.roll(loop, -1, axis=0) - loop for loop in loops])
    before = np.concatenate([np.roll(np.arange(len(p)), 1) + k for p, k in zip(loops, _firsts(loops), strict=True)])
    nearest = cKDTree(starts).query(points, k=min(NEAREST, len(starts)))[1]
    segments = np.concatenate([nearest, before[nearest]], axis=1)
    r, t = points[:, None] - starts[segments], along[segments]
    share = np.clip((r * t).sum(axis=-1) / np.maximum((t * t).sum(axis=-1), 1e-300), 0.0, 1.0)
    distance: FloatArray = np.linalg.norm(r - share[..., None] * t, axis=-1).min(axis=1)
    return distance


def _firsts(loops: list[FloatArray]) -> list[int]:
    """Numbers of the loops' first points, one loop after the other."""
    return [0, *np.cumsum([len(loop) for loop in loops[:-1]]).tolist()]
