"""Plate bending of a diaphragm on its graded grid, the terms along its lines.

With second differences in reference lengths, X = x_,xx and Y = x_,yy as vectors,

    U = 1/2 D A (|X|^2 + |Y|^2 + 2 nu X.Y),   nu = 1/2,

plus the twisting term of `rubber.py`. Vectors are turned with the sheet, so the energy is objective; for a
sheet bent without stretch X = k n. In-plane gradients of stretch are penalised too, over a length of
t / sqrt 12, which is far below an element. Stretch enters through the reference lengths only.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import FAST, INLINE


@njit(**FAST)
def _curvature_row(xm, x0, xp, lo, hi, dy, cx, cy):
    """X and Y of a row of nodes, one component; lo, hi: cell sizes behind and before (0 at the edge)."""
    m = x0.shape[0]
    if lo > 0.0 and hi > 0.0:
        s = 2.0 / (lo + hi)
        p, q = s / lo, s / hi
        for j in range(m):
            cx[j] = p * xm[j] + q * xp[j] - (p + q) * x0[j]
    else:
        cx[:] = 0.0
    for j in range(1, m - 1):
        s = 2.0 / (dy[j - 1] + dy[j])
        cy[j] = s * ((x0[j + 1] - x0[j]) / dy[j] - (x0[j] - x0[j - 1]) / dy[j - 1])
    cy[0] = 0.0
    cy[m - 1] = 0.0


@njit(**FAST)
def _moment_row(cx, cy, wx, dy, rigidity, mx, my):
    """Moments times area: D A (X + nu Y), D A (Y + nu X)."""
    m = cx.shape[0]
    for j in range(m):
        wy = 0.5 * ((dy[j - 1] if j > 0 else 0.0) + (dy[j] if j < m - 1 else 0.0))
        a = rigidity * wx * wy
        p = cx[j]
        q = cy[j]
        mx[j] = a * (p + 0.5 * q)
        my[j] = a * (q + 0.5 * p)


@njit(**FAST)
def _gather_row(f, mx_m, mx_0, mx_p, my, lo2, lo, hi, hi2, dy):
    """-dU/dx of row i: mx of rows i-1, i, i+1 with the four cell sizes around, my within the row."""
    m = f.shape[0]
    down = 2.0 / ((lo2 + lo) * lo) if lo2 > 0.0 and lo > 0.0 else 0.0
    own = 2.0 / (lo * hi) if lo > 0.0 and hi > 0.0 else 0.0
    up = 2.0 / ((hi + hi2) * hi) if hi2 > 0.0 and hi > 0.0 else 0.0
    for j in range(m):
        f[j] += own * mx_0[j] - down * mx_m[j] - up * mx_p[j]
    for j in range(1, m - 1):
        f[j] += 2.0 / (dy[j - 1] * dy[j]) * my[j]
    for j in range(m - 2):
        f[j] -= 2.0 / (dy[j] * (dy[j] + dy[j + 1])) * my[j + 1]
    for j in range(2, m):
        f[j] -= 2.0 / (dy[j - 1] * (dy[j - 2] + dy[j - 1])) * my[j - 1]


@njit(**INLINE)
def _size(dx, i):
    return dx[i] if 0 <= i < dx.shape[0] else 0.0


@njit(**FAST)
def plate_forces(x, f, dx, dy, rigidity, low, high, work):
    """Add -dU/dx of plate bending (without twisting) to rows low..high-1 of f.

    x, f (3, n, m); dx (n-1,), dy (m-1,) [mm]; rigidity D [N mm]; work (20, m + 2).
    """
    n, m = x.shape[1], x.shape[2]
    cx, cy = work[18, :m], work[19, :m]
    for i in range(low - 1, high + 1):
        row = 6 * ((i + 3) % 3)
        for c in range(3):
            mx, my = work[row + c, :m], work[row + 3 + c, :m]
            if 0 <= i < n:
                lo, hi = _size(dx, i - 1), _size(dx, i)
                _curvature_row(x[c, max(i - 1, 0)], x[c, i], x[c, min(i + 1, n - 1)], lo, hi, dy, cx, cy)
                _moment_row(cx, cy, 0.5 * (lo + hi), dy, rigidity, mx, my)
            else:
                mx[:] = 0.0
                my[:] = 0.0
        if i > low:
            k = i - 1
            a, b = 6 * ((i + 1) % 3), 6 * ((i + 2) % 3)
            for c in range(3):
                _gather_row(
                    f[c, k], work[a + c, :m], work[b + c, :m], work[row + c, :m], work[b + 3 + c, :m],
                    _size(dx, k - 2), _size(dx, k - 1), _size(dx, k), _size(dx, k + 1), dy,
                )  # fmt: skip


def plate_energy(x: np.ndarray, dx: np.ndarray, dy: np.ndarray, rigidity: float) -> float:
    """Bending energy of the diaphragm without its twisting term [N mm]."""

    def second(axis: int, d: np.ndarray) -> np.ndarray:
        y = np.moveaxis(x, axis, -1)
        slope = np.diff(y, axis=-1) / d
        c = np.zeros_like(y)
        c[..., 1:-1] = 2.0 * np.diff(slope, axis=-1) / (d[:-1] + d[1:])
        return np.moveaxis(c, -1, axis)

    cx, cy = second(1, dx), second(2, dy)
    wx = 0.5 * (np.concatenate([[0], dx]) + np.concatenate([dx, [0]]))
    wy = 0.5 * (np.concatenate([[0], dy]) + np.concatenate([dy, [0]]))
    density = (cx * cx + cy * cy + cx * cy).sum(axis=0)
    return float(0.5 * rigidity * np.sum(wx[:, None] * wy[None, :] * density))
