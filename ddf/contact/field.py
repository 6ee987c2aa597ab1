"""Trilinear lookup in a gridded signed distance field."""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import INLINE

OUTSIDE = 1.0e3


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
    d = gx = gy = gz = 0.0
    for p in range(2):
        wp = a if p else 1.0 - a
        for q in range(2):
            wq = wp * (b if q else 1.0 - b)
            for r in range(2):
                w = wq * (c if r else 1.0 - c)
                cell = values[i + p, j + q, k + r]
                d += w * cell[0]
                gx += w * cell[1]
                gy += w * cell[2]
                gz += w * cell[3]
    s = 1.0 / np.sqrt(gx * gx + gy * gy + gz * gz + 1e-30)
    return d, gx * s, gy * s, gz * s
