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


@njit(**FAST)
def _means(xa, xb, a1, a2, h):
    """Mean tangents and twist of a row of cells, one component: xa row i, xb row i+1."""
    for j in range(a1.shape[0]):
        p = xb[j + 1] - xa[j]
        q = xb[j] - xa[j + 1]
        a1[j] = 0.5 * (p + q)
        a2[j] = 0.5 * (p - q)
        h[j] = xa[j] - xb[j] - xa[j + 1] + xb[j + 1]


@njit(**FAST)
def _metric(a1, a2, dx, dy, c11, c22, c12):
    """C of a row of cells; a1, a2 (3, c)."""
    for j in range(c11.shape[0]):
        ix, iy = 1.0 / dx, 1.0 / dy[j]
        c11[j] = (a1[0, j] * a1[0, j] + a1[1, j] * a1[1, j] + a1[2, j] * a1[2, j]) * ix * ix
        c22[j] = (a2[0, j] * a2[0, j] + a2[1, j] * a2[1, j] + a2[2, j] * a2[2, j]) * iy * iy
        c12[j] = (a1[0, j] * a2[0, j] + a1[1, j] * a2[1, j] + a1[2, j] * a2[2, j]) * ix * iy


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
def _principal(c11, c22, c12, mean, half, ln1, ln2):
    """Half sum and half difference of the principal values of C, and their logarithms."""
    for j in range(c11.shape[0]):
        m = 0.5 * (c11[j] + c22[j])
        d = 0.5 * (c11[j] - c22[j])
        r = np.sqrt(d * d + c12[j] * c12[j] + 1e-12 * m * m)
        mean[j] = m
        half[j] = r
        ln1[j] = _ln(m + r)
        ln2[j] = _ln(max(m - r, 1e-3 * m))


@njit(**FAST)
def _add_ogden(ln1, ln2, mu, alpha, s1, s2):
    """Add one Ogden pair to l_i^2 times the principal stresses s_i [MPa]."""
    c = 2.0 * mu / alpha
    a = 0.5 * alpha
    for j in range(ln1.shape[0]):
        p1 = _exp(a * ln1[j])
        p2 = _exp(a * ln2[j])
        p3 = 1.0 / (p1 * p2)
        s1[j] += c * (p1 - p3)
        s2[j] += c * (p2 - p3)


@njit(**FAST)
def _stresses(s1, s2, mean, half, c11, c22, c12, dx, dy, t, k11, k22, k12):
    """Force coefficients A t S_ab / (dx_a dx_b) from the principal values: S = b0 I + b1 C."""
    for j in range(s1.shape[0]):
        p = s1[j] / (mean[j] + half[j])
        q = s2[j] / max(mean[j] - half[j], 1e-3 * mean[j])
        b1 = (p - q) / (2.0 * half[j])
        b0 = p - b1 * (mean[j] + half[j])
        k11[j] = t * (b0 + b1 * c11[j]) * dy[j] / dx
        k22[j] = t * (b0 + b1 * c22[j]) * dx / dy[j]
        k12[j] = t * b1 * c12[j]


@njit(**FAST)
def _hourglass(a1, a2, h, dx, dy, modulus, g1, g2):
    """Coefficients of a1.h and a2.h: dU/d(a.h)."""
    for j in range(g1.shape[0]):
        area = dx * dy[j] * modulus / 12.0
        g1[j] = area * (a1[0, j] * h[0, j] + a1[1, j] * h[1, j] + a1[2, j] * h[2, j]) / dx**4
        g2[j] = area * (a2[0, j] * h[0, j] + a2[1, j] * h[1, j] + a2[2, j] * h[2, j]) / dy[j] ** 4


