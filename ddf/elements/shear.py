"""Trellis shear of the lattice ply: one point a cell.

With t1, t2 the means of a cell's opposite edges and  s = sin g = t1.t2 / (|t1||t2|)  the cell of area A
stores  U = A W(s),  dW/ds = N_s(g),  N_s the normalised shear force [N/mm]. The law comes as a table
of cubics over |s| (see `materials.shear_law.shear_table`), so that any law costs the same.

    dU/dt1 = A W'(s) (e2 - s e1)/|t1|,   dU/dt2 = A W'(s) (e1 - s e2)/|t2|
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.cells import MINUS, NEXT, ONE, PLUS, SHARES, TILE, WEIGHTLESS, add_shares, filled, tangents
from ddf.jit import FAST

# fields of `w`, the scratch of a tile
R1, R2, S, INTERVAL, PART, SLOPE = (np.uint64(k * TILE) for k in range(6))
SCRATCH = 6 * TILE + SHARES


@njit(**FAST)
def _sines(x, i, start, count, step, last, w):
    """Inverse lengths of the tangents, sine of the shear angle, its interval in the table and the place in it.

    step: intervals a unit of the sine; last: the last interval, whose cubic goes on.
    """
    for t in range(count):
        ax, bx = tangents(x, 0, i, start + t)
        ay, by = tangents(x, 1, i, start + t)
        az, bz = tangents(x, 2, i, start + t)
        a = 1.0 / np.sqrt(ax * ax + ay * ay + az * az)
        b = 1.0 / np.sqrt(bx * bx + by * by + bz * bz)
        s = (ax * bx + ay * by + az * bz) * a * b
        z = abs(s) * step
        k = min(np.floor(z), last)
        w[R1 + t] = a
        w[R2 + t] = b
        w[S + t] = s
        w[INTERVAL + t] = k
        w[PART + t] = z - k


@njit(**FAST)
def _slopes(table, last, count, w):
    """|dW/ds| from the table; an interval that is no number (a broken run) reads the first row."""
    for t in range(count):
        k = np.uint64(min(max(int(w[INTERVAL + t]), 0), last))
        u = w[PART + t]
        w[SLOPE + t] = table[k, 0] + u * (table[k, 1] + u * (table[k, 2] + u * table[k, 3]))


@njit(**FAST)
def _pull(x, cell, i, start, count, w, g):
    """Set plus = (G1 + G2)/2 and minus = (G1 - G2)/2 of all components, G = -dU/dt."""
    for t in range(count):
        r1, r2, s, slope = w[R1 + t], w[R2 + t], w[S + t], -0.5 * w[SLOPE + t] * cell[i, start + t]
        slope = slope if s >= 0.0 else -slope
        a11, a22, a12 = slope * s * r1 * r1, slope * s * r2 * r2, slope * r1 * r2
        a, b = tangents(x, 0, i, start + t)
        g1, g2 = a12 * b - a11 * a, a12 * a - a22 * b
        o = t + ONE
        g[PLUS + o], g[MINUS + o] = g1 + g2, g1 - g2
        a, b = tangents(x, 1, i, start + t)
        g1, g2 = a12 * b - a11 * a, a12 * a - a22 * b
        o += NEXT
        g[PLUS + o], g[MINUS + o] = g1 + g2, g1 - g2
        a, b = tangents(x, 2, i, start + t)
        g1, g2 = a12 * b - a11 * a, a12 * a - a22 * b
        o += NEXT
        g[PLUS + o], g[MINUS + o] = g1 + g2, g1 - g2


@njit(**FAST)
def shear_forces(x, f, cell, table, low, high, work):
    """Add -dU/dx of trellis shear to rows low..high-1 of f.

    x, f (3, n, m) [mm], [N]; cell (n, m) area of existing cells [mm2]; table (K, 5); work: at least SCRATCH
    numbers, flat.
    """
    n, m = x.shape[1], x.shape[2]
    last = table.shape[0] - 2
    step = 1.0 / table[last + 1, 0]  # the last row holds the width of an interval
    w, g = work[: 6 * TILE], work[6 * TILE : SCRATCH]
    for i in range(max(low - 1, 0), min(high, n - 1)):
        row = np.uint64(i)
        begin, end = filled(cell, i, WEIGHTLESS)
        for first in range(begin, min(end, m - 1), TILE):
            start, count = np.uint64(first), np.uint64(min(TILE, min(end, m - 1) - first))
            _sines(x, row, start, count, step, np.float64(last), w)
            _slopes(table, last, count, w)
            _pull(x, cell, row, start, count, w, g)
            add_shares(f, row, start, count, g, low, high)


def shear_sine(x: np.ndarray) -> np.ndarray:
    """Sine of the shear angle of every cell, (n-1, m-1), from x (3, n, m) [mm]."""
    t1 = 0.5 * (x[:, 1:, :-1] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:])
    t2 = 0.5 * (x[:, :-1, 1:] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, 1:, :-1])
    return (t1 * t2).sum(axis=0) / np.sqrt((t1 * t1).sum(axis=0) * (t2 * t2).sum(axis=0))


def shear_energy(x: np.ndarray, cell: np.ndarray, table: np.ndarray) -> float:
    """Sum of A W(s) [N mm] over all cells."""
    return table_energy(shear_sine(x), cell[:-1, :-1], table)


def table_energy(sine: np.ndarray, area: np.ndarray, table: np.ndarray) -> float:
    """Sum of A W(s) [N mm] for sines s and areas A of one shape; the integral of the table's cubics."""
    s = np.abs(sine)
    width = table[-1, 0]
    k = np.minimum((np.nan_to_num(s) / width).astype(np.int64), table.shape[0] - 2)
    u = s / width - k
    c = table[k]
    w = c[..., 4] + width * u * (c[..., 0] + u * (c[..., 1] / 2 + u * (c[..., 2] / 3 + u * c[..., 3] / 4)))
    return float(np.sum(np.where(area > 0, area * w, 0.0)))
