"""The lattice of a ply: a grid of nodes along its two fibre families, cut to the outline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from ddf.errors import MeshError
from ddf.mesh.grid import Block, mesh_grid
from ddf.mesh.outline import cell_fractions, clean_outline, crossed_cells, resample, signed_area

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SMALLEST_FRACTION = 0.02
"""Cells with less of their area inside the outline than this are left out (a fraction of 0)."""


@dataclass(frozen=True)
class PlyMesh:
    """The lattice of a ply, n x m nodes; the first index runs along family 1, the second along family 2.

    Grid coordinates (u, v) are in cells: node (i, j) is at u = i, v = j.
    """

    name: str
    x: FloatArray
    """Positions (3, n, m) [mm], z = 0."""
    spacing: tuple[float, float]
    """Cell edges a1, a2 [mm] along families 1 and 2."""
    cell_fraction: FloatArray
    """Part of each cell that is fabric, (n-1, m-1); 0 where left out (tiny or slit)."""
    active: NDArray[np.bool_]
    """(n, m): nodes of at least one cell with a fraction above 0."""
    outline: list[FloatArray]
    """Closed loops (k, 2) of material points (u, v), no segment over half an element: the boundary
    counterclockwise, then the holes clockwise."""
    corners: list[IntArray]
    """For each loop the indices of its corners (vertices that turn by over 10 degrees)."""
    outline_cells: list[IntArray]
    """For each loop point (k, 2) the nearest cell that is fabric. A point beside it (in a cell left out) is
    reached by extending that cell's bilinear map."""
    area_mm2: float
    """Area of the lattice, sum(cell_fraction) a1 a2 [mm2]."""
    outline_area_mm2: float
    """Exact area of the polygon less its holes [mm2]; slits and tiny cells are the difference."""

    def outline_points(self, x: FloatArray | None = None) -> list[FloatArray]:
        """Positions (k, 3) [mm] of the outline's material points for node positions x (3, n, m)."""
        at = self.x if x is None else x
        points = []
        for loop, cells in zip(self.outline, self.outline_cells, strict=True):
            i, j = cells.T
            xi, eta = (loop - cells).T
            points.append(
                (
                    at[:, i, j] * (1 - xi) * (1 - eta)
                    + at[:, i + 1, j] * xi * (1 - eta)
                    + at[:, i, j + 1] * (1 - xi) * eta
                    + at[:, i + 1, j + 1] * xi * eta
                ).T
            )
        return points


