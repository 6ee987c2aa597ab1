"""Contact of neighbouring sheets: slave nodes against the smooth surface of a master sheet.

A slave node keeps its place (u, v) on the master's grid; one Newton step of the closest-point projection a
step tracks it. With N_k the weights of the surface's nodes there (`patch.py`), tangents S_1, S_2, normal n,
r = x_s - N_k x_k:

    gap    g = sign r.n - offset;             penalty energy 1/2 K A g^2 where g < 0, damping C A g'
    place  r^a = contravariant components of r (metric of S_1, S_2): the Newton step
    slip   s = (place - anchor)^a S_a;        friction spring of stiffness K A, Coulomb limit mu N
    rates  of gap and slip are their changes since the last step over dt, so they turn with the master

The force f on the slave is balanced on the master's nodes by

    f_k = -(N_k + N_k,a r^a) f + d f^a N_k,a n,     d = r.n,  f^a the contravariant components of f

Sum f_k = -f since sum N_k,a = 0; and because sum N_k,a x_k = S_a the moments cancel exactly too, for
r x f = r^a S_a x f + d n x f, whether or not the projection has converged. Without the second term the two
forces lie a gap apart and every contact would be a couple.

A node whose place lies outside the master's fabric is not in contact. One that is far away rests for as many
steps as it needs at the given reach to come near.
Forces on the master go to one buffer a block of slave rows; the buffers are summed in a fixed order, so the
result does not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.friction import coulomb, length
from ddf.contact.patch import interpolate, spread, weights
from ddf.elements.tension import FAST

LONGEST_REST = 8
UNKNOWN = 1.0e30  # gap of a node that has rested
DEEPEST = 3.0  # a node more than this many offsets beyond contact has been lost, not pressed


@njit(**FAST)
def clear_buffer(buffer, span):
    """Zero what the last step wrote: buffer (3, n, m), span (n, 2) columns touched in each row."""
    for i in range(span.shape[0]):
        a, b = span[i, 0], span[i, 1]
        if b > a:
            for c in range(3):
                for j in range(a, b):
                    buffer[c, i, j] = 0.0
            span[i, 0] = 0
            span[i, 1] = 0


@njit(inline="always")
def _touch(span, i, j):
    """Note that columns j-1 .. j+1 of row i of a buffer are written."""
    if span[i, 1] == 0:
        span[i, 0] = j - 1
        span[i, 1] = j + 2
    else:
        if j - 1 < span[i, 0]:
            span[i, 0] = j - 1
        if j + 2 > span[i, 1]:
            span[i, 1] = j + 2


@njit(**FAST)
def layer_forces(xs, fs, area, xm, cell, centre, place, anchor, rest, buffer, span, pair, reach, dt, low, high, out):
    """Add the contact forces of slave rows low..high-1 to fs and to the master's buffer.

    xs, fs (3, n, m) slave; xm (3, N, M) master; area (n, m) [mm2]; cell (N, M) area of the master's cells;
    centre (N, M, 2) from `patch_centres`; place (3, n, m): (u, v) and gap of the last step, anchor (2, n, m),
    both updated; rest (n, m) int8: steps to rest, negative for nodes that are not followed; buffer (3, N, M),
    span (N, 2); reach: way that a node can go in a step [mm]. out (4,): normal and tangential spring energy
    now, friction and damping loss of this step [N mm].
    """
    n_rows, n_cols = xm.shape[1], xm.shape[2]
    sign, offset, mu = pair.sign, pair.offset, pair.friction
    x0, x1, x2 = xm[0], xm[1], xm[2]
    b0, b1, b2 = buffer[0], buffer[1], buffer[2]
    slow = 1.0 / (1.0 + 0.5 * pair.damping * dt / pair.mass)  # damping acts on mid-step velocities
    inverse_dt = 1.0 / dt
    for i in range(low, high):
        for j in range(xs.shape[2]):
            if rest[i, j] != 0:
                if rest[i, j] > 0:
                    rest[i, j] -= 1
                continue
            u0, w0 = place[0, i, j], place[1, i, j]
            near_i, near_j = min(max(int(u0 + 0.5), 0), n_rows - 1), min(max(int(w0 + 0.5), 0), n_cols - 1)
            if centre[near_i, near_j, 0] < 0:
                rest[i, j] = LONGEST_REST
                continue
            p, q = np.uint64(centre[near_i, near_j, 0]), np.uint64(centre[near_i, near_j, 1])
            a, b = weights(u0 - np.float64(p)), weights(w0 - np.float64(q))
            sx, ux, vx = interpolate(x0, p, q, a, b)
            sy, uy, vy = interpolate(x1, p, q, a, b)
            sz, uz, vz = interpolate(x2, p, q, a, b)
            rx, ry, rz = xs[0, i, j] - sx, xs[1, i, j] - sy, xs[2, i, j] - sz
            guu = ux * ux + uy * uy + uz * uz
            gvv = vx * vx + vy * vy + vz * vz
            guv = ux * vx + uy * vy + uz * vz
            inv = 1.0 / max(guu * gvv - guv * guv, 1e-30)
            ru = rx * ux + ry * uy + rz * uz
            rv = rx * vx + ry * vy + rz * vz
            du = min(max((gvv * ru - guv * rv) * inv, -0.5), 0.5)
            dv = min(max((guu * rv - guv * ru) * inv, -0.5), 0.5)
            u, v = min(max(u0 + du, -1.0), n_rows + 0.0), min(max(w0 + dv, -1.0), n_cols + 0.0)
            place[0, i, j] = u
            place[1, i, j] = v
            il = np.sqrt(inv)
            nx, ny, nz = (uy * vz - uz * vy) * il, (uz * vx - ux * vz) * il, (ux * vy - uy * vx) * il
            d = rx * nx + ry * ny + rz * nz
            gap = sign * d - offset
            last = place[2, i, j]
            place[2, i, j] = gap
            if gap >= 0.0:
                anchor[0, i, j] = u
                anchor[1, i, j] = v
                rest[i, j] = min(LONGEST_REST, int(gap / reach))
                if rest[i, j] > 0:
                    place[2, i, j] = UNKNOWN
                continue
            inside = u >= 0.0 and v >= 0.0 and u < n_rows - 1.0 and v < n_cols - 1.0
            if not inside or gap < -DEEPEST * offset or cell[int(max(u, 0.0)), int(max(v, 0.0))] <= 0.0:
                anchor[0, i, j] = u
                anchor[1, i, j] = v
                continue
            k, c = pair.stiffness * area[i, j], pair.damping * area[i, j] * slow
            rate = (gap - last) * inverse_dt if last < UNKNOWN else 0.0
            fn = max(0.0, -k * gap - c * rate)
            au, av = u0 - anchor[0, i, j], w0 - anchor[1, i, j]
            tu, tv = au + du, av + dv
            mx, my, mz = du * ux + dv * vx, du * uy + dv * vy, du * uz + dv * vz
            px, py, pz = tu * ux + tv * vx, tu * uy + tv * vy, tu * uz + tv * vz
            cs = c * inverse_dt
            tx, ty, tz = -k * px - cs * mx, -k * py - cs * my, -k * pz - cs * mz
            share = coulomb(length(tx, ty, tz), mu * fn)
            tx, ty, tz = tx * share, ty * share, tz * share
            before = au * au * guu + 2.0 * au * av * guv + av * av * gvv
            after = px * px + py * py + pz * pz
            if share < 1.0:  # the anchor follows until the spring alone would carry the friction force
                keep = min(1.0, mu * fn / max(k * np.sqrt(after), 1e-30))
                anchor[0, i, j] = u - keep * tu
                anchor[1, i, j] = v - keep * tv
                after *= keep * keep
            out[0] += 0.5 * k * gap * gap
            out[1] += 0.5 * k * after
            out[2] += 0.5 * k * (before - after) - (tx * mx + ty * my + tz * mz)
            out[3] -= dt * (fn + k * gap) * rate * slow
            fx, fy, fz = sign * fn * nx + tx, sign * fn * ny + ty, sign * fn * nz + tz
            fs[0, i, j] += fx
            fs[1, i, j] += fy
            fs[2, i, j] += fz
            cu = d * (tx * ux + ty * uy + tz * uz)
            cv = d * (tx * vx + ty * vy + tz * vz)
            eu, ev = (gvv * cu - guv * cv) * inv, (guu * cv - guv * cu) * inv
            _touch(span, np.int64(p) - 1, np.int64(q))
            _touch(span, np.int64(p), np.int64(q))
            _touch(span, np.int64(p) + 1, np.int64(q))
            k0 = (a[0] + du * a[3], dv * a[0], eu * a[3], ev * a[0])
            k1 = (a[1] + du * a[4], dv * a[1], eu * a[4], ev * a[1])
            k2 = (a[2] + du * a[5], dv * a[2], eu * a[5], ev * a[2])
            spread(b0, p, q, b, fx, nx, k0, k1, k2)
            spread(b1, p, q, b, fy, ny, k0, k1, k2)
            spread(b2, p, q, b, fz, nz, k0, k1, k2)
