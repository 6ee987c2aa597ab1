"""Diaphragm: Ogden membrane, hourglass stabilisation, plate bending and follower pressure.

A cell of reference sizes dx, dy has the mean tangents a1, a2 and the twist h = x00 - x10 - x01 + x11.
Membrane, one point, incompressible plane stress, C_ab = a_a . a_b / (dx_a dx_b), J^2 = det C = 1 / l3^2:

    W = sum 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3)          (the Abaqus form of Ogden's energy)
    S = 2 dW/dC: principal values s_i = sum 2 mu/alpha (l_i^(alpha-2) - l3^alpha l_i^-2)

Hourglass: the strain that varies linearly within the cell has a1.h and a2.h as amplitudes; with the modulus
H [N/mm] it stores  1/24 A H [(a1.h)^2/dx^4 + (a2.h)^2/dy^4]. It leaves twisting out of the plane alone.
Twisting of the plate: D (1 - nu) |h|^2 / (dx dy)^2 A (nu = 1/2); its other terms are in `plate.py`.
Pressure p along +n of the bilinear patch: the work of p on the volume under it, so the nodal forces are
p int N_k (x_u x x_v) du dv, which is exact with corner normals made of a1, a2 and h.

Powers of a stretch are exp(alpha/2 ln C) with series that the compiler can vectorise: relative errors below
1e-11 for C between 0.05 and 20.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import FAST, INLINE

STRIP = 64
"""Cells that are worked on together, a multiple of what fits into vector registers."""

WIDTH = STRIP + 8
# fields of a strip of cells: where each begins in `w`. Constant distances in one array: loops over rows of twenty
# arrays take as long to find out that none overlaps another as for the cells.
(
    A1X, A1Y, A1Z, A2X, A2Y, A2Z, HX, HY, HZ,  # mean tangents, twist
    C11, C22, C12, MEAN, HALF, LN1, LN2, S1, S2,  # C, half sum and difference of its principal values, their logarithms
    K11, K22, K12, G1, G2, TWIST,  # force coefficients
) = (np.uint64(k * WIDTH) for k in range(24))  # fmt: skip
# what a cell gives to its corners, of one component: where each begins in a third of a buffer; cell t at place t + 1
PLUS, MINUS, EVEN, ODD = (np.uint64(k * WIDTH) for k in range(4))
THIRD, BUFFER = 4 * WIDTH, 12 * WIDTH
ONE = np.uint64(1)
SCRATCH = 24 * WIDTH + 2 * BUFFER
"""Numbers in `work`."""


@njit(**INLINE)
def _mean(xa, xb, j, w, k):
    """Mean tangents and twist of cell j, one component into fields from k on; xa row i, xb row i+1."""
    t = np.uint64(j)
    p = xb[j + 1] - xa[j]
    q = xb[j] - xa[j + 1]
    w[k + A1X + t] = 0.5 * (p + q)
    w[k + A2X + t] = 0.5 * (p - q)
    w[k + HX + t] = xa[j] - xb[j] - xa[j + 1] + xb[j + 1]


@njit(**FAST)
def _means(xa, ya, za, xb, yb, zb, w, count):
    """Mean tangents and twist of a strip of cells."""
    for j in range(count):
        _mean(xa, xb, j, w, A1X)
        _mean(ya, yb, j, w, A1Y)
        _mean(za, zb, j, w, A1Z)


@njit(**INLINE)
def _ln(c):
    """Ln c from the eighth root: ln c = 16 atanh((y - 1)/(y + 1)), y = c^(1/8)."""
    y = np.sqrt(np.sqrt(np.sqrt(c)))
    z = (y - 1.0) / (y + 1.0)
    w = z * z
    return 16.0 * z * (1 + w * (1 / 3 + w * (1 / 5 + w * (1 / 7 + w * (1 / 9 + w * (1 / 11 + w / 13))))))


@njit(**INLINE)
def _exp(y):
    """Exp y = (exp y/32)^32, |y| < 10."""
    t = y * (1.0 / 32.0)
    e = 1 + t * (1 + t * (1 / 2 + t * (1 / 6 + t * (1 / 24 + t * (1 / 120 + t * (1 / 720 + t / 5040))))))
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    return e * e


@njit(**FAST)
def _principal(w, count, dx, dy):
    """C and the principal values of a strip of cells."""
    ix = 1.0 / dx
    for t in range(count):
        iy = 1.0 / dy[t]
        ax, ay, az, bx, by, bz = w[A1X + t], w[A1Y + t], w[A1Z + t], w[A2X + t], w[A2Y + t], w[A2Z + t]
        c11 = (ax * ax + ay * ay + az * az) * ix * ix
        c22 = (bx * bx + by * by + bz * bz) * iy * iy
        c12 = (ax * bx + ay * by + az * bz) * ix * iy
        m = 0.5 * (c11 + c22)
        d = 0.5 * (c11 - c22)
        r = np.sqrt(d * d + c12 * c12 + 1e-12 * m * m)
        w[C11 + t], w[C22 + t], w[C12 + t] = c11, c22, c12
        w[MEAN + t], w[HALF + t] = m, r
        w[LN1 + t], w[LN2 + t] = _ln(m + r), _ln(max(m - r, 1e-3 * m))
        w[S1 + t], w[S2 + t] = 0.0, 0.0


@njit(**FAST)
def _add_ogden(w, count, mu, alpha):
    """Add one Ogden pair to l_i^2 times the principal stresses s_i [MPa]."""
    c = 2.0 * mu / alpha
    a = 0.5 * alpha
    for t in range(count):
        p1 = _exp(a * w[LN1 + t])
        p2 = _exp(a * w[LN2 + t])
        p3 = 1.0 / (p1 * p2)
        w[S1 + t] += c * (p1 - p3)
        w[S2 + t] += c * (p2 - p3)


@njit(**FAST)
def _coefficients(w, count, dx, dy, thickness, hourglass, rigidity):
    """A t S_ab / (dx_a dx_b) from the principal values, S = b0 I + b1 C; of a1.h and a2.h, dU/d(a.h); of h."""
    over = 1.0 / dx
    over4 = over * over * over * over
    for t in range(count):
        across, mean, half = dy[t], w[MEAN + t], w[HALF + t]
        p = w[S1 + t] / (mean + half)
        q = w[S2 + t] / max(mean - half, 1e-3 * mean)
        b1 = (p - q) / (2.0 * half)
        b0 = p - b1 * (mean + half)
        over_y = 1.0 / across
        w[K11 + t] = thickness * (b0 + b1 * w[C11 + t]) * across * over
        w[K22 + t] = thickness * (b0 + b1 * w[C22 + t]) * dx * over_y
        w[K12 + t] = thickness * b1 * w[C12 + t]
        area = dx * across * hourglass / 12.0
        hx, hy, hz = w[HX + t], w[HY + t], w[HZ + t]
        square = over_y * over_y
        w[G1 + t] = area * (w[A1X + t] * hx + w[A1Y + t] * hy + w[A1Z + t] * hz) * over4
        w[G2 + t] = area * (w[A2X + t] * hx + w[A2Y + t] * hy + w[A2Z + t] * hz) * square * square
        w[TWIST + t] = rigidity * over * over_y  # 2 D (1 - nu) |h|^2 / 2 / (dx dy)^2 A, nu = 1/2


@njit(**INLINE)
def _give(w, t, out, o, a1, a2, h, cross1, cross2, cross):
    """Shares of the four corners, one component; cross...: pressure times the cross products of a1, a2 and h.

    PLUS = (G1 + G2)/2, MINUS = (G1 - G2)/2 with G_a = -dU/da_a; ODD = -dU/dh; EVEN = p a1 x a2 / 4.
    """
    k11, k22, k12, g1, g2 = w[K11 + t], w[K22 + t], w[K12 + t], w[G1 + t], w[G2 + t]
    e1 = (1.0 / 12.0) * cross1 - (k11 * a1 + k12 * a2 + g1 * h)
    e2 = (1.0 / 12.0) * cross2 - (k12 * a1 + k22 * a2 + g2 * h)
    place = np.uint64(o) + t + ONE
    out[place + PLUS] = 0.5 * (e1 + e2)
    out[place + MINUS] = 0.5 * (e1 - e2)
    out[place + EVEN] = 0.25 * cross
    out[place + ODD] = -(g1 * a1 + g2 * a2 + w[TWIST + t] * h)


@njit(**FAST)
def _cell_forces(w, count, p, out):
    """What a strip of cells gives to its corners, all three components; p: pressure along a1 x a2."""
    for j in range(count):
        t = np.uint64(j)
        ax, ay, az, bx, by, bz = w[A1X + t], w[A1Y + t], w[A1Z + t], w[A2X + t], w[A2Y + t], w[A2Z + t]
        hx, hy, hz = w[HX + t], w[HY + t], w[HZ + t]
        _give(w, t, out, 0, ax, bx, hx, p * (ay * hz - az * hy), p * (hy * bz - hz * by), p * (ay * bz - az * by))
        _give(w, t, out, THIRD, ay, by, hy, p * (az * hx - ax * hz), p * (hz * bx - hx * bz), p * (az * bx - ax * bz))
        _give(
            w, t, out, 2 * THIRD, az, bz, hz, p * (ax * hy - ay * hx), p * (hx * by - hy * bx), p * (ax * by - ay * bx)
        )


@njit(**FAST)
def _gather(f, before, after):
    """Add the cells of rows i-1 (before) and i (after) to the nodes of row i; f[0] lies between the first two cells."""
    for j in range(f.shape[0]):
        t = np.uint64(j)
        f[j] += before[PLUS + t] + before[EVEN + t] + before[ODD + t]
        f[j] += before[MINUS + t + ONE] + before[EVEN + t + ONE] - before[ODD + t + ONE]
        f[j] += -after[MINUS + t] + after[EVEN + t] - after[ODD + t]
        f[j] += -after[PLUS + t + ONE] + after[EVEN + t + ONE] + after[ODD + t + ONE]


@njit(**FAST)
def _cells(x, i, a, b, dx, dy, sheet, ogden, pressure, w, out):
    """What cells a..b-1 of row i give to their corners, into a buffer; nothing where there is no such row."""
    if i < 0 or i >= x.shape[1] - 1:
        out[:] = 0.0
        return
    count, sizes, e = b - a, dy[a:b], b + 1
    _means(x[0, i, a:e], x[1, i, a:e], x[2, i, a:e], x[0, i + 1, a:e], x[1, i + 1, a:e], x[2, i + 1, a:e], w, count)
    _principal(w, count, dx[i], sizes)
    for q in range(ogden.shape[0]):
        _add_ogden(w, count, ogden[q, 0], ogden[q, 1])
    _coefficients(w, count, dx[i], sizes, sheet.thickness, sheet.hourglass, sheet.rigidity)
    _cell_forces(w, count, pressure, out)
    for row in range(12):
        out[row * WIDTH] = 0.0
        out[row * WIDTH + count + 1] = 0.0


@njit(**FAST)
def rubber_forces(x, f, dx, dy, sheet, ogden, pressure, low, high, work):
    """Add membrane, hourglass, twisting and pressure forces to rows low..high-1 of f.

    x, f (3, n, m); dx (n-1,), dy (m-1,) reference cell sizes [mm]; ogden (pairs, 2); pressure [MPa] along the
    normal x_u x x_v; work: at least SCRATCH numbers, flat. By strips of STRIP cells, whose fields all lie in the
    first cache.
    """
    m = x.shape[2]
    w, buffers = work[: 24 * WIDTH], work[24 * WIDTH : SCRATCH]
    end = 0
    while end < m:
        first, a = end, max(end - 1, 0)
        b = min(a + STRIP, m - 1)
        end = b if b < m - 1 else m  # all cells of nodes first..end-1 are among a..b-1
        skip = 1 if first > 0 else 0  # the cell before the first node is the first one; before the grid there is none
        for i in range(low - 1, high):
            one = BUFFER * (i & 1)
            before, after = buffers[BUFFER - one : 2 * BUFFER - one], buffers[one : one + BUFFER]
            _cells(x, i, a, b, dx, dy, sheet, ogden, pressure, w, after)
            if i >= low:
                for k in range(3):
                    o, e = k * THIRD + skip, (k + 1) * THIRD
                    _gather(f[k, i, first:end], before[o:e], after[o:e])


@njit(**FAST)
def cone_volume(x, low, high):
    """Volume of the cone from the origin to the patches of cell rows low..high-1 [mm3].

    1/3 int x . (x_u x x_v) of bilinear patches; its change is the volume swept by a sheet with fixed edges.
    """
    n, m = x.shape[1], x.shape[2]
    total = 0.0
    for i in range(low, min(high, n - 1)):
        for j in range(m - 1):
            a0, a1, a2 = x[0, i, j], x[1, i, j], x[2, i, j]
            b0, b1, b2 = x[0, i + 1, j], x[1, i + 1, j], x[2, i + 1, j]
            c0, c1, c2 = x[0, i + 1, j + 1], x[1, i + 1, j + 1], x[2, i + 1, j + 1]
            d0, d1, d2 = x[0, i, j + 1], x[1, i, j + 1], x[2, i, j + 1]
            # mean of the two triangulations of the quadrilateral a b c d
            bc0, bc1, bc2 = b1 * c2 - b2 * c1, b2 * c0 - b0 * c2, b0 * c1 - b1 * c0
            cd0, cd1, cd2 = c1 * d2 - c2 * d1, c2 * d0 - c0 * d2, c0 * d1 - c1 * d0
            bd0, bd1, bd2 = b1 * d2 - b2 * d1, b2 * d0 - b0 * d2, b0 * d1 - b1 * d0
            total += a0 * (bc0 + cd0 + bd0) + a1 * (bc1 + cd1 + bd1) + a2 * (bc2 + cd2 + bd2)
            total += b0 * cd0 + b1 * cd1 + b2 * cd2
    return total / 12.0


def cell_metric(x: np.ndarray, dx: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """C11, C22, C12 of every cell, (n-1, m-1) each; x (3, n, m), dx (n-1,), dy (m-1,)."""
    a1 = 0.5 * (x[:, 1:, :-1] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:]) / dx[:, None]
    a2 = 0.5 * (x[:, :-1, 1:] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, 1:, :-1]) / dy[None, :]
    return (a1 * a1).sum(axis=0), (a2 * a2).sum(axis=0), (a1 * a2).sum(axis=0)


def rubber_energy(x, dx, dy, sheet, ogden) -> tuple[float, float, float]:
    """Membrane, hourglass and twisting energy of a diaphragm [N mm]."""
    c11, c22, c12 = cell_metric(x, dx, dy)
    area = dx[:, None] * dy[None, :]
    mean, diff = 0.5 * (c11 + c22), 0.5 * (c11 - c22)
    r = np.sqrt(diff**2 + c12**2)
    l1, l2 = np.sqrt(mean + r), np.sqrt(mean - r)
    l3 = 1.0 / (l1 * l2)
    density = sum(2 * mu / al**2 * (l1**al + l2**al + l3**al - 3.0) for mu, al in ogden)
    h = x[:, :-1, :-1] - x[:, 1:, :-1] - x[:, :-1, 1:] + x[:, 1:, 1:]
    a1 = 0.5 * (x[:, 1:, :-1] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:])
    a2 = 0.5 * (x[:, :-1, 1:] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, 1:, :-1])
    w1, w2 = (a1 * h).sum(axis=0), (a2 * h).sum(axis=0)
    hourglass = sheet["hourglass"] / 24 * np.sum(area * (w1**2 / dx[:, None] ** 4 + w2**2 / dy[None, :] ** 4))
    twist = 0.5 * sheet["rigidity"] * np.sum((h * h).sum(axis=0) / area)
    return float(sheet["thickness"] * np.sum(area * density)), float(hourglass), float(twist)
