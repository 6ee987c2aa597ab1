"""Whether neighbouring layers lie in their order: how many nodes are deep in the sheet beside them, or through it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.contact.rim import sheet_rim, with_rim
from ddf.model import sheet_scalars, sheet_vectors
from ddf.scene import Scene

Array = NDArray[np.float64]

DEEP = 0.5
"""Part of the distance at which two sheets touch; nodes pressed in farther do not know on which side they belong."""

NEAR = 4.0
"""A node farther from the place it is followed at than this many of these distances is somewhere else."""


def depth_in_layers(scene: Scene) -> tuple[float, float]:
    """How deep nodes are in the sheet beside them: two numbers, each of its worst pair.

    The share of the followed nodes over another sheet that are deeper in it than DEEP of the distance at which both
    touch; and the deepest of them, over that distance: more than 1 is through it.

    Signed distance d = sign r.n from the surface of `contact.patch` at the place (u, v) that contact keeps: also of
    nodes that contact has lost.
    """
    worst = deepest = 0.0
    for pair in scene.model.pairs:
        first, nodes = int(pair["first"]), _nodes(scene, pair)
        depth = depths(scene, pair, scene.model.exposed[first : first + nodes])
        worst = max(worst, float((depth > DEEP).sum()) / max(depth.size, 1))
        deepest = max(deepest, float(depth.max(initial=0.0)))
    return worst, deepest


def _nodes(scene: Scene, pair: np.void) -> int:
    """Number of nodes of a pair's slave."""
    slave = scene.model.sheets[int(pair["slave"])]
    return int(slave["rows"] * slave["cols"])


def depths(scene: Scene, pair: np.void, wanted: NDArray[np.bool_]) -> Array:
    """How deep those wanted of a pair's slave nodes (n,) are in its master, over the distance at which both touch.

    Of those that are over the master's fabric, one number each; 0 or less where nothing is pressed, and 0 where the
    node is far from its place.
    """
    slave, master = int(pair["slave"]), int(pair["master"])
    x, y = sheet_vectors(scene.model, scene.state.x, slave), sheet_vectors(scene.model, scene.state.x, master)
    cell = sheet_scalars(scene.model, scene.model.cell, master)
    node = int(scene.model.sheets[master]["node"])
    centre = scene.model.centre[2 * node : 2 * (node + cell.size)].reshape(*cell.shape, 2)
    y = with_rim(y, sheet_rim(scene.model, master))
    nodes, first = x[0].size, int(pair["first"])
    u, v = scene.state.place[5 * first : 5 * (first + nodes)].reshape(5, nodes)[:2]
    i, j = (np.clip(p, 0, n - 2).astype(int) for p, n in zip((u, v), cell.shape, strict=True))
    inside = wanted & (u >= 0) & (v >= 0) & (cell[i, j] > 0)
    inside &= (u <= cell.shape[0] - 1) & (v <= cell.shape[1] - 1)
    i, j = (np.clip((p[inside] + 0.5).astype(int), 0, n - 1) for p, n in zip((u, v), cell.shape, strict=True))
    middle = centre[i, j]
    surface, normal = _surface(y, middle, np.stack([u[inside], v[inside]], axis=1) - middle)
    away = x.reshape(3, nodes)[:, inside] - surface
    offset = float(pair["offset"])
    near = (middle[:, 0] >= 0) & (np.linalg.norm(away, axis=0) < NEAR * offset)
    return np.where(near, 1.0 - float(pair["sign"]) * (away * normal).sum(axis=0) / offset, 0.0)


def _surface(y: Array, middle: NDArray[np.int32], t: Array) -> tuple[Array, Array]:
    """Points and normals (3, k) of the biquadratic B-spline of nodes y (3, n, m), t (k, 2) cells off nodes `middle`."""
    weight = np.stack([0.5 * (0.5 - t) ** 2, 0.75 - t * t, 0.5 * (0.5 + t) ** 2])
    slope = np.stack([t - 0.5, -2.0 * t, t + 0.5])
    shift = np.arange(-1, 2)
    rows, cols = middle[:, 0] + shift[:, None], middle[:, 1] + shift[:, None]
    near = y[:, rows[:, None], cols[None]]  # (3, 3, 3, k)
    point, along, across = (
        np.einsum("cabk,ak,bk->ck", near, a[..., 0], b[..., 1])
        for a, b in ((weight, weight), (slope, weight), (weight, slope))
    )
    normal = np.cross(along, across, axis=0)
    return point, normal / np.maximum(np.linalg.norm(normal, axis=0), 1e-30)
