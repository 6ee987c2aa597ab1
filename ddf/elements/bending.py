"""Bending of the lattice ply along each fibre family, without twisting stiffness.

At a node, with c1, c2 the second differences along the families, n = N/|N|, N = t1 x t2 from the central
tangents, and k_a = c_a . n:

    U = 1/2 B1 [(1 - r) k1^2 + r |c1|^2] + the same for 2,   B_a = D_a A_a / a_a^4,   r = D_in_plane / D_a

The curvature's normal part only is stiff where r = 0. Where r = 1 for both families fibres bend one by one, and no
normal is needed. A_a is the area of the triple of nodes. With K = (1 - r) B k and p = sum K_a (c_a - k_a n) / |N|
the gradient spreads as

    dU/dc_a = K_a n + r B_a c_a,   dU/dt1 = t2 x p,   dU/dt2 = p x t1
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.cells import filled
from ddf.jit import FAST

TILE = 128
"""Nodes of a row that go through the passes together: their scratch stays in the first cache."""

# scratch of a tile: five shares of three components, entry j + 1 belongs to node j of the tile
WIDTH = TILE + 2
OWN, UP, DOWN, RIGHT, LEFT = (np.uint64(3 * k * WIDTH) for k in range(5))
NONE, ONE, Y = np.uint64(0), np.uint64(1), np.uint64(WIDTH)
SCRATCH = 15 * WIDTH


@njit(**FAST)
def _shares(x, weight, triple1, triple2, i, im, ip, start, before, after, offset, count, k, w):
    """What the energy of `count` nodes of row i from column `start` on pulls on them and their four neighbours.

    im, ip: the rows before and after, row i itself where there is none; before, after: 1, or 0 where the column
    before or after does not exist. At such edges triples have no area and weights are 0. offset: first
    node's place in the tile.
    """
    k1, k2, r1, r2 = k
    for t in range(count):
        j = start + t
        o = t + offset + ONE
        jm, jp = j - before, j + after
        wm1, wp1, wm2, wp2 = weight[0, i, j], weight[1, i, j], weight[2, i, j], weight[3, i, j]
        area1, area2 = triple1[i, j], triple2[i, j]
        x0, y0, z0 = x[0, i, j], x[1, i, j], x[2, i, j]
        ax, ay, az = x0 - x[0, im, j], y0 - x[1, im, j], z0 - x[2, im, j]
        bx, by, bz = x[0, ip, j] - x0, x[1, ip, j] - y0, x[2, ip, j] - z0
        c1x, c1y, c1z = bx - ax, by - ay, bz - az
        t1x, t1y, t1z = wm1 * ax + wp1 * bx, wm1 * ay + wp1 * by, wm1 * az + wp1 * bz
        ax, ay, az = x0 - x[0, i, jm], y0 - x[1, i, jm], z0 - x[2, i, jm]
        bx, by, bz = x[0, i, jp] - x0, x[1, i, jp] - y0, x[2, i, jp] - z0
        c2x, c2y, c2z = bx - ax, by - ay, bz - az
        t2x, t2y, t2z = wm2 * ax + wp2 * bx, wm2 * ay + wp2 * by, wm2 * az + wp2 * bz
        nx, ny, nz = t1y * t2z - t1z * t2y, t1z * t2x - t1x * t2z, t1x * t2y - t1y * t2x
        inv = 1.0 / np.sqrt(nx * nx + ny * ny + nz * nz + 1e-30)
        nx, ny, nz = nx * inv, ny * inv, nz * inv
        a, b = c1x * nx + c1y * ny + c1z * nz, c2x * nx + c2y * ny + c2z * nz
        s1, s2 = k1 * area1 * a, k2 * area2 * b
        s = s1 * a + s2 * b
        px = (s1 * c1x + s2 * c2x - s * nx) * inv
        py = (s1 * c1y + s2 * c2y - s * ny) * inv
        pz = (s1 * c1z + s2 * c2z - s * nz) * inv
        e1, e2 = r1 * area1, r2 * area2
        dw1, dw2 = wm1 - wp1, wm2 - wp2
        q1, q2 = t2y * pz - t2z * py, py * t1z - pz * t1y
        f1, f2 = s1 * nx + e1 * c1x, s2 * nx + e2 * c2x
        w[OWN + o] = 2.0 * (f1 + f2) - dw1 * q1 - dw2 * q2
        w[UP + o], w[DOWN + o] = -f1 - wp1 * q1, wm1 * q1 - f1
        w[RIGHT + o], w[LEFT + o] = -f2 - wp2 * q2, wm2 * q2 - f2
        q1, q2 = t2z * px - t2x * pz, pz * t1x - px * t1z
        f1, f2 = s1 * ny + e1 * c1y, s2 * ny + e2 * c2y
        o += Y
        w[OWN + o] = 2.0 * (f1 + f2) - dw1 * q1 - dw2 * q2
        w[UP + o], w[DOWN + o] = -f1 - wp1 * q1, wm1 * q1 - f1
        w[RIGHT + o], w[LEFT + o] = -f2 - wp2 * q2, wm2 * q2 - f2
        q1, q2 = t2x * py - t2y * px, px * t1y - py * t1x
        f1, f2 = s1 * nz + e1 * c1z, s2 * nz + e2 * c2z
        o += Y
        w[OWN + o] = 2.0 * (f1 + f2) - dw1 * q1 - dw2 * q2
        w[UP + o], w[DOWN + o] = -f1 - wp1 * q1, wm1 * q1 - f1
        w[RIGHT + o], w[LEFT + o] = -f2 - wp2 * q2, wm2 * q2 - f2


@njit(**FAST)
def _shares_without_normal(x, triple1, triple2, i, im, ip, start, before, after, offset, count, k, w):
    """The same where k1 = k2 = 0."""
    for c in range(np.uint64(3)):
        for t in range(count):
            j = start + t
            o = t + offset + ONE + c * Y
            middle = 2.0 * x[c, i, j]
            f1 = k[2] * triple1[i, j] * (x[c, ip, j] + x[c, im, j] - middle)
            f2 = k[3] * triple2[i, j] * (x[c, i, j + after] + x[c, i, j - before] - middle)
            w[OWN + o] = 2.0 * (f1 + f2)
            w[UP + o], w[DOWN + o] = -f1, -f1
            w[RIGHT + o], w[LEFT + o] = -f2, -f2


@njit(**FAST)
def _part(x, weight, triple1, triple2, i, im, ip, start, before, after, offset, count, k, w):
    """`_shares`, by whichever of the two."""
    if k[0] == 0.0 and k[1] == 0.0:
        _shares_without_normal(x, triple1, triple2, i, im, ip, start, before, after, offset, count, k, w)
    else:
        _shares(x, weight, triple1, triple2, i, im, ip, start, before, after, offset, count, k, w)


@njit(**FAST)
def _tile(x, weight, triple1, triple2, i, im, ip, start, count, k, w):
    """Shares of the nodes of a tile; the first and the last of the row, which lack a neighbour, by themselves."""
    head = ONE if start == NONE else NONE
    tail = ONE if start + count == np.uint64(x.shape[2]) else NONE
    _part(x, weight, triple1, triple2, i, im, ip, start, NONE, ONE, NONE, head, k, w)
    _part(x, weight, triple1, triple2, i, im, ip, start + head, ONE, ONE, head, count - head - tail, k, w)
    last = count - tail
    _part(x, weight, triple1, triple2, i, im, ip, start + last, ONE, NONE, last, tail, k, w)


@njit(**FAST)
def _add(f, c, i, start, count, w, field):
    """Add one kind of share to columns start .. of row i of component c."""
    o = field + np.uint64(c) * Y + ONE
    for t in range(count):
        f[c, i, start + t] += w[o + t]


@njit(**FAST)
def _add_row(f, c, i, start, count, w):
    """Add a tile's own shares and those of the left and right neighbours, from column start-1 to start+count."""
    o = np.uint64(c) * Y
    for kind in (OWN, LEFT, RIGHT):
        w[kind + o] = 0.0
        w[kind + o + count + ONE] = 0.0
    own, left, right = OWN + o, LEFT + o, RIGHT + o
    f[c, i, start] += w[own + ONE] + w[left + ONE + ONE]
    for t in range(ONE, count):
        f[c, i, start + t] += w[own + ONE + t] + w[right + t] + w[left + t + ONE + ONE]
    if start > np.uint64(0):
        f[c, i, start - ONE] += w[left + ONE]
    if start + count < np.uint64(f.shape[2]):
        f[c, i, start + count] += w[right + count]


