"""What a cell of the shell-membrane formulation remembers, and the frame in which its fibres see strains.

Fields of the history pool, (HISTORY, n, m) a sheet, value of cell (i, j) at (i, j); resultants over the thickness:

    membrane   C of the last step (3); tension of families 1, 2; shear of families 1, 2 [N/mm]; e12 of families 1, 2
    shell      C and B of the last step (3 + 3); tension [N/mm] and moment [N] of families 1, 2

**The frame.** F = x,alpha (3 x 2) from the cell's flat reference, F = R U, C = F'F = U U. The Green-Naghdi frame R g
turns with the cell, so all that the law sees is U: strain increment  de = sym(dU U^-1),  fibre f = U g / |U g|, and
T_a turns R g_a on f_a (A. J. Thompson et al., Composites Part B 202 (2020) 108357, eqs. 1 to 7). With sym(dU U^-1) =
U^-1 dC U^-1 / 2, U^-1 f = g/l, U^-1 f' = rot(C g)/(J l), f' = rot(f), l^2 = g.C g, J = det U, rot a quarter turn, the
increments in a fibre's own frame need no square root of a matrix:

    e11 = g.dC g / (2 l^2),     e12 = g.dC rot(C g) / (2 l^2 J)

with C in mid-step. Family 2's frame is (-rot f2, f2): its e12 has the opposite sign, so that pure trellis
shear adds dg/2 to each and  g = e12(1) + e12(2)  (eq. 11).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import FAST

(
    M_C11, M_C12, M_C22, M_TENSION1, M_TENSION2, M_SHEAR1, M_SHEAR2, M_E1, M_E2,
    S_C11, S_C12, S_C22, S_B11, S_B12, S_B22, S_TENSION1, S_TENSION2, S_MOMENT1, S_MOMENT2,
) = range(19)  # fmt: skip
MEMBRANE = 9
HISTORY = 19

TILE = 64
"""Cells of a row that go through the passes together: their scratch stays in the first cache."""

ONE = np.uint64(1)
SMALLEST = 1e-12  # of J^2: a cell collapsed beyond that is no cell any more


@njit(**FAST)
def fibre_increments(c, s, d11, d12, d22, m11, m12, m22):
    """Increments (e11, e12) in the frame of the fibre with reference direction (c, s); d = dC, m = C in mid-step."""
    p, q = m11 * c + m12 * s, m12 * c + m22 * s
    u, v = d11 * c + d12 * s, d12 * c + d22 * s
    half = 0.5 / (c * p + s * q)
    area = np.sqrt(max(m11 * m22 - m12 * m12, SMALLEST))
    return half * (c * u + s * v), half * (v * p - u * q) / area


@njit(**FAST)
def load(pool, field, count, i, start, size, w, at):
    """Copy `count` fields of a pool (.., n, m), row i from column start, to places `at` .. of a tile."""
    for k in range(count):
        o = at + np.uint64(k * TILE)
        for t in range(size):
            w[o + t] = pool[field + k, i, start + t]


@njit(**FAST)
def store(pool, field, count, i, start, size, w, at):
    """Copy them back."""
    for k in range(count):
        o = at + np.uint64(k * TILE)
        for t in range(size):
            pool[field + k, i, start + t] = w[o + t]


@njit(**FAST)
def add(f, i, start, size, w, at):
    """Add three fields of a tile to row i of a vector array (3, n, m)."""
    for c in range(3):
        o = at + np.uint64(c * TILE)
        for t in range(size):
            f[c, i, start + t] += w[o + t]