@njit(**FAST)
def _cell_forces(a1, a2, h, ya1, za1, ya2, za2, yh, zh, k11, k22, k12, g1, g2, twist, p, plus, minus, even, odd):
    """Shares of the four corners, one component; y, z are the next two components for the cross products.

    plus = (G1 + G2)/2, minus = (G1 - G2)/2 with G_a = -dU/da_a; odd = -dU/dh; even = p a1 x a2 / 4.
    """
    for j in range(plus.shape[0]):
        e1 = -(k11[j] * a1[j] + k12[j] * a2[j] + g1[j] * h[j])
        e2 = -(k12[j] * a1[j] + k22[j] * a2[j] + g2[j] * h[j])
        e1 += p * (1.0 / 12.0) * (ya1[j] * zh[j] - za1[j] * yh[j])
        e2 += p * (1.0 / 12.0) * (yh[j] * za2[j] - zh[j] * ya2[j])
        plus[j] = 0.5 * (e1 + e2)
        minus[j] = 0.5 * (e1 - e2)
        even[j] = p * 0.25 * (ya1[j] * za2[j] - za1[j] * ya2[j])
        odd[j] = -(g1[j] * a1[j] + g2[j] * a2[j] + twist[j] * h[j])


@njit(**FAST)
def _gather(f, plus0, minus0, even0, odd0, plus1, minus1, even1, odd1):
    """Add the cells of rows i-1 (0) and i (1) to the nodes of row i; buffers start with an empty cell."""
    for j in range(f.shape[0]):
        f[j] += plus0[j] + even0[j] + odd0[j] + minus0[j + 1] + even0[j + 1] - odd0[j + 1]
        f[j] += -minus1[j] + even1[j] - odd1[j] - plus1[j + 1] + even1[j + 1] + odd1[j + 1]


@njit(**FAST)
def rubber_forces(x, f, dx, dy, sheet, ogden, pressure, low, high, work):
    """Add membrane, hourglass, twisting and pressure forces to rows low..high-1 of f.

    x, f (3, n, m); dx (n-1,), dy (m-1,) reference cell sizes [mm]; ogden (pairs, 2); pressure [MPa] along the
    normal x_u x x_v; work (48, m + 2).
    """
    n, m = x.shape[1], x.shape[2]
    c = m - 1
    work[24:48, 0] = 0.0
    work[24:48, m] = 0.0
    a1, a2, h = work[0:3], work[3:6], work[6:9]
    c11, c22, c12, mean, half = work[9, :c], work[10, :c], work[11, :c], work[12, :c], work[13, :c]
    ln1, ln2, s1, s2 = work[14, :c], work[15, :c], work[16, :c], work[17, :c]
    k11, k22, k12, g1, g2, twist = work[18, :c], work[19, :c], work[20, :c], work[21, :c], work[22, :c], work[23, :c]
    for i in range(low - 1, high):
        old = 24 if i & 1 else 36
        new = 60 - old
        if 0 <= i < n - 1:
            for k in range(3):
                _means(x[k, i], x[k, i + 1], a1[k, :c], a2[k, :c], h[k, :c])
            _metric(a1, a2, dx[i], dy, c11, c22, c12)
            _principal(c11, c22, c12, mean, half, ln1, ln2)
            s1[:] = 0.0
            s2[:] = 0.0
            for q in range(ogden.shape[0]):
                _add_ogden(ln1, ln2, ogden[q, 0], ogden[q, 1], s1, s2)
            _stresses(s1, s2, mean, half, c11, c22, c12, dx[i], dy, sheet.thickness, k11, k22, k12)
            _hourglass(a1, a2, h, dx[i], dy, sheet.hourglass, g1, g2)
            for j in range(c):
                twist[j] = sheet.rigidity / (dx[i] * dy[j])  # 2 D (1 - nu) |h|^2 / 2 / (dx dy)^2 A, nu = 1/2
            for k in range(3):
                y, z = (k + 1) % 3, (k + 2) % 3
                o = new + 4 * k
                _cell_forces(
                    a1[k], a2[k], h[k], a1[y], a1[z], a2[y], a2[z], h[y], h[z], k11, k22, k12, g1, g2, twist, pressure,
                    work[o, 1 : c + 1], work[o + 1, 1 : c + 1], work[o + 2, 1 : c + 1], work[o + 3, 1 : c + 1],
                )  # fmt: skip
        else:
            work[new : new + 12] = 0.0
        if i >= low:
            for k in range(3):
                o, q = old + 4 * k, new + 4 * k
                _gather(
                    f[k, i], work[o], work[o + 1], work[o + 2], work[o + 3],
                    work[q], work[q + 1], work[q + 2], work[q + 3],
                )  # fmt: skip


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
