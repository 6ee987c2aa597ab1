"""Bending of the lattice ply along each fibre family, without twisting stiffness.

At a node, with c1, c2 the second differences along the families, n = N/|N|, N = t1 x t2 from the central
tangents, and k_a = c_a . n:

    U = 1/2 B1 [(1 - r) k1^2 + r |c1|^2] + the same for 2,   B_a = D_a A_a / a_a^4,   r = D_in_plane / D_a

The curvature's normal part only is stiff unless an in-plane rigidity is entered. A_a is the area of the
triple of nodes. With K = (1 - r) B k and p = sum K_a (c_a - k_a n) / |N| the gradient spreads as

    dU/dc_a = K_a n + r B_a c_a,   dU/dt1 = t2 x p,   dU/dt2 = p x t1
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.tension import FAST


@njit(**FAST)
def _differences(xm, x0, xp, wm, wp, c1, t1):
    """Second difference and weighted tangent along family 1, one component of one row of nodes."""
    for j in range(x0.shape[0]):
        a = x0[j] - xm[j]
        b = xp[j] - x0[j]
        c1[j] = b - a
        t1[j] = wm[j] * a + wp[j] * b


@njit(**FAST)
def _differences_along(x0, wm, wp, c2, t2):
    """The same along family 2, within the row; the end nodes have one neighbour only."""
    m = x0.shape[0]
    for j in range(1, m - 1):
        a = x0[j] - x0[j - 1]
        b = x0[j + 1] - x0[j]
        c2[j] = b - a
        t2[j] = wm[j] * a + wp[j] * b
    c2[0] = 0.0
    c2[m - 1] = 0.0
    t2[0] = wp[0] * (x0[1] - x0[0])
    t2[m - 1] = wm[m - 1] * (x0[m - 1] - x0[m - 2])


@njit(**FAST)
def _normals(ax, ay, az, bx, by, bz, nx, ny, nz, inv):
    """Unit normals of t1 x t2 and the inverse length."""
    for j in range(inv.shape[0]):
        x = ay[j] * bz[j] - az[j] * by[j]
        y = az[j] * bx[j] - ax[j] * bz[j]
        z = ax[j] * by[j] - ay[j] * bx[j]
        r = 1.0 / np.sqrt(x * x + y * y + z * z + 1e-30)
        nx[j] = x * r
        ny[j] = y * r
        nz[j] = z * r
        inv[j] = r


@njit(**FAST)
def _moments(c1, c2, nx, ny, nz, inv, area1, area2, k1, k2, s1, s2, px, py, pz):
    """K1, K2 per node into s1, s2 and p into (px, py, pz); c1, c2 are (3, m)."""
    x1, y1, z1 = c1[0], c1[1], c1[2]
    x2, y2, z2 = c2[0], c2[1], c2[2]
    for j in range(inv.shape[0]):
        a = x1[j] * nx[j] + y1[j] * ny[j] + z1[j] * nz[j]
        b = x2[j] * nx[j] + y2[j] * ny[j] + z2[j] * nz[j]
        ka = k1 * area1[j] * a
        kb = k2 * area2[j] * b
        s1[j] = ka
        s2[j] = kb
        t = ka * a + kb * b
        px[j] = (ka * x1[j] + kb * x2[j] - t * nx[j]) * inv[j]
        py[j] = (ka * y1[j] + kb * y2[j] - t * ny[j]) * inv[j]
        pz[j] = (ka * z1[j] + kb * z2[j] - t * nz[j]) * inv[j]


@njit(**FAST)
def _shares(n, c1, c2, s1, s2, area1, area2, r1, r2, q1, q2, wm1, wp1, wm2, wp2, own, up, down, left, right):
    """What a node's energy pulls on itself and its four neighbours, one component; q = dU/dt."""
    for j in range(n.shape[0]):
        p1 = s1[j] * n[j] + r1 * area1[j] * c1[j]
        p2 = s2[j] * n[j] + r2 * area2[j] * c2[j]
        own[j] = 2.0 * (p1 + p2) - (wm1[j] - wp1[j]) * q1[j] - (wm2[j] - wp2[j]) * q2[j]
        up[j] = -p1 - wp1[j] * q1[j]
        down[j] = -p1 + wm1[j] * q1[j]
        right[j] = -p2 - wp2[j] * q2[j]
        left[j] = -p2 + wm2[j] * q2[j]


@njit(**FAST)
def _cross(ax, ay, bz, by, out):
    """One component of a cross product."""
    for j in range(out.shape[0]):
        out[j] = ax[j] * bz[j] - ay[j] * by[j]


@njit(**FAST)
def _add(f, own, right, left, up, down):
    """Gather: own share, from the left and right neighbours (padded by one), from the rows below and above."""
    for j in range(f.shape[0]):
        f[j] += own[j] + right[j] + left[j + 2] + up[j] + down[j]


