"""Logically rectangular quadrilateral grids: made by gmsh as transfinite blocks, grid order recovered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.errors import MeshError
from ddf.mesh.gmsh_session import gmsh_session

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Block:
    """Part of a grid direction: `cells` cells from `start` to `stop` [mm], each `ratio` times the last."""

    start: float
    stop: float
    cells: int
    ratio: float = 1.0

    def lines(self) -> FloatArray:
        """The exact grid lines of the block, (cells+1,) [mm]."""
        sizes = self.ratio ** np.arange(self.cells, dtype=np.float64)
        part = np.concatenate(([0.0], np.cumsum(sizes)))
        return self.start + (self.stop - self.start) * part / part[-1]


def block_lines(blocks: list[Block]) -> FloatArray:
    """The exact grid lines of adjoining blocks, (n,) [mm], strictly increasing."""
    return np.concatenate([blocks[0].lines(), *(block.lines()[1:] for block in blocks[1:])])


def mesh_grid(u_blocks: list[Block], v_blocks: list[Block], axis_deg: float = 0.0, name: str = "grid") -> FloatArray:
    """Mesh a rectangle of transfinite blocks with gmsh; return node positions (3, n, m) [mm] in grid order.

    The first index runs along (cos t, sin t), the second along (-sin t, cos t), t = `axis_deg`; block ends
    are coordinates on these axes. z = 0. Raises MeshError if what gmsh made is not that grid.
    """
    angle = np.deg2rad(axis_deg)
    axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    with gmsh_session(name) as gmsh:
        _add_blocks(gmsh, u_blocks, v_blocks, axes)
        gmsh.model.mesh.generate(2)
        points, quads = _read_quads(gmsh, name)
    u_lines, v_lines = block_lines(u_blocks), block_lines(v_blocks)
    order = recover_order(points[:, :2] @ axes.T, quads, (u_lines.size, v_lines.size), name)
    _check_lines(points[order][..., :2] @ axes.T, u_lines, v_lines, name)
    x = np.zeros((3, u_lines.size, v_lines.size))
    for k in range(2):
        x[k] = u_lines[:, None] * axes[0, k] + v_lines[None, :] * axes[1, k]
    return x


def _add_blocks(gmsh: Any, u_blocks: list[Block], v_blocks: list[Block], axes: FloatArray) -> None:
    """Points, transfinite curves and recombined transfinite surfaces of all blocks, in the current model."""
    geo = gmsh.model.geo
    u_ends = [u_blocks[0].start, *(b.stop for b in u_blocks)]
    v_ends = [v_blocks[0].start, *(b.stop for b in v_blocks)]
    point = [[geo.addPoint(*(u * axes[0] + v * axes[1]), 0.0) for v in v_ends] for u in u_ends]
    along_u, along_v = {}, {}
    for i, block in enumerate(u_blocks):
        for j in range(len(v_ends)):
            along_u[i, j] = geo.addLine(point[i][j], point[i + 1][j])
            geo.mesh.setTransfiniteCurve(along_u[i, j], block.cells + 1, "Progression", block.ratio)
    for j, block in enumerate(v_blocks):
        for i in range(len(u_ends)):
            along_v[i, j] = geo.addLine(point[i][j], point[i][j + 1])
            geo.mesh.setTransfiniteCurve(along_v[i, j], block.cells + 1, "Progression", block.ratio)
    for i in range(len(u_blocks)):
        for j in range(len(v_blocks)):
            loop = [along_u[i, j], along_v[i + 1, j], -along_u[i, j + 1], -along_v[i, j]]
            surface = geo.addPlaneSurface([geo.addCurveLoop(loop)])
            geo.mesh.setTransfiniteSurface(surface)
            geo.mesh.setRecombine(2, surface)
    geo.synchronize()


def _read_quads(gmsh: Any, name: str) -> tuple[FloatArray, IntArray]:
    """Nodes (k, 3) and quadrilaterals (q, 4) as dense indices; MeshError if there are other faces."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    index = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    index[tags.astype(np.int64)] = np.arange(tags.size)
    types, _, nodes = gmsh.model.mesh.getElements(2)
    if list(types) != [3]:
        raise MeshError(f"{name}: gmsh did not make quadrilaterals only (element types {list(types)})")
    return coordinates.reshape(-1, 3), index[nodes[0].astype(np.int64)].reshape(-1, 4)


def _line_index(values: FloatArray, count: int, name: str) -> IntArray:
    """Which of `count` grid lines each coordinate lies on, found from the gaps between sorted values."""
    ordered = np.sort(values)
    gaps = np.diff(ordered)
    cuts = np.sort(np.argsort(gaps)[gaps.size - (count - 1) :])
    inside = np.delete(gaps, cuts)
    if inside.size and inside.max() > 1e-3 * gaps[cuts].min():
        raise MeshError(f"{name}: the nodes do not lie on {count} straight grid lines")
    limits = 0.5 * (ordered[cuts] + ordered[cuts + 1])
    return np.searchsorted(limits, values).astype(np.int64)


def recover_order(points: FloatArray, quads: IntArray, shape: tuple[int, int], name: str = "grid") -> IntArray:
    """Node index at each grid place, (n, m), from coordinates on the grid axes (k, 2) and cells (q, 4).

    The order comes from the coordinates and is proved by the connectivity: every cell must join the four
    nodes of one unit square of the grid, and each unit square must occur once. Raises MeshError otherwise.
    """
    n, m = shape
    if len(points) != n * m or len(quads) != (n - 1) * (m - 1):
        raise MeshError(f"{name}: {len(points)} nodes and {len(quads)} cells do not make a {n} x {m} grid")
    i, j = _line_index(points[:, 0], n, name), _line_index(points[:, 1], m, name)
    order = np.full((n, m), -1, dtype=np.int64)
    order[i, j] = np.arange(len(points))
    if (order < 0).any():
        raise MeshError(f"{name}: {int((order < 0).sum())} places of the {n} x {m} grid have no node")
    i0, j0 = i[quads].min(axis=1), j[quads].min(axis=1)
    corner = np.sort(2 * (i[quads] - i0[:, None]) + (j[quads] - j0[:, None]), axis=1)
    unit = (corner == np.arange(4)).all() and (i[quads] - i0[:, None]).max() == 1
    if not unit or np.unique(i0 * (m - 1) + j0).size != len(quads):
        raise MeshError(f"{name}: the cells are not the unit squares of a {n} x {m} grid")
    return order


def _check_lines(uv: FloatArray, u_lines: FloatArray, v_lines: FloatArray, name: str) -> None:
    """MeshError if nodes (n, m, 2) are off their exact lines by over 1e-3 of the smallest cell."""
    off = max(np.abs(uv[..., 0] - u_lines[:, None]).max(), np.abs(uv[..., 1] - v_lines[None, :]).max())
    smallest = min(np.diff(u_lines).min(), np.diff(v_lines).min())
    if off > 1e-3 * smallest:
        raise MeshError(f"{name}: nodes lie up to {off:.2g} mm off their grid lines")
