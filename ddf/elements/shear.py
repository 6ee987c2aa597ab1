"""Trellis shear of the lattice ply: one point a cell.

With t1, t2 the means of a cell's opposite edges and  s = sin g = t1.t2 / (|t1||t2|)  the cell of area A
stores  U = A W(s),  dW/ds = N_s(g),  N_s the normalised shear force [N/mm]. The law comes as a table
of cubics over |s| (see `materials.shear_law.shear_table`), so that any law costs the same.

    dU/dt1 = A W'(s) (e2 - s e1)/|t1|,   dU/dt2 = A W'(s) (e1 - s e2)/|t2|
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.tension import FAST


@njit(**FAST)
def _tangents(xa, xb, t1, t2):
    """Means of opposite edges of a row of cells, one component: xa row i, xb row i+1."""
    for j in range(t1.shape[0]):
        p = xb[j + 1] - xa[j]
        q = xb[j] - xa[j + 1]
        t1[j] = 0.5 * (p + q)
        t2[j] = 0.5 * (p - q)


@njit(**FAST)
def _sines(t1x, t1y, t1z, t2x, t2y, t2z, r1, r2, s):
    """Inverse lengths of the tangents and the sine of the shear angle."""
    for j in range(s.shape[0]):
        a = 1.0 / np.sqrt(t1x[j] * t1x[j] + t1y[j] * t1y[j] + t1z[j] * t1z[j])
        b = 1.0 / np.sqrt(t2x[j] * t2x[j] + t2y[j] * t2y[j] + t2z[j] * t2z[j])
        r1[j] = a
        r2[j] = b
        s[j] = (t1x[j] * t2x[j] + t1y[j] * t2y[j] + t1z[j] * t2z[j]) * a * b


@njit(**FAST)
def _slopes(s, cell, table, slope):
    """Slope = A dW/ds from the table; beyond its end the last cubic goes on."""
    last = table.shape[0] - 2
    step = 1.0 / table[table.shape[0] - 1, 0]  # the last row holds the width of an interval
    for j in range(s.shape[0]):
        z = abs(s[j]) * step
        k = min(int(z), last)
        u = z - k
        c = table[k]
        w = c[0] + u * (c[1] + u * (c[2] + u * c[3]))
        slope[j] = cell[j] * (w if s[j] >= 0.0 else -w)


@njit(**FAST)
def _pull(t1, t2, r1, r2, s, slope, plus, minus):
    """Plus = (G1 + G2)/2 and minus = (G1 - G2)/2 of one component, G = -dU/dt."""
    for j in range(s.shape[0]):
        e1 = t1[j] * r1[j]
        e2 = t2[j] * r2[j]
        g1 = -slope[j] * (e2 - s[j] * e1) * r1[j]
        g2 = -slope[j] * (e1 - s[j] * e2) * r2[j]
        plus[j] = 0.5 * (g1 + g2)
        minus[j] = 0.5 * (g1 - g2)


@njit(**FAST)
def _gather(f, plus0, minus0, plus1, minus1):
    """Add to a row of nodes from the cells below (0: row i-1) and above (1: row i); one component.

    The cell buffers start with an empty cell, so that entry j is the cell left of node j.
    """
    for j in range(f.shape[0]):
        f[j] += plus0[j] + minus0[j + 1] - minus1[j] - plus1[j + 1]


@njit(**FAST)
def shear_forces(x, f, cell, table, low, high, work):
    """Add -dU/dx of trellis shear to rows low..high-1 of f.

    x, f (3, n, m) [mm], [N]; cell (n, m) area of existing cells [mm2]; table (K, 5); work (21, m + 2).
    """
    n, m = x.shape[1], x.shape[2]
    c = m - 1
    work[:] = 0.0
    for i in range(low - 1, high):
        old = 9 if i & 1 else 15
        new = 24 - old
        if 0 <= i < n - 1:
            for k in range(3):
                _tangents(x[k, i], x[k, i + 1], work[k, :c], work[3 + k, :c])
            r1, r2, s = work[6, :c], work[7, :c], work[8, :c]
            _sines(work[0, :c], work[1, :c], work[2, :c], work[3, :c], work[4, :c], work[5, :c], r1, r2, s)
            slope = work[21, :c]
            _slopes(s, cell[i, :c], table, slope)
            for k in range(3):
                _pull(
                    work[k, :c], work[3 + k, :c], r1, r2, s, slope,
                    work[new + k, 1 : c + 1], work[new + 3 + k, 1 : c + 1],
                )  # fmt: skip
        else:
            work[new : new + 6] = 0.0
        if i >= low:
            for k in range(3):
                _gather(f[k, i], work[old + k], work[old + 3 + k], work[new + k], work[new + 3 + k])


def shear_sine(x: np.ndarray) -> np.ndarray:
    """Sine of the shear angle of every cell, (n-1, m-1), from x (3, n, m) [mm]."""
    t1 = 0.5 * (x[:, 1:, :-1] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:])
    t2 = 0.5 * (x[:, :-1, 1:] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, 1:, :-1])
    return (t1 * t2).sum(axis=0) / np.sqrt((t1 * t1).sum(axis=0) * (t2 * t2).sum(axis=0))


def shear_energy(x: np.ndarray, cell: np.ndarray, table: np.ndarray) -> float:
    """Sum of A W(s) [N mm]; the integral of the table's cubics."""
    s = np.abs(shear_sine(x))
    area = cell[:-1, :-1]
    width = table[-1, 0]
    k = np.minimum((s / width).astype(np.int64), table.shape[0] - 2)
    u = s / width - k
    c = table[k]
    w = c[..., 4] + width * u * (c[..., 0] + u * (c[..., 1] / 2 + u * (c[..., 2] / 3 + u * c[..., 3] / 4)))
    return float(np.sum(np.where(area > 0, area * w, 0.0)))
