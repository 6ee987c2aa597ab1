"""Signed distance of a tool on a regular grid: exact near the surface, propagated farther out."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ddf.contact.field import OUTSIDE, sample
from ddf.errors import MeshError
from ddf.mesh.closest import nearest_triangles, pseudo_normals, signed_distance
from ddf.mesh.triangles import TriangleMesh

FloatArray = NDArray[np.float64]

OUTSIDE_MM = OUTSIDE
"""Distance given for points outside the grid (far from the tool)."""

DEPTH_MM = 10.0
"""The grid starts this far below the platform z = 0."""

UNSET = 1.0e9


@dataclass(frozen=True)
class DistanceField:
    """Signed distance d of a tool (negative inside) and its unit gradient on a regular grid, tool frame."""

    values: NDArray[np.float32]
    """(nx, ny, nz, 4): d [mm], then the gradient's three components."""
    origin: FloatArray
    """Position (3,) of the first grid point [mm]."""
    spacing: float
    """Distance between grid points [mm], the same along all axes."""

    def __post_init__(self) -> None:
        """Lay the values out as the lookup reads them."""
        object.__setattr__(self, "values", np.ascontiguousarray(self.values))

    def distance(self, points: FloatArray) -> FloatArray:
        """Distance [mm] from the tool, (k,), of points (k, 3) [mm]; OUTSIDE_MM outside the grid."""
        return self._samples(points)[:, 0]

    def gradient(self, points: FloatArray) -> FloatArray:
        """Unit gradient of the distance, (k, 3), at points (k, 3) [mm]; (0, 0, 1) outside the grid."""
        return self._samples(points)[:, 1:]

    def platform_distance(self, points: FloatArray) -> FloatArray:
        """Distance [mm] from tool and platform together: min(d, z), (k,), at points (k, 3) [mm]."""
        return np.minimum(self.distance(points), np.asarray(points, dtype=np.float64)[:, 2])

    def save(self, path: str | Path) -> None:
        """Write the field as an .npz file."""
        with open(path, "wb") as stream:
            np.savez(stream, values=self.values, origin=self.origin, spacing=self.spacing)

    @classmethod
    def load(cls, path: str | Path) -> DistanceField:
        """Read a field that `save` wrote; MeshError if the file is not one."""
        try:
            with np.load(path) as data:
                return cls(data["values"], data["origin"], float(data["spacing"]))
        except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
            raise MeshError(f"{path} is not a distance field: {error}") from error

    def _samples(self, points: FloatArray) -> FloatArray:
        points = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 3)
        return sample_points(self.values, self.origin, self.spacing, points)


def distance_field(mesh: TriangleMesh, spacing_mm: float = 1.0, band_mm: float = 8.0) -> DistanceField:
    """Distance field of a closed tool on a grid of `spacing_mm` around its part above z = -10 mm.

    The grid goes `band_mm` beyond that part to the sides and above. Up to `band_mm` from the surface d is
    exact for the triangles (but for interpolation); farther out the closest surface point is taken from
    neighbouring grid points, which is good to about spacing^2/(2 d) mm. The flat underside is left out, as if
    the tool went on downward: it stands on the platform.
    """
    if not spacing_mm > 0.0 or not band_mm >= 2.0 * spacing_mm:
        raise MeshError(
            f"distance field: spacing_mm {spacing_mm}, band_mm {band_mm}",
            "spacing_mm must be positive and band_mm at least twice that",
        )
    triangles = mesh.triangles[~_underside(mesh)]
    normals = pseudo_normals(mesh)[~_underside(mesh)]
    corners = np.ascontiguousarray(mesh.points[triangles])
    low, high = _bounds_above(corners, -DEPTH_MM)
    low, high = low - [band_mm, band_mm, 0.0], high + band_mm
    origin = spacing_mm * np.floor(low / spacing_mm)
    shape = tuple((np.ceil((high - origin) / spacing_mm - 1e-9).astype(int) + 1).tolist())
    best = np.full(shape, band_mm, dtype=np.float32)
    owner = np.full(shape, -1, dtype=np.int32)
    order = np.random.default_rng(0).permutation(len(corners))
    nearest_triangles(corners, normals[:, 0].copy(), order, origin, spacing_mm, band_mm, best, owner)
    values = np.empty((*shape, 4), dtype=np.float32)
    _fill_band(corners, normals, origin, spacing_mm, owner, values)
    for si, sj in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
        _sweep(values, owner, spacing_mm, si, sj)
    return DistanceField(values, origin, float(spacing_mm))


