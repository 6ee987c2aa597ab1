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
def _second_differences(dy, left, own, right):
    """Weights of the second difference along a row: Y_j = left_j x_(j-1) + own_j x_j + right_j x_(j+1); 0 at its ends.

    The first entry of left, own and right belongs to no node, so that the one before each node can be asked for.
    """
    m = dy.shape[0] + 1
    for weights in (left, own, right):
        weights[:] = 0.0
    for j in range(1, m - 1):
        s = 2.0 / (dy[j - 1] + dy[j])
        left[j + 1], right[j + 1] = s / dy[j - 1], s / dy[j]
        own[j + 1] = -left[j + 1] - right[j + 1]


@njit(**FAST)
def _moment_row(xm, x0, xp, lo, hi, left, own, right, width, rigidity, mx, my):
    """Moments times area of a row of nodes, one component: D A (X + nu Y), D A (Y + nu X).

    lo, hi: cell sizes behind and before the row (0 at the edge); width (m,): of the nodes along it. Rows of moments
    begin and end with an empty place.
    """
    m = x0.shape[0]
    s = 2.0 / (lo + hi)
    p, q = (s / lo, s / hi) if lo > 0.0 and hi > 0.0 else (0.0, 0.0)
    a = 0.5 * rigidity * (lo + hi)
    my[1], my[m] = 0.0, 0.0
    for j in range(1, m - 1):
        my[j + 1] = left[j + 1] * x0[j - 1] + own[j + 1] * x0[j] + right[j + 1] * x0[j + 1]
    for j in range(m):
        cx, cy = p * (xm[j] - x0[j]) + q * (xp[j] - x0[j]), my[j + 1]
        mx[j + 1] = a * width[j] * (cx + 0.5 * cy)
        my[j + 1] = a * width[j] * (cy + 0.5 * cx)


@njit(**FAST)
def _gather_row(f, mx_m, mx_0, mx_p, my, lo2, lo, hi, hi2, left, own, right):
    """-dU/dx of row i: mx of rows i-1, i, i+1 with the four cell sizes around, my within the row."""
    down = 2.0 / ((lo2 + lo) * lo) if lo2 > 0.0 and lo > 0.0 else 0.0
    here = 2.0 / (lo * hi) if lo > 0.0 and hi > 0.0 else 0.0
    up = 2.0 / ((hi + hi2) * hi) if hi2 > 0.0 and hi > 0.0 else 0.0
    for j in range(f.shape[0]):
        along = left[j + 2] * my[j + 2] + own[j + 1] * my[j + 1] + right[j] * my[j]
        f[j] += here * mx_0[j + 1] - down * mx_m[j + 1] - up * mx_p[j + 1] - along


@njit(**INLINE)
def _size(dx, i):
    return dx[i] if 0 <= i < dx.shape[0] else 0.0


@njit(**FAST)
def plate_forces(x, f, dx, dy, rigidity, low, high, work):
    """Add -dU/dx of plate bending (without twisting) to rows low..high-1 of f.

    x, f (3, n, m); dx (n-1,), dy (m-1,) [mm]; rigidity D [N mm]; work (22, m + 2).
    """
    n, m = x.shape[1], x.shape[2]
    left, own, right, width = work[18], work[19], work[20], work[21]
    _second_differences(dy, left, own, right)
    for j in range(m):
        width[j] = 0.5 * ((dy[j - 1] if j > 0 else 0.0) + (dy[j] if j < m - 1 else 0.0))
    work[:18, 0] = 0.0
    work[:18, m + 1] = 0.0
    for i in range(low - 1, high + 1):
        row = 6 * ((i + 3) % 3)
        for c in range(3):
            if 0 <= i < n:
                _moment_row(
                    x[c, max(i - 1, 0)], x[c, i], x[c, min(i + 1, n - 1)], _size(dx, i - 1), _size(dx, i),
                    left, own, right, width, rigidity, work[row + c], work[row + 3 + c],
                )  # fmt: skip
            else:
                work[row + c] = 0.0
                work[row + 3 + c] = 0.0
        if i > low:
            k = i - 1
            a, b = 6 * ((i + 1) % 3), 6 * ((i + 2) % 3)
            for c in range(3):
                _gather_row(
                    f[c, k], work[a + c], work[b + c], work[row + c], work[b + 3 + c],
                    _size(dx, k - 2), _size(dx, k - 1), _size(dx, k), _size(dx, k + 1), left, own, right,
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
