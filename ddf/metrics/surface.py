"""A formed ply as the metrics see it: positions on the lattice, its outline and the distance to the tool."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import ndimage

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Distance = Callable[[Array], Array]


@dataclass(frozen=True)
class PlySurface:
    """The mid-surface of one ply on its lattice; the first index runs along fibre family 1."""

    name: str
    x: Array  # [mm] (3, n, m) deformed positions
    x0: Array  # [mm] (3, n, m) initial positions
    spacing: tuple[float, float]  # [mm] initial node distance along family 1 and family 2
    active: Mask  # (n, m) nodes that belong to the ply
    cell_fraction: Array  # [-] (n-1, m-1) share of each cell inside the outline
    outline: list[Array] = field(default_factory=list)  # loops (k, 2), grid coordinates (u, v)
    corners: list[NDArray[np.int64]] = field(default_factory=list)  # corner points of each loop
    offset_mm: float = 0.0  # [mm] distance of the mid-surface from the tool where it conforms
    distance: Distance | None = None  # [mm] (k, 3) -> (k,) signed distance to tool and platform

    @property
    def shape(self) -> tuple[int, int]:
        """Nodes along each family."""
        return self.x.shape[1], self.x.shape[2]


def cell_area(surface: PlySurface) -> Array:
    """Initial area of each cell inside the outline [mm2], (n-1, m-1)."""
    return surface.cell_fraction * (surface.spacing[0] * surface.spacing[1])


def node_area(surface: PlySurface) -> Array:
    """Initial area each node stands for [mm2], (n, m): a quarter of every cell around it."""
    quarter = 0.25 * cell_area(surface)
    area = np.zeros(surface.shape)
    for i in (0, 1):
        for j in (0, 1):
            area[i : i + quarter.shape[0], j : j + quarter.shape[1]] += quarter
    return area * surface.active


def fill_inactive(values: Array, active: Mask) -> Array:
    """Copy of `values` (n, m) or (c, n, m) with each inactive node given its nearest active node's value."""
    if active.all():
        return np.array(values, dtype=np.float64)
    i, j = ndimage.distance_transform_edt(~active, return_distances=False, return_indices=True)
    return np.array(values[..., i, j], dtype=np.float64)


def at_points(values: Array, uv: Array) -> Array:
    """Bilinear values of a node field (c, n, m) at grid coordinates uv (k, 2), as (k, c)."""
    found = np.empty((len(uv), len(values)))
    _bilinear(np.ascontiguousarray(values, dtype=np.float64), np.ascontiguousarray(uv, dtype=np.float64), found)
    return found


@njit(cache=True)
def _bilinear(values: Array, uv: Array, found: Array) -> None:
    """Fill found (k, c) with the values (c, n, m) at uv (k, 2)."""
    n, m = values.shape[1], values.shape[2]
    for k in range(uv.shape[0]):
        i = min(max(int(np.floor(uv[k, 0])), 0), n - 2)
        j = min(max(int(np.floor(uv[k, 1])), 0), m - 2)
        s, t = uv[k, 0] - i, uv[k, 1] - j
        for c in range(values.shape[0]):
            low = (1 - s) * values[c, i, j] + s * values[c, i + 1, j]
            high = (1 - s) * values[c, i, j + 1] + s * values[c, i + 1, j + 1]
            found[k, c] = (1 - t) * low + t * high


def gap_field(surface: PlySurface) -> Array:
    """Gap to the tool [mm], (n, m): distance - offset; NaN at inactive nodes or with no distance."""
    gap = np.full(surface.shape, np.nan)
    if surface.distance is not None:
        gap[surface.active] = surface.distance(_points(surface.x, surface.active)) - surface.offset_mm
    return gap


def inside_outline(surface: PlySurface, uv: Array) -> Mask:
    """Whether grid coordinates uv (k, 2) lie in the outline (even-odd over all loops; edges included)."""
    n, m = surface.shape
    inside = np.all((uv >= 0) & (uv <= (n - 1, m - 1)), axis=1)
    i = np.clip(uv[:, 0].astype(int), 0, n - 2)
    j = np.clip(uv[:, 1].astype(int), 0, m - 2)
    share = surface.cell_fraction[i, j]
    if not surface.outline:
        return inside & (share > 0)
    inside &= share > 0
    cut = np.nonzero(inside & (share < 1 - 1e-9))[0]  # only cells on the outline need the test
    loops = [np.vstack([loop, loop[:1]]) for loop in surface.outline]
    starts = np.vstack([loop[:-1] for loop in loops])
    ends = np.vstack([loop[1:] for loop in loops])
    inside[cut] = _even_odd(np.ascontiguousarray(uv[cut]), starts, ends, 1e-6)
    return inside


def _points(x: Array, active: Mask) -> Array:
    return np.ascontiguousarray(x[:, active].T)


@njit(cache=True)
def _even_odd(points: Array, starts: Array, ends: Array, tolerance: float) -> Mask:
    """Even-odd rule for points (k, 2) and edges (e, 2); points within `tolerance` of an edge are inside."""
    inside = np.zeros(points.shape[0], dtype=np.bool_)
    for k in range(points.shape[0]):
        u, v = points[k]
        odd = False
        for e in range(starts.shape[0]):
            au, av = starts[e]
            bu, bv = ends[e]
            if (av > v) != (bv > v) and u < au + (v - av) * (bu - au) / (bv - av):
                odd = not odd
            du, dv = bu - au, bv - av
            length2 = du * du + dv * dv
            t = 0.0
            if length2 > 0.0:
                t = min(1.0, max(0.0, ((u - au) * du + (v - av) * dv) / length2))
            if (au + t * du - u) ** 2 + (av + t * dv - v) ** 2 < tolerance * tolerance:
                odd = True
                break
        inside[k] = odd
    return inside
