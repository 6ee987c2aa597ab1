"""The membrane: four nodes, one point, the hypoelastic law of a woven fabric, hourglass control.

Tangents t1, t2 are the means of opposite edges over the cell's reference sides: F = (t1, t2). In each family's frame
(see `history`) the stresses grow by

    d s11 = E h e11,     d s12 = h G(g) e12,     g = e12(1) + e12(2)

e12 the tensor component, so that both families together do the work N_s dg a current area in pure shear, N_s = h
integral of G: per reference area N_s cos g dg, which is what a picture frame measures. The thickness is constant.
Stresses are those a current width, turned back and summed (Thompson et al. 2020, eqs. 8 to 10); their rate of work per
reference area A is

    A J sum (s11 e11 + 2 s12 e12) / dt = A S : dC / 2 dt,
    S = J sum [s11 g g' + s12 (g r' + r g') / J] / l^2,     r = rot(C g) (family 1), -rot(C g) (family 2)

so a cell pulls on its tangents by -A S_ab t_b: no resultant, no moment (S is symmetric), and none from a rigid motion.

Hourglass: with one point the pattern q = (x00 - x10 + x11 - x01)/4 has no strain. Its part in the cell's plane stores
U = k/2 |q|^2 - k/2 (q.n)^2,  k = r A (E h) (4/3) (1/a1^2 + 1/a2^2)/2,  r = 1 about the fully integrated cell
(D. Flanagan, T. Belytschko, Int. J. Numer. Methods Eng. 17 (1981) 679, in total form: h.X = 0 on a rectangle, so rigid
motions and even strains cost nothing). The normal part is left free: it is the twist, which a fabric does not resist.

    dU/dq = k (q - (q.n) n),   dU/dt_a = k (q.n) (q.t^a) n      (t^a the contravariant tangents)

Fibres damp their own stretching by s11 -> s11 + E h b e11/dt, b the time `viscous` (linear bulk viscosity).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.shell_membrane.history import (
    M_C11,
    MEMBRANE,
    ONE,
    SMALLEST,
    TILE,
    add,
    fibre_increments,
    load,
    store,
)
from ddf.jit import FAST

# fields of a tile: the history in its order, then tangents, hourglass, area, increments, and what pulls
C11, C12, C22, N1, N2, S1, S2, E1, E2 = (np.uint64(k * TILE) for k in range(9))
T1, T2, Q, AREA, D1, D2, R1, R2 = (np.uint64(k * TILE) for k in (9, 12, 15, 18, 19, 20, 21, 22))
F00, F10, F01, F11 = (np.uint64(k * TILE) for k in (23, 26, 29, 32))
Y, Z = np.uint64(TILE), np.uint64(2 * TILE)
SCRATCH = 35 * TILE


@njit(**FAST)
def _tangents(x, i, start, count, b1, b2, w):
    """Tangents and hourglass vector of the cells; b = half over the reference side."""
    for c in range(3):
        o = np.uint64(c * TILE)
        for t in range(count):
            j = start + t
            p, q = x[c, i + ONE, j + ONE] - x[c, i, j], x[c, i + ONE, j] - x[c, i, j + ONE]
            w[T1 + o + t] = b1 * (p + q)
            w[T2 + o + t] = b2 * (p - q)
            w[Q + o + t] = 0.25 * (x[c, i, j] - x[c, i + ONE, j] + x[c, i + ONE, j + ONE] - x[c, i, j + ONE])


@njit(**FAST)
def _increments(count, law, w):
    """Strain increments; tensions and shear strains grow; returns the work of the tensions a tile."""
    c, s, eh1, eh2, viscous = law
    work = 0.0
    for t in range(count):
        ax, ay, az = w[T1 + t], w[T1 + Y + t], w[T1 + Z + t]
        bx, by, bz = w[T2 + t], w[T2 + Y + t], w[T2 + Z + t]
        n11, n12, n22 = ax * ax + ay * ay + az * az, ax * bx + ay * by + az * bz, bx * bx + by * by + bz * bz
        o11, o12, o22 = w[C11 + t], w[C12 + t], w[C22 + t]
        d11, d12, d22 = n11 - o11, n12 - o12, n22 - o22
        m11, m12, m22 = 0.5 * (n11 + o11), 0.5 * (n12 + o12), 0.5 * (n22 + o22)
        e1, g1 = fibre_increments(c, s, d11, d12, d22, m11, m12, m22)
        e2, g2 = fibre_increments(-s, c, d11, d12, d22, m11, m12, m22)
        p1, p2 = viscous * eh1 * e1, viscous * eh2 * e2
        area = np.sqrt(max(m11 * m22 - m12 * m12, SMALLEST)) * w[AREA + t]
        work += area * ((w[N1 + t] + 0.5 * eh1 * e1 + p1) * e1 + (w[N2 + t] + 0.5 * eh2 * e2 + p2) * e2)
        w[C11 + t], w[C12 + t], w[C22 + t] = n11, n12, n22
        w[N1 + t] += eh1 * e1
        w[N2 + t] += eh2 * e2
        w[E1 + t] += g1
        w[E2 + t] -= g2
        w[D1 + t], w[D2 + t], w[R1 + t], w[R2 + t] = g1, -g2, p1, p2
    return work


@njit(**FAST)
def _shears(count, table, step, w):
    """Shear stresses grow by the tangent at the angle in mid-step; returns their work a tile.

    table: h G [N/mm] by intervals of the angle, `step` intervals a radian; the last one goes on.
    """
    last = table.shape[0] - 1
    work = 0.0
    for t in range(count):
        d1, d2 = w[D1 + t], w[D2 + t]
        angle = abs(w[E1 + t] + w[E2 + t] - 0.5 * (d1 + d2))
        k = np.uint64(min(max(int(angle * step), 0), last))
        a, b = table[k] * d1, table[k] * d2
        area = np.sqrt(max(w[C11 + t] * w[C22 + t] - w[C12 + t] * w[C12 + t], SMALLEST)) * w[AREA + t]
        work += 2.0 * area * ((w[S1 + t] + 0.5 * a) * d1 + (w[S2 + t] + 0.5 * b) * d2)
        w[S1 + t] += a
        w[S2 + t] += b
    return work


@njit(**FAST)
def _pulls(count, law, glass, b1, b2, w):
    """Forces on the corners: by x11 - x00 (plus), by x10 - x01 (minus) and by the hourglass pattern."""
    c, s = law[0], law[1]
    for t in range(count):
        c11, c12, c22 = w[C11 + t], w[C12 + t], w[C22 + t]
        det = max(c11 * c22 - c12 * c12, SMALLEST)
        root = np.sqrt(det)
        p1, q1 = c11 * c + c12 * s, c12 * c + c22 * s
        p2, q2 = c12 * c - c11 * s, c22 * c - c12 * s
        l1, l2 = 1.0 / (c * p1 + s * q1), 1.0 / (c * q2 - s * p2)
        n1, n2 = root * l1 * (w[N1 + t] + w[R1 + t]), root * l2 * (w[N2 + t] + w[R2 + t])
        v1, v2 = l1 * w[S1 + t], l2 * w[S2 + t]
        area = w[AREA + t]
        # family 1: g = (c, s), r = (-q1, p1); family 2: g = (-s, c), r = (q2, -p2)
        s11 = area * (n1 * c * c + n2 * s * s - 2.0 * (v1 * c * q1 + v2 * s * q2))
        s12 = area * ((n1 - n2) * c * s + v1 * (c * p1 - s * q1) + v2 * (s * p2 + c * q2))
        s22 = area * (n1 * s * s + n2 * c * c + 2.0 * (v1 * s * p1 - v2 * c * p2))
        ax, ay, az = w[T1 + t], w[T1 + Y + t], w[T1 + Z + t]
        bx, by, bz = w[T2 + t], w[T2 + Y + t], w[T2 + Z + t]
        inv = 1.0 / root
        nx, ny, nz = inv * (ay * bz - az * by), inv * (az * bx - ax * bz), inv * (ax * by - ay * bx)
        qx, qy, qz = w[Q + t], w[Q + Y + t], w[Q + Z + t]
        k = glass * area
        qn = qx * nx + qy * ny + qz * nz
        qa, qb = qx * ax + qy * ay + qz * az, qx * bx + qy * by + qz * bz
        k1, k2 = k * qn * (c22 * qa - c12 * qb) / det, k * qn * (c11 * qb - c12 * qa) / det
        h = 0.25 * k
        u, v = b1 * (s11 * ax + s12 * bx + k1 * nx), b2 * (s12 * ax + s22 * bx + k2 * nx)
        plus, minus, q = u + v, u - v, h * (qx - qn * nx)
        w[F00 + t], w[F10 + t], w[F01 + t], w[F11 + t] = plus - q, q - minus, minus + q, -plus - q
        u, v = b1 * (s11 * ay + s12 * by + k1 * ny), b2 * (s12 * ay + s22 * by + k2 * ny)
        plus, minus, q = u + v, u - v, h * (qy - qn * ny)
        w[F00 + Y + t], w[F10 + Y + t], w[F01 + Y + t], w[F11 + Y + t] = plus - q, q - minus, minus + q, -plus - q
        u, v = b1 * (s11 * az + s12 * bz + k1 * nz), b2 * (s12 * az + s22 * bz + k2 * nz)
        plus, minus, q = u + v, u - v, h * (qz - qn * nz)
        w[F00 + Z + t], w[F10 + Z + t], w[F01 + Z + t], w[F11 + Z + t] = plus - q, q - minus, minus + q, -plus - q


@njit(**FAST)
def membrane_forces(x, f, history, cell, tangent, span, sheet, viscous, low, high, carry, b, w):
    """Advance the membrane cells of rows low .. high-1 by one step and add their forces; returns their stress work.

    x, f (3, n, m); history (HISTORY, n, m); cell (n, m) [mm2]; tangent: h G [N/mm] by intervals of the angle from 0 to
    `span` [rad]; viscous: b/dt. Forces on row `high` go to row b of carry (3, blocks, widest). w: SCRATCH numbers.
    """
    n, m = x.shape[1], x.shape[2]
    law = (np.cos(sheet.fibre), np.sin(sheet.fibre), sheet.eh1, sheet.eh2, viscous)
    b1, b2 = 0.5 / sheet.a1, 0.5 / sheet.a2
    glass = sheet.glass * (2.0 / 3.0) * max(sheet.eh1, sheet.eh2) * (sheet.a1**-2 + sheet.a2**-2)
    step = tangent.shape[0] / span
    work = 0.0
    for row in range(low, min(high, n - 1)):
        i = np.uint64(row)
        for first in range(0, m - 1, TILE):
            start, count = np.uint64(first), np.uint64(min(TILE, m - 1 - first))
            _tangents(x, i, start, count, b1, b2, w)
            load(history, M_C11, MEMBRANE, i, start, count, w, C11)
            for t in range(count):
                w[AREA + t] = cell[i, start + t]
            work += _increments(count, law, w)
            work += _shears(count, tangent, step, w)
            _pulls(count, law, glass, b1, b2, w)
            store(history, M_C11, MEMBRANE, i, start, count, w, C11)
            add(f, i, start, count, w, F00)
            add(f, i, start + ONE, count, w, F01)
            under, below = (f, i + ONE) if row + 1 < high else (carry, np.uint64(b))
            add(under, below, start, count, w, F10)
            add(under, below, start + ONE, count, w, F11)
    return work
