"""Cells with one point: their mean tangents, and how forces on these reach the four nodes.

A row of cells goes in tiles of TILE, whose scratch stays in the first cache. With G1, G2 the forces that belong to the
tangents t1, t2 (the means of opposite edges) the corners get  -+ (G1 + G2)/2  along one diagonal and
-+ (G1 - G2)/2  along the other.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import FAST, INLINE

TILE = 128
"""Cells of a row that go through the passes together."""

WEIGHTLESS = 1e-6
"""Area [mm2] up to which cells are there and bear nothing: in half models, beyond the plane."""

# fields of `g`, whose entry t + 1 is cell t between two empty cells
WIDTH = TILE + 2
PLUS, MINUS = np.uint64(0), np.uint64(3 * WIDTH)
ONE, NEXT = np.uint64(1), np.uint64(WIDTH)
SHARES = 6 * WIDTH
"""Numbers in `g`: (G1 + G2)/2 of three components at PLUS, (G1 - G2)/2 at MINUS."""


@njit(**INLINE)
def filled(values, i, least):
    """First and last+1 column of row i of an array (n, m) where |value| is over `least`; m, 0 where there is none.

    A ply that lies askew in its grid leaves half of it empty, and in a half model half of what is there bears nothing.
    """
    m = values.shape[1]
    a, b = 0, m
    while a < m and abs(values[i, a]) <= least:
        a += 1
    while b > 0 and abs(values[i, b - 1]) <= least:
        b -= 1
    return a, b


@njit(**INLINE)
def filled_nodes(cell, i):
    """First and last+1 column of row i of the nodes whose cells have any area (n, m); a range that may be empty."""
    a, b = filled(cell, i, 0.0)
    if i > 0:
        before, after = filled(cell, i - 1, 0.0)
        a, b = min(a, before), max(b, after)
    return a, min(b + 1, cell.shape[1])


@njit(**FAST)
def tangents(x, c, i, j):
    """Means of opposite edges of a cell, one component."""
    p, q = x[c, i + ONE, j + ONE] - x[c, i, j], x[c, i + ONE, j] - x[c, i, j + ONE]
    return 0.5 * (p + q), 0.5 * (p - q)


@njit(**FAST)
def _add(f, i, start, count, g, sign, right, left):
    """Add a tile's forces to a row of nodes: `right` from the cell to its right, `left` from that to its left."""
    for c in range(3):
        o = np.uint64(c) * NEXT
        p, q = right + o + ONE, left + o
        g[q] = 0.0
        g[p + count] = 0.0
        for t in range(count + ONE):
            f[c, i, start + t] += sign * (g[p + t] + g[q + t])


@njit(**FAST)
def add_shares(f, i, start, count, g, low, high):
    """Add a tile of cells of row i, from column `start` on, to their nodes in rows low..high-1 of f (3, n, m)."""
    if i >= np.uint64(low):
        _add(f, i, start, count, g, -1.0, PLUS, MINUS)
    if i + ONE < np.uint64(high):
        _add(f, i + ONE, start, count, g, 1.0, MINUS, PLUS)