def _underside(mesh: TriangleMesh) -> NDArray[np.bool_]:
    """(q,): triangles that lie in the lowest plane of the mesh."""
    z = mesh.points[:, 2]
    level = z.min() + 1e-6 * np.ptp(z)
    return (z[mesh.triangles] <= level).all(axis=1)


def _bounds_above(corners: FloatArray, level: float) -> tuple[FloatArray, FloatArray]:
    """Box (3,), (3,) of the part of triangles (q, 3, 3) with z >= level, edges cut at the level."""
    starts, ends = corners.reshape(-1, 3), np.roll(corners, -1, axis=1).reshape(-1, 3)
    cut = (starts[:, 2] < level) != (ends[:, 2] < level)
    a, b = starts[cut], ends[cut]
    t = (level - a[:, 2]) / (b[:, 2] - a[:, 2])
    points = np.concatenate([starts[starts[:, 2] >= level], a + t[:, None] * (b - a)])
    low, high = points.min(axis=0), points.max(axis=0)
    low[2] = level
    return low, high


@njit(cache=True)
def _fill_band(corners, normals, origin, spacing, owner, values):
    """Set d and gradient where a nearest triangle is known; UNSET elsewhere."""
    nx, ny, nz = owner.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                q = owner[i, j, k]
                if q < 0:
                    values[i, j, k, 0] = UNSET
                    values[i, j, k, 1], values[i, j, k, 2], values[i, j, k, 3] = 0.0, 0.0, 1.0
                    continue
                x, y, z = origin[0] + i * spacing, origin[1] + j * spacing, origin[2] + k * spacing
                d, gx, gy, gz = signed_distance(x, y, z, corners[q], normals[q])
                values[i, j, k, 0] = d
                values[i, j, k, 1], values[i, j, k, 2], values[i, j, k, 3] = gx, gy, gz


@njit(cache=True)
def _carry(values, i, j, k, a, b, c, x, y, z):
    """Take neighbour (a, b, c)'s closest surface point for (i, j, k) if nearer; step (x, y, z) [mm].

    The neighbour's closest point, seen from here, is at |step + d g|, as (p - c) = step + (p_nb - c). The
    sign is the neighbour's: places next to each other and far from the surface are on the same side.
    """
    e = values[a, b, c, 0]
    if e >= UNSET:
        return
    x += e * values[a, b, c, 1]
    y += e * values[a, b, c, 2]
    z += e * values[a, b, c, 3]
    square = x * x + y * y + z * z
    if square < values[i, j, k, 0] ** 2:
        d = sqrt(square) if e > 0.0 else -sqrt(square)
        values[i, j, k, 0] = d
        values[i, j, k, 1] = x / d
        values[i, j, k, 2] = y / d
        values[i, j, k, 3] = z / d


@njit(cache=True)
def _sweep(values, owner, spacing, si, sj):
    """One pass over the grid columns in the direction (si, sj) that carries closest surface points along.

    Each column takes from its two neighbours behind, then from itself upward and downward.
    """
    nx, ny, nz = owner.shape
    for ii in range(nx):
        i = ii if si > 0 else nx - 1 - ii
        for jj in range(ny):
            j = jj if sj > 0 else ny - 1 - jj
            for k in range(nz):
                if owner[i, j, k] < 0:
                    if ii > 0:
                        _carry(values, i, j, k, i - si, j, k, si * spacing, 0.0, 0.0)
                    if jj > 0:
                        _carry(values, i, j, k, i, j - sj, k, 0.0, sj * spacing, 0.0)
                    if k > 0:
                        _carry(values, i, j, k, i, j, k - 1, 0.0, 0.0, spacing)
            for k in range(nz - 2, -1, -1):
                if owner[i, j, k] < 0:
                    _carry(values, i, j, k, i, j, k + 1, 0.0, 0.0, -spacing)


@njit(cache=True)
def sample_points(values, origin, spacing, points):
    """`sample` at points (k, 3): (k, 4)."""
    out = np.empty((points.shape[0], 4))
    for p in range(points.shape[0]):
        d, nx, ny, nz = sample(values, origin, spacing, points[p, 0], points[p, 1], points[p, 2])
        out[p, 0], out[p, 1], out[p, 2], out[p, 3] = d, nx, ny, nz
    return out
