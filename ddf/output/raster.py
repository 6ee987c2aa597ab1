"""A sheet seen from above: for every pixel its height and its place on the sheet's grid (a z-buffer)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ddf.metrics.surface import PlySurface, at_points, inside_outline

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class TopView:
    """What is seen from above; images are (rows, columns) with y upward, so draw with origin="lower"."""

    box: Box  # x from, x to, y from, y to [mm]
    pixel_mm: float
    z: Array  # [mm] height; the floor's where there is no sheet
    u: Array  # grid coordinates; cell (i, j) spans u in i .. i+1, v in j .. j+1
    v: Array
    covered: Mask  # where there is sheet

    def cells(self, values: Array) -> Array:
        """Image of a cell field (n-1, m-1); NaN where there is no sheet."""
        image = np.full(self.z.shape, np.nan)
        i = np.clip(self.u[self.covered].astype(np.int64), 0, values.shape[0] - 1)
        j = np.clip(self.v[self.covered].astype(np.int64), 0, values.shape[1] - 1)
        image[self.covered] = values[i, j]
        return image

    def nodes(self, values: Array) -> Array:
        """Images (..., rows, columns) of a node field (n, m) or (c, n, m); NaN where there is no sheet."""
        stacked = values.reshape(-1, *values.shape[-2:])
        image = np.full((len(stacked), *self.z.shape), np.nan)
        image[:, self.covered] = at_points(stacked, np.stack([self.u[self.covered], self.v[self.covered]], axis=1)).T
        return image if values.ndim == 3 else image[0]


def view_from_above(
    x: Array,
    exists: Mask,
    box: Box,
    pixels: int = 1400,
    surface: PlySurface | None = None,
    floor_mm: float | None = None,
) -> TopView:
    """Look down on the cells that exist of a sheet x (3, n, m) [mm].

    `pixels` along the longer side of the box. With `surface` the sheet is cut at its outline, else at whole
    cells. `floor_mm` is the height where there is no sheet, left out: that of the sheet's lowest node.
    """
    pixel = max(box[1] - box[0], box[3] - box[2]) / pixels
    shape = (max(1, round((box[3] - box[2]) / pixel)), max(1, round((box[1] - box[0]) / pixel)))
    z = np.full(shape, -np.inf)
    u, v = np.zeros(shape), np.zeros(shape)
    columns = np.ascontiguousarray((x[0] - box[0]) / pixel - 0.5)
    rows = np.ascontiguousarray((x[1] - box[2]) / pixel - 0.5)
    _fill(columns, rows, np.ascontiguousarray(x[2]), np.ascontiguousarray(exists), z, u, v)
    covered = np.isfinite(z)
    if surface is not None:
        covered[covered] = inside_outline(surface, np.stack([u[covered], v[covered]], axis=1))
    floor = float(np.nanmin(np.where(covered, z, np.nan))) if floor_mm is None and covered.any() else floor_mm
    z[~covered] = 0.0 if floor is None else floor
    return TopView(box, pixel, z, u, v, covered)


@njit(cache=True)
def _fill(columns: Array, rows: Array, height: Array, exists: Mask, z: Array, u: Array, v: Array) -> None:
    """Draw both triangles of every cell into z, u and v, the highest on top."""
    n, m = height.shape
    for i in range(n - 1):
        for j in range(m - 1):
            if exists[i, j]:
                for half in range(2):
                    ib, jb = (i + 1, j) if half == 0 else (i + 1, j + 1)
                    ic, jc = (i + 1, j + 1) if half == 0 else (i, j + 1)
                    _triangle(columns, rows, height, i, j, ib, jb, ic, jc, z, u, v)


@njit(cache=True)
def _triangle(
    columns: Array, rows: Array, height: Array, ia: int, ja: int, ib: int, jb: int, ic: int, jc: int,
    z: Array, u: Array, v: Array,
) -> None:  # fmt: skip
    """Draw the triangle of nodes a, b, c where it is higher than what is there."""
    ax, ay = columns[ia, ja], rows[ia, ja]
    bx, by = columns[ib, jb] - ax, rows[ib, jb] - ay
    cx, cy = columns[ic, jc] - ax, rows[ic, jc] - ay
    area = bx * cy - by * cx
    if abs(area) < 1e-12:
        return
    for row in range(max(0, int(np.ceil(ay + min(0.0, by, cy)))), min(z.shape[0], int(ay + max(0.0, by, cy)) + 1)):
        for col in range(max(0, int(np.ceil(ax + min(0.0, bx, cx)))), min(z.shape[1], int(ax + max(0.0, bx, cx)) + 1)):
            px, py = col - ax, row - ay
            s = (px * cy - py * cx) / area
            t = (bx * py - by * px) / area
            if s >= -1e-9 and t >= -1e-9 and s + t <= 1.0 + 1e-9:
                r = 1.0 - s - t
                top = r * height[ia, ja] + s * height[ib, jb] + t * height[ic, jc]
                if top > z[row, col]:
                    z[row, col] = top
                    u[row, col] = r * ia + s * ib + t * ic
                    v[row, col] = r * ja + s * jb + t * jc
