"""Height of the sheet over what it lies on: the tool, or a smooth base surface fitted to the sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from scipy import ndimage

from ddf.metrics.surface import Array, PlySurface, fill_inactive, gap_field

DEGREE = 5  # of the fitted base in each grid direction
PASSES = 15  # of the robust weighting
NORMAL_SMOOTHING_MM = 8.0  # of the sheet whose normal counts as outward


@dataclass(frozen=True)
class HeightField:
    """Height of each node and the lattice it belongs to, both filled over inactive nodes."""

    h: Array  # [mm] (n, m)
    x: Array  # [mm] (3, n, m)
    normal: Array  # (3, n, m) unit normal of the smoothed sheet, away from the tool


def height_field(surface: PlySurface) -> HeightField:
    """Height h = distance - offset; with no distance, over a base fitted to the sheet, h = (x - base).n."""
    x = fill_inactive(surface.x, surface.active)
    sigma = [0.0, *(NORMAL_SMOOTHING_MM / a for a in surface.spacing)]
    normal = _normal(ndimage.gaussian_filter(x, sigma, mode="nearest"))
    if surface.distance is not None:
        return HeightField(fill_inactive(gap_field(surface), surface.active), x, normal)
    base, base_normal = _fit_base(x, surface)
    return HeightField(((x - base) * base_normal).sum(axis=0), x, normal)


def _fit_base(x: Array, surface: PlySurface) -> tuple[Array, Array]:
    """Base surface and its upward unit normal, (3, n, m) each.

    Each coordinate is a product polynomial in (u, v); least squares reweighted with w = 1/(1 + (r/s)^2), s
    the median of |r|, r = (x - base).n, so that folds, which take little area, do not lift the base.
    """
    n, m = surface.shape
    rows, columns = np.arange(0, n, max(n // 50, 1)), np.arange(0, m, max(m // 50, 1))
    u, v = np.linspace(-1, 1, n), np.linspace(-1, 1, m)
    terms = chebyshev.chebvander2d(*np.meshgrid(u[rows], v[columns], indexing="ij"), [DEGREE, DEGREE])
    terms = terms.reshape(-1, (DEGREE + 1) ** 2)
    sample = x[:, rows[:, None], columns]
    present = surface.active[rows[:, None], columns].ravel().astype(float)
    weights, solution = present, np.zeros((terms.shape[1], 3))
    for _ in range(PASSES):
        scaled = terms * weights[:, None]
        solution = np.linalg.lstsq(scaled.T @ terms, scaled.T @ sample.reshape(3, -1).T, rcond=None)[0]
        base = (terms @ solution).T.reshape(sample.shape)
        residual = ((sample - base) * _normal(base)).sum(axis=0).ravel()
        scale = max(1.5 * float(np.median(np.abs(residual[present > 0]))), 1e-3)
        weights = present / (1 + (residual / scale) ** 2)
    coefficients = solution.T.reshape(3, DEGREE + 1, DEGREE + 1)
    base = np.stack([chebyshev.chebgrid2d(u, v, part) for part in coefficients])
    return base, _normal(base)


def _normal(x: Array) -> Array:
    """Unit normals t1 x t2 of a lattice (3, n, m), turned so that their mean points up."""
    normal = _unit(np.cross(np.gradient(x, axis=1), np.gradient(x, axis=2), axis=0), axis=0)
    return -normal if normal[2].mean() < 0 else normal


def _unit(vectors: Array, axis: int) -> Array:
    size = np.linalg.norm(vectors, axis=axis, keepdims=True)
    return np.asarray(vectors / np.maximum(size, 1e-300))
