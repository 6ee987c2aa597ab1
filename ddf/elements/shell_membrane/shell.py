"""The shell: four nodes with directors, one point, the flexural modulus along the fibres, no in-plane shear.

A Reissner-Mindlin quadrilateral (T. Belytschko, J. Lin, C.-S. Tsay, Comput. Methods Appl. Mech. Eng. 42 (1984)
225) whose rotations are the directors d of its nodes (J. Simo, D. Fox, ibid. 72 (1989) 267): unit vectors, normal to
the flat reference. With t_a and d,a the gradients at the cell's middle, the convected curvatures and shears

    B_ab = (t_a.d,b + t_b.d,a)/2,     s_a = edge.d / a   at the middle of each edge, d the mean of its ends

do not change in a rigid motion. The law is the membrane's, with the flexural modulus E: over the thickness h its
resultants grow, in the frame of each family (see `history`), by

    d n = E h e11,     d m = D dk,     dk = g.dB g / l^2,     D = E h^3 / 12

(linear in the distance from the middle surface, so the integral over the thickness is exact) and there is no s12.
Their rate of work per reference area is J sum (n e11 + m dk)/dt. Transverse shear is elastic, even along the edges and
linear between opposite ones (K.-J. Bathe, E. Dvorkin, Int. J. Numer. Methods Eng. 21 (1985) 367):

    U = A K/2 sum_a [s_a^2 + z_a^2/3],    s_a the mean of the two edges along a, z_a half their difference

z_a is the control of the deflections' hourglass that costs a twisted fabric nothing (x y has no shear at any
edge). The directors' hourglass p = (d00 - d10 + d11 - d01)/4 stores k/2 |p|^2, k = r A D (4/3)(1/a1^2 + 1/a2^2)/2.

`f` gets minus the gradient by x, `pull` that by d; a node's moment is d X pull.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.shell_membrane.history import (
    HISTORY,
    MEMBRANE,
    ONE,
    S_C11,
    SMALLEST,
    TILE,
    add,
    fibre_increments,
    load,
    store,
)
from ddf.jit import FAST

# fields of a tile: the history in its order; edges of x and means of d on them; then sums over the components
C11, C12, C22, B11, B12, B22, N1, N2, M1, M2 = (np.uint64(k * TILE) for k in range(10))
AREA, EA, EB, EC, ED = (np.uint64(k * TILE) for k in (10, 11, 14, 17, 20))
DA, DB, DC, DD, P = (np.uint64(k * TILE) for k in (23, 26, 29, 32, 35))
L11, L12, L22, W11, W12, W22, SA, SB, SC, SD = (np.uint64(k * TILE) for k in range(38, 48))
SUMS = 10
SCRATCH = 48 * TILE


@njit(**FAST)
def _edges(x, d, i, start, count, r1, r2, w):
    """Edges over their reference sides (a, b along 1; c, d along 2), directors in their middles, hourglass of d."""
    for c in range(3):
        o = np.uint64(c * TILE)
        for t in range(count):
            j = start + t
            x00, x10, x01, x11 = x[c, i, j], x[c, i + ONE, j], x[c, i, j + ONE], x[c, i + ONE, j + ONE]
            w[EA + o + t], w[EB + o + t] = r1 * (x10 - x00), r1 * (x11 - x01)
            w[EC + o + t], w[ED + o + t] = r2 * (x01 - x00), r2 * (x11 - x10)
        for t in range(count):
            j = start + t
            d00, d10, d01, d11 = d[c, i, j], d[c, i + ONE, j], d[c, i, j + ONE], d[c, i + ONE, j + ONE]
            w[DA + o + t], w[DB + o + t] = 0.5 * (d10 + d00), 0.5 * (d11 + d01)
            w[DC + o + t], w[DD + o + t] = 0.5 * (d01 + d00), 0.5 * (d11 + d10)
            w[P + o + t] = 0.25 * (d00 - d10 + d11 - d01)


@njit(**FAST)
def _metric(count, r1, r2, w):
    """C and B of now (in L11 .. and W11 ..) and the shears of the edges, summed over the components."""
    for k in range(SUMS):
        o = L11 + np.uint64(k * TILE)
        for t in range(count):
            w[o + t] = 0.0
    for c in range(3):
        o = np.uint64(c * TILE)
        for t in range(count):
            ea, eb, ec, ed = w[EA + o + t], w[EB + o + t], w[EC + o + t], w[ED + o + t]
            da, db, dc, dd = w[DA + o + t], w[DB + o + t], w[DC + o + t], w[DD + o + t]
            t1, t2, g1, g2 = 0.5 * (ea + eb), 0.5 * (ec + ed), r1 * (dd - dc), r2 * (db - da)
            w[L11 + t] += t1 * t1
            w[L12 + t] += t1 * t2
            w[L22 + t] += t2 * t2
            w[W11 + t] += t1 * g1
            w[W12 + t] += 0.5 * (t1 * g2 + t2 * g1)
            w[W22 + t] += t2 * g2
            w[SA + t] += ea * da
            w[SB + t] += eb * db
            w[SC + t] += ec * dc
            w[SD + t] += ed * dd


@njit(**FAST)
def _resultants(count, law, w):
    """Tensions and moments grow; their pull on C (in L11 ..), on B (in W11 ..) and that of the shears of now.

    Returns the work a tile.
    """
    c, s, eh1, eh2, d1, d2, shear = law
    work = 0.0
    for t in range(count):
        n11, n12, n22 = w[L11 + t], w[L12 + t], w[L22 + t]
        b11, b12, b22 = w[W11 + t], w[W12 + t], w[W22 + t]
        o11, o12, o22 = w[C11 + t], w[C12 + t], w[C22 + t]
        v11, v12, v22 = b11 - w[B11 + t], b12 - w[B12 + t], b22 - w[B22 + t]
        m11, m12, m22 = 0.5 * (n11 + o11), 0.5 * (n12 + o12), 0.5 * (n22 + o22)
        e1, _ = fibre_increments(c, s, n11 - o11, n12 - o12, n22 - o22, m11, m12, m22)
        e2, _ = fibre_increments(-s, c, n11 - o11, n12 - o12, n22 - o22, m11, m12, m22)
        k1 = (c * c * v11 + 2.0 * c * s * v12 + s * s * v22) / (c * c * m11 + 2.0 * c * s * m12 + s * s * m22)
        k2 = (s * s * v11 - 2.0 * c * s * v12 + c * c * v22) / (s * s * m11 - 2.0 * c * s * m12 + c * c * m22)
        area = np.sqrt(max(m11 * m22 - m12 * m12, SMALLEST)) * w[AREA + t]
        work += area * ((w[N1 + t] + 0.5 * eh1 * e1) * e1 + (w[N2 + t] + 0.5 * eh2 * e2) * e2)
        work += area * ((w[M1 + t] + 0.5 * d1 * k1) * k1 + (w[M2 + t] + 0.5 * d2 * k2) * k2)
        w[C11 + t], w[C12 + t], w[C22 + t] = n11, n12, n22
        w[B11 + t], w[B12 + t], w[B22 + t] = b11, b12, b22
        w[N1 + t] += eh1 * e1
        w[N2 + t] += eh2 * e2
        w[M1 + t] += d1 * k1
        w[M2 + t] += d2 * k2
        now = np.sqrt(max(n11 * n22 - n12 * n12, SMALLEST)) * w[AREA + t]
        l1 = now / (c * c * n11 + 2.0 * c * s * n12 + s * s * n22)
        l2 = now / (s * s * n11 - 2.0 * c * s * n12 + c * c * n22)
        p1, p2, q1, q2 = l1 * w[N1 + t], l2 * w[N2 + t], l1 * w[M1 + t], l2 * w[M2 + t]
        w[L11 + t], w[L12 + t], w[L22 + t] = c * c * p1 + s * s * p2, c * s * (p1 - p2), s * s * p1 + c * c * p2
        w[W11 + t], w[W12 + t], w[W22 + t] = c * c * q1 + s * s * q2, c * s * (q1 - q2), s * s * q1 + c * c * q2
        k = shear * w[AREA + t]
        sa, sb, sc, sd = w[SA + t], w[SB + t], w[SC + t], w[SD + t]
        w[SA + t], w[SB + t] = k * (sa / 3.0 + sb / 6.0), k * (sb / 3.0 + sa / 6.0)
        w[SC + t], w[SD + t] = k * (sc / 3.0 + sd / 6.0), k * (sd / 3.0 + sc / 6.0)
    return work


@njit(**FAST)
def _pulls(count, r1, r2, glass, w):
    """Forces on the corners 00, 10, 01, 11 (in EA .. ED) and pulls on their directors (in DA .. DD)."""
    for c in range(3):
        o = np.uint64(c * TILE)
        for t in range(count):
            ea, eb, ec, ed = w[EA + o + t], w[EB + o + t], w[EC + o + t], w[ED + o + t]
            da, db, dc, dd = w[DA + o + t], w[DB + o + t], w[DC + o + t], w[DD + o + t]
            t1, t2, g1, g2 = 0.5 * (ea + eb), 0.5 * (ec + ed), r1 * (dd - dc), r2 * (db - da)
            m11, m12, m22 = w[W11 + t], w[W12 + t], w[W22 + t]
            u1 = 0.5 * (w[L11 + t] * t1 + w[L12 + t] * t2 + m11 * g1 + m12 * g2)
            u2 = 0.5 * (w[L12 + t] * t1 + w[L22 + t] * t2 + m12 * g1 + m22 * g2)
            v1, v2 = 0.5 * r1 * (m11 * t1 + m12 * t2), 0.5 * r2 * (m12 * t1 + m22 * t2)
            sa, sb, sc, sd = w[SA + t], w[SB + t], w[SC + t], w[SD + t]
            fa, fb, fc, fd = r1 * (u1 + sa * da), r1 * (u1 + sb * db), r2 * (u2 + sc * dc), r2 * (u2 + sd * dd)
            qa, qb, qc, qd = 0.5 * sa * ea, 0.5 * sb * eb, 0.5 * sc * ec, 0.5 * sd * ed
            h = 0.25 * glass * w[AREA + t] * w[P + o + t]
            w[EA + o + t], w[EB + o + t] = fa + fc, fd - fa
            w[EC + o + t], w[ED + o + t] = fb - fc, -fb - fd
            w[DA + o + t], w[DB + o + t] = v1 + v2 - qa - qc - h, v2 - v1 - qa - qd + h
            w[DC + o + t], w[DD + o + t] = v1 - v2 - qb - qc + h, -v1 - v2 - qb - qd - h


@njit(**FAST)
def shell_forces(x, f, director, pull, history, cell, sheet, low, high, carry, b, w):
    """Advance the shell cells of rows low .. high-1 by one step and add their forces; returns their stress work.

    x, f, director, pull (3, n, m); history (HISTORY, n, m); cell (n, m) [mm2]. What belongs to row `high` goes to row
    b of carry (6, blocks, widest): forces, then pulls. w: SCRATCH numbers.
    """
    n, m = x.shape[1], x.shape[2]
    h2 = 12.0 / sheet.thickness**2
    law = (
        np.cos(sheet.fibre), np.sin(sheet.fibre), h2 * sheet.bend1, h2 * sheet.bend2, sheet.bend1, sheet.bend2,
        sheet.transverse,
    )  # fmt: skip
    r1, r2 = 1.0 / sheet.a1, 1.0 / sheet.a2
    glass = sheet.glass * (2.0 / 3.0) * max(sheet.bend1, sheet.bend2) * (r1 * r1 + r2 * r2)
    work = 0.0
    for row in range(low, min(high, n - 1)):
        i = np.uint64(row)
        for first in range(0, m - 1, TILE):
            start, count = np.uint64(first), np.uint64(min(TILE, m - 1 - first))
            _edges(x, director, i, start, count, r1, r2, w)
            load(history, S_C11, HISTORY - MEMBRANE, i, start, count, w, C11)
            for t in range(count):
                w[AREA + t] = cell[i, start + t]
            _metric(count, r1, r2, w)
            work += _resultants(count, law, w)
            store(history, S_C11, HISTORY - MEMBRANE, i, start, count, w, C11)
            _pulls(count, r1, r2, glass, w)
            add(f, i, start, count, w, EA)
            add(f, i, start + ONE, count, w, EC)
            add(pull, i, start, count, w, DA)
            add(pull, i, start + ONE, count, w, DC)
            inside, below = row + 1 < high, i + ONE if row + 1 < high else np.uint64(b)
            under = f if inside else carry[:3]
            add(under, below, start, count, w, EB)
            add(under, below, start + ONE, count, w, ED)
            under = pull if inside else carry[3:]
            add(under, below, start, count, w, DB)
            add(under, below, start + ONE, count, w, DD)
    return work