@njit(**FAST)
def _row(x, bar1, bar2, triple1, triple2, i, k, w, out):
    """Shares of the nodes of row i into out (3 components x 5 kinds, m + 2), kinds own, up, down, right, left."""
    m = x.shape[2]
    n = x.shape[1]
    im, ip = max(i - 1, 0), min(i + 1, n - 1)
    wm1, wp1, wm2, wp2 = w[0, :m], w[1, :m], w[2, :m], w[3, :m]
    for j in range(m):
        a = 1.0 if i > 0 and bar1[im, j] > 0.0 else 0.0
        b = 1.0 if bar1[i, j] > 0.0 else 0.0
        t = 1.0 / max(a + b, 1.0)
        wm1[j] = a * t
        wp1[j] = b * t
        a = 1.0 if j > 0 and bar2[i, max(j - 1, 0)] > 0.0 else 0.0
        b = 1.0 if bar2[i, j] > 0.0 else 0.0
        t = 1.0 / max(a + b, 1.0)
        wm2[j] = a * t
        wp2[j] = b * t
    c1, c2, t1, t2 = w[4:7], w[7:10], w[10:13], w[13:16]
    for c in range(3):
        _differences(x[c, im], x[c, i], x[c, ip], wm1, wp1, c1[c], t1[c])
        _differences_along(x[c, i], wm2, wp2, c2[c], t2[c])
    normal, inv, s1, s2 = w[16:19], w[19, :m], w[20, :m], w[21, :m]
    p, q1, q2 = w[22:25], w[25, :m], w[26, :m]
    _normals(t1[0], t1[1], t1[2], t2[0], t2[1], t2[2], normal[0], normal[1], normal[2], inv)
    _moments(c1, c2, normal[0], normal[1], normal[2], inv, triple1[i], triple2[i], k[0], k[1], s1, s2, p[0], p[1], p[2])
    for c in range(3):
        d, e = (c + 1) % 3, (c + 2) % 3
        _cross(t2[d], t2[e], p[e], p[d], q1)
        _cross(p[d], p[e], t1[e], t1[d], q2)
        o = 5 * c
        _shares(
            normal[c, :m], c1[c], c2[c], s1, s2, triple1[i], triple2[i], k[2], k[3], q1, q2, wm1, wp1, wm2, wp2,
            out[o, :m], out[o + 1, :m], out[o + 2, :m], out[o + 4, 1 : m + 1], out[o + 3, 1 : m + 1],
        )  # fmt: skip


@njit(**FAST)
def bending_forces(x, f, bar1, bar2, triple1, triple2, sheet, low, high, work):
    """Add -dU/dx of bending to rows low..high-1 of f.

    x, f (3, n, m); bar1, bar2, triple1, triple2 (n, m); work (3, 15, m + 2) and 27 more rows: (72, m + 2).
    """
    n, m = x.shape[1], x.shape[2]
    k = (
        (sheet.bend1 - sheet.bend_in_plane) / sheet.a1**4, (sheet.bend2 - sheet.bend_in_plane) / sheet.a2**4,
        sheet.bend_in_plane / sheet.a1**4, sheet.bend_in_plane / sheet.a2**4,
    )  # fmt: skip
    work[:] = 0.0
    w = work[45:72]
    for i in range(low - 1, high + 1):
        out = work[15 * ((i + 3) % 3) : 15 * ((i + 3) % 3) + 15]
        if 0 <= i < n:
            _row(x, bar1, bar2, triple1, triple2, i, k, w, out)
        else:
            out[:] = 0.0
        if i > low:  # row i-1 has all its neighbours now
            a, b = 15 * ((i + 1) % 3), 15 * ((i + 2) % 3)
            for c in range(3):
                o = 5 * c
                _add(
                    f[c, i - 1], work[b + o, :m], work[b + o + 3], work[b + o + 4],
                    work[a + o + 1, :m], out[o + 2, :m],
                )  # fmt: skip


def node_curvatures(
    x: np.ndarray, bar1: np.ndarray, bar2: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Second differences c1, c2 (3, n, m) and their normal parts k1, k2 (n, m), as the forces use them [mm]."""

    def along(axis: int, bar: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        y, w = np.moveaxis(x, axis, 1), np.moveaxis(bar, axis - 1, 0)
        d = np.diff(y, axis=1)
        there = (w[:-1] > 0).astype(float)
        zero = np.zeros_like(y[:, :1])
        flag = np.zeros_like(there[:1])
        before, after = np.concatenate([zero, d], axis=1), np.concatenate([d, zero], axis=1)
        wb, wa = np.concatenate([flag, there]), np.concatenate([there, flag])
        t = (wb * before + wa * after) / np.maximum(wb + wa, 1.0)
        c = after - before
        c[:, 0] = c[:, -1] = 0.0
        return np.moveaxis(c, 1, axis), np.moveaxis(t, 1, axis)

    c1, t1 = along(1, bar1)
    c2, t2 = along(2, bar2)
    normal = np.cross(t1, t2, axis=0)
    normal = normal / np.sqrt((normal**2).sum(axis=0) + 1e-30)
    return c1, c2, (c1 * normal).sum(axis=0), (c2 * normal).sum(axis=0)


def bending_energy(x, bar1, bar2, triple1, triple2, sheet) -> float:
    """Bending energy of the ply [N mm], by the formula at the head of this file; arrays as in the forces."""
    c1, c2, k1, k2 = node_curvatures(x, bar1, bar2)
    total = 0.0
    for c, k, area, d, a in (
        (c1, k1, triple1, sheet["bend1"], sheet["a1"]),
        (c2, k2, triple2, sheet["bend2"], sheet["a2"]),
    ):
        extra = sheet["bend_in_plane"]
        total += 0.5 / a**4 * np.sum(area * ((d - extra) * k * k + extra * (c * c).sum(axis=0)))
    return float(total)
