"""Trilinear lookup in a gridded signed distance field."""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import INLINE
from ddf.quad import add_scaled, expect, load, part, scaled

OUTSIDE = 1.0e3
UP = np.uint64(4)


@njit(**INLINE)
def _edge(values, k, c):
    """Value at the share c of the edge along z from place k on."""
    return add_scaled(c, load(values, k + UP), scaled(1.0 - c, load(values, k)))


@njit(**INLINE)
def look_forward(values, origin, spacing, x, y, z):
    """Have fetched what `sample` will want to know at (x, y, z)."""
    a, b, c = (x - origin[0]) / spacing, (y - origin[1]) / spacing, (z - origin[2]) / spacing
    n, m, l = values.shape[:3]
    if a >= 0.0 and b >= 0.0 and c >= 0.0 and a < n - 1 and b < m - 1 and c < l - 1:
        along, across = np.uint64(4 * l), np.uint64(4 * l * m)
        first = np.uint64(int(a)) * across + np.uint64(int(b)) * along + np.uint64(int(c)) * UP
        expect(values, first)
        expect(values, first + along)
        expect(values, first + across)
        expect(values, first + across + along)


@njit(**INLINE)
def sample(values, origin, spacing, x, y, z):
    """Signed distance [mm] and unit gradient at (x, y, z); values (nx, ny, nz, 4): d and its gradient.

    Outside the grid: 1000 mm, gradient (0, 0, 1).
    """
    a = (x - origin[0]) / spacing
    b = (y - origin[1]) / spacing
    c = (z - origin[2]) / spacing
    if not (
        a >= 0.0
        and b >= 0.0
        and c >= 0.0
        and a < values.shape[0] - 1
        and b < values.shape[1] - 1
        and c < values.shape[2] - 1
    ):
        return OUTSIDE, 0.0, 0.0, 1.0
    i, j, k = int(a), int(b), int(c)
    a -= i
    b -= j
    c -= k
    along = np.uint64(4 * values.shape[2])
    across = along * np.uint64(values.shape[1])
    first = np.uint64(i) * across + np.uint64(j) * along + np.uint64(k) * UP
    low = add_scaled(b, _edge(values, first + along, c), scaled(1.0 - b, _edge(values, first, c)))
    first += across
    high = add_scaled(b, _edge(values, first + along, c), scaled(1.0 - b, _edge(values, first, c)))
    found = add_scaled(a, high, scaled(1.0 - a, low))
    gx, gy, gz = part(found, 1), part(found, 2), part(found, 3)
    s = 1.0 / np.sqrt(gx * gx + gy * gy + gz * gz + 1e-30)
    return part(found, 0), gx * s, gy * s, gz * s