def mesh_ply(
    polygon: ArrayLike,
    holes: Sequence[ArrayLike],
    slits: Sequence[ArrayLike],
    orientation_deg: float,
    element_mm: float,
    offset: tuple[float, float] = (0.0, 0.0),
    name: str = "ply-1",
    even: bool = False,
    rings: int = 0,
) -> PlyMesh:
    """Lattice of a ply with the outline `polygon` (k, 2) [mm] less `holes`, moved by `offset` [mm].

    Family 1 runs along (cos t, sin t), family 2 along (-sin t, cos t), t = `orientation_deg`; the outline
    is not turned with them. If the outline is a rectangle along the fibres, the cells are fitted to it (edges
    as close to `element_mm` as whole numbers allow); otherwise they measure exactly `element_mm` and the
    lattice is centred on the outline's box in fibre axes. Cut cells carry their exact area fraction, set to
    0 under 0.02. A slit (polyline (p, 2), zero width) takes out the cells it crosses: it is one cell wide.
    With `even` the numbers of cells along both families are even. `rings` of nodes more lie all around.
    Raises MeshError for an outline that is not simple or smaller than two elements.
    """
    if not element_mm > 0.0:
        raise MeshError(f"{name}: element_mm must be positive, not {element_mm}")
    angle = np.deg2rad(orientation_deg)
    to_fibre = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    loops = [(loop + np.asarray(offset)) @ to_fibre.T for loop in clean_outline(polygon, list(holes), name)]
    blocks = [_widened(block, rings) for block in _fit_lattice(loops[0], element_mm, name, even)]
    x = mesh_grid([blocks[0]], [blocks[1]], orientation_deg, name)
    start = np.array([b.start for b in blocks])
    spacing = np.array([(b.stop - b.start) / b.cells for b in blocks])
    cells = (blocks[0].cells, blocks[1].cells)
    grid_loops = [np.clip((loop - start) / spacing, rings, np.array(cells) - rings) for loop in loops]
    fraction = cell_fractions(grid_loops, cells)
    fraction[fraction < SMALLEST_FRACTION] = 0.0
    for slit in slits:
        line = (np.asarray(slit, dtype=np.float64) + np.asarray(offset)) @ to_fibre.T
        fraction[tuple(crossed_cells((line - start) / spacing, cells).T)] = 0.0
    if not fraction.any():
        raise MeshError(f"{name}: no cell of the lattice is left", "make element_mm smaller")
    a1, a2 = float(spacing[0]), float(spacing[1])
    samples = [resample(loop, (a1, a2), 0.5 * min(a1, a2)) for loop in grid_loops]
    active = _active_nodes(fraction)
    return PlyMesh(
        name=name,
        x=x,
        spacing=(a1, a2),
        cell_fraction=fraction,
        active=active,
        outline=[points for points, _ in samples],
        corners=[corners for _, corners in samples],
        outline_cells=[_fabric_cells(points, fraction) for points, _ in samples],
        area_mm2=float(fraction.sum()) * a1 * a2,
        outline_area_mm2=sum(signed_area(loop) for loop in loops),
    )


def _fit_lattice(outer: FloatArray, element_mm: float, name: str, even: bool) -> list[Block]:
    """The extent and number of cells of the lattice along both families, for the outline in fibre axes."""
    low, high = outer.min(axis=0), outer.max(axis=0)
    size = high - low
    if (size < 2.0 * element_mm).any():
        raise MeshError(
            f"{name}: an outline of {size[0]:.4g} x {size[1]:.4g} mm along the fibres is under two elements",
            f"make element_mm smaller than {0.5 * size.min():.4g}",
        )
    if abs(signed_area(outer) - size[0] * size[1]) < 1e-9 * size[0] * size[1]:
        step = 2 if even else 1
        cells = step * np.round(size / (step * element_mm)).astype(np.int64)
    else:
        cells = np.ceil(size / element_mm - 1e-9).astype(np.int64)
        cells += cells % 2 if even else 0
        middle = 0.5 * (low + high)
        low, high = middle - 0.5 * cells * element_mm, middle + 0.5 * cells * element_mm
    return [Block(float(a), float(b), int(c)) for a, b, c in zip(low, high, cells, strict=True)]


def _widened(block: Block, rings: int) -> Block:
    """A block with so many cells more at both ends."""
    step = (block.stop - block.start) / block.cells
    return Block(block.start - rings * step, block.stop + rings * step, block.cells + 2 * rings)


def _active_nodes(fraction: FloatArray) -> NDArray[np.bool_]:
    """(n, m): nodes that touch a cell whose fraction is above 0."""
    live = np.pad(fraction, 1) > 0.0
    active: NDArray[np.bool_] = live[1:, 1:] | live[:-1, 1:] | live[1:, :-1] | live[:-1, :-1]
    return active


def _fabric_cells(points: FloatArray, fraction: FloatArray) -> IntArray:
    """For each point (k, 2) in grid coordinates the cell it is in, or the nearest one that is fabric."""
    cells = np.clip(np.floor(points).astype(np.int64), 0, np.array(fraction.shape) - 1)
    lost = fraction[cells[:, 0], cells[:, 1]] == 0.0
    if lost.any():
        live = np.argwhere(fraction > 0.0)
        cells[lost] = live[cKDTree(live + 0.5).query(points[lost])[1]]
    return cells