@njit(**FAST)
def bending_forces(x, f, weight, triple1, triple2, sheet, low, high, work):
    """Add -dU/dx of bending to rows low..high-1 of f.

    x, f (3, n, m); weight (4, n, m) from `tangent_weights`; triple1, triple2 (n, m); work: at least SCRATCH
    numbers, flat.
    """
    n = x.shape[1]
    k = (
        (sheet.bend1 - sheet.bend_in_plane) / sheet.a1**4, (sheet.bend2 - sheet.bend_in_plane) / sheet.a2**4,
        sheet.bend_in_plane / sheet.a1**4, sheet.bend_in_plane / sheet.a2**4,
    )  # fmt: skip
    for i in range(max(low - 1, 0), min(high + 1, n)):
        row = np.uint64(i)
        im, ip = np.uint64(max(i - 1, 0)), np.uint64(min(i + 1, n - 1))
        begin1, end1 = filled(triple1, i, 0.0)
        begin2, end2 = filled(triple2, i, 0.0)
        begin, end = min(begin1, begin2), max(end1, end2)
        for first in range(begin, end, TILE):
            start, count = np.uint64(first), np.uint64(min(TILE, end - first))
            _tile(x, weight, triple1, triple2, row, im, ip, start, count, k, work)
            for c in range(3):
                if low <= i < high:
                    _add_row(f, c, row, start, count, work)
                if low <= i + 1 < high:
                    _add(f, c, ip, start, count, work, UP)
                if low <= i - 1 < high:
                    _add(f, c, im, start, count, work, DOWN)


def tangent_weights(bar1: np.ndarray, bar2: np.ndarray) -> np.ndarray:
    """Weights (4, n, m) of the bars before and after a node in its tangents along family 1, then family 2."""
    parts = []
    for axis, bar in ((0, bar1), (1, bar2)):
        after = np.moveaxis(bar, axis, 0) > 0
        before = np.concatenate([np.zeros_like(after[:1]), after[:-1]])
        count = np.maximum(before.astype(float) + after, 1.0)
        parts += [np.moveaxis(before / count, 0, axis), np.moveaxis(after / count, 0, axis)]
    return np.ascontiguousarray(parts)


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
