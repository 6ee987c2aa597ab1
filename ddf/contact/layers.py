"""Contact of neighbouring sheets: slave nodes against the bilinear patches of a master sheet.

A slave node keeps its place (u, v) on the master's grid; one Newton step of the closest-point projection a
step tracks it. With N_k the patch's shape functions there, tangents S_1, S_2, normal n, r = x_s - N_k x_k:

    gap    g = sign r.n - offset;             penalty energy 1/2 K A g^2 where g < 0, damping C A g'
    place  r^a = contravariant components of r (metric of S_1, S_2): the Newton step
    slip   s = (place - anchor)^a S_a;        friction spring of stiffness K A, Coulomb limit mu N
    rate   s' = (v_s - N_k v_k)_t + d n.(N_k,b v_k) S^b: the normal turns with the master, and r with it

The force f on the slave is balanced on the master's nodes by

    f_k = -(N_k + N_k,a r^a) f + d f^a N_k,a n,     d = r.n,  f^a the contravariant components of f

Sum f_k = -f since sum N_k,a = 0; and because sum N_k,a x_k = S_a the moments cancel exactly too, for
r x f = r^a S_a x f + d n x f, whether or not the projection has converged. Without the second term the two
forces lie a gap apart and every contact would be a couple.

A node whose place lies outside the master's grid, or on a cell that does not exist, is not in contact.
Forces on the master go to one buffer a block of slave rows; the buffers are summed in a fixed order, so the
result does not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.friction import coulomb, length
from ddf.elements.tension import FAST


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
    """Note that columns j, j+1 of row i of a buffer are written."""
    if span[i, 1] == 0:
        span[i, 0] = j
        span[i, 1] = j + 2
    else:
        if j < span[i, 0]:
            span[i, 0] = j
        if j + 2 > span[i, 1]:
            span[i, 1] = j + 2


@njit(**FAST)
def layer_forces(xs, vs, fs, area, xm, vm, cell, place, anchor, exposed, buffer, span, pair, dt, low, high, out):
    """Add the contact forces of slave rows low..high-1 to fs and to the master's buffer.

    xs, vs, fs (3, n, m) slave; xm, vm (3, N, M) master; area (n, m) [mm2]; cell (N, M) area of the master's
    cells; place, anchor (2, n, m) updated; exposed (n, m) bool; buffer (3, N, M), span (N, 2). out (4,):
    normal and tangential spring energy now, friction and damping loss of this step [N mm].
    """
    n_rows, n_cols = xm.shape[1], xm.shape[2]
    sign, offset, mu = pair.sign, pair.offset, pair.friction
    for i in range(low, high):
        for j in range(xs.shape[2]):
            if not exposed[i, j]:
                continue
            u, v = place[0, i, j], place[1, i, j]
            p = min(max(int(u), 0), n_rows - 2)
            q = min(max(int(v), 0), n_cols - 2)
            a, b = u - p, v - q
            x00, x10, x01, x11 = xm[0, p, q], xm[0, p + 1, q], xm[0, p, q + 1], xm[0, p + 1, q + 1]
            y00, y10, y01, y11 = xm[1, p, q], xm[1, p + 1, q], xm[1, p, q + 1], xm[1, p + 1, q + 1]
            z00, z10, z01, z11 = xm[2, p, q], xm[2, p + 1, q], xm[2, p, q + 1], xm[2, p + 1, q + 1]
            ux = (1 - b) * (x10 - x00) + b * (x11 - x01)
            uy = (1 - b) * (y10 - y00) + b * (y11 - y01)
            uz = (1 - b) * (z10 - z00) + b * (z11 - z01)
            vx = (1 - a) * (x01 - x00) + a * (x11 - x10)
            vy = (1 - a) * (y01 - y00) + a * (y11 - y10)
            vz = (1 - a) * (z01 - z00) + a * (z11 - z10)
            rx = xs[0, i, j] - (x00 + a * (x10 - x00) + b * vx)
            ry = xs[1, i, j] - (y00 + a * (y10 - y00) + b * vy)
            rz = xs[2, i, j] - (z00 + a * (z10 - z00) + b * vz)
            guu = ux * ux + uy * uy + uz * uz
            gvv = vx * vx + vy * vy + vz * vz
            guv = ux * vx + uy * vy + uz * vz
            det = guu * gvv - guv * guv
            inv = 1.0 / max(det, 1e-30)
            ru = rx * ux + ry * uy + rz * uz
            rv = rx * vx + ry * vy + rz * vz
            du = (gvv * ru - guv * rv) * inv
            dv = (guu * rv - guv * ru) * inv
            du = min(max(du, -0.5), 0.5)
            dv = min(max(dv, -0.5), 0.5)
            u = min(max(u + du, -1.0), n_rows + 0.0)
            v = min(max(v + dv, -1.0), n_cols + 0.0)
            place[0, i, j] = u
            place[1, i, j] = v
            il = np.sqrt(inv)
            nx = (uy * vz - uz * vy) * il
            ny = (uz * vx - ux * vz) * il
            nz = (ux * vy - uy * vx) * il
            d = rx * nx + ry * ny + rz * nz
            gap = sign * d - offset
            inside = u >= 0.0 and v >= 0.0 and u <= n_rows - 1.0 and v <= n_cols - 1.0
            if gap >= 0.0 or gap < -4.0 * offset or not inside or cell[p, q] <= 0.0:
                anchor[0, i, j] = u
                anchor[1, i, j] = v
                continue
            w = area[i, j]
            a += du
            b += dv
            w00, w10, w01, w11 = (1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b
            k = pair.stiffness * w
            c = pair.damping * w
            sx, sy, sz, nu, nv = 0.0, 0.0, 0.0, 0.0, 0.0
            for e in range(3):
                v00, v10, v01, v11 = vm[e, p, q], vm[e, p + 1, q], vm[e, p, q + 1], vm[e, p + 1, q + 1]
                slip = vs[e, i, j] - (w00 * v00 + w10 * v10 + w01 * v01 + w11 * v11)
                ne = nx if e == 0 else (ny if e == 1 else nz)
                nu += ne * ((1 - b) * (v10 - v00) + b * (v11 - v01))
                nv += ne * ((1 - a) * (v01 - v00) + a * (v11 - v10))
                if e == 0:
                    sx = slip
                elif e == 1:
                    sy = slip
                else:
                    sz = slip
            rate = sx * nx + sy * ny + sz * nz
            ou, ov = d * (gvv * nu - guv * nv) * inv, d * (guu * nv - guv * nu) * inv
            sx += ou * ux + ov * vx - rate * nx
            sy += ou * uy + ov * vy - rate * ny
            sz += ou * uz + ov * vz - rate * nz
            fn = max(0.0, -k * gap - c * sign * rate)
            tu, tv = u - anchor[0, i, j], v - anchor[1, i, j]
            tx = -k * (tu * ux + tv * vx) - c * sx
            ty = -k * (tu * uy + tv * vy) - c * sy
            tz = -k * (tu * uz + tv * vz) - c * sz
            trial = length(tx, ty, tz)
            share = coulomb(trial, mu * fn)
            tx *= share
            ty *= share
            tz *= share
            keep = 1.0
            px, py, pz = tu * ux + tv * vx, tu * uy + tv * vy, tu * uz + tv * vz
            stretch = length(px, py, pz)
            if share < 1.0:  # the anchor follows until the spring alone would carry the friction force
                keep = min(1.0, mu * fn / max(k * stretch, 1e-30))
                anchor[0, i, j] = u - keep * tu
                anchor[1, i, j] = v - keep * tv
            before = length(px - dt * sx, py - dt * sy, pz - dt * sz)
            stored = 0.5 * k * keep * keep * stretch * stretch
            out[0] += 0.5 * k * gap * gap
            out[1] += stored
            out[2] += 0.5 * k * before * before - stored - dt * (tx * sx + ty * sy + tz * sz)
            out[3] -= dt * (fn + k * gap) * sign * rate
            fx, fy, fz = sign * fn * nx + tx, sign * fn * ny + ty, sign * fn * nz + tz
            fs[0, i, j] += fx
            fs[1, i, j] += fy
            fs[2, i, j] += fz
            cu = d * (tx * ux + ty * uy + tz * uz)
            cv = d * (tx * vx + ty * vy + tz * vz)
            eu = (gvv * cu - guv * cv) * inv
            ev = (guu * cv - guv * cu) * inv
            w00, w11 = w00 - du * dv, w11 - du * dv  # first order in (du, dv), as the moments want it
            w10, w01 = w10 + du * dv, w01 + du * dv
            a -= du
            b -= dv
            q00 = -(1 - b) * eu - (1 - a) * ev
            q10 = (1 - b) * eu - a * ev
            q01 = -b * eu + (1 - a) * ev
            q11 = b * eu + a * ev
            _touch(span, p, q)
            _touch(span, p + 1, q)
            buffer[0, p, q] += q00 * nx - w00 * fx
            buffer[1, p, q] += q00 * ny - w00 * fy
            buffer[2, p, q] += q00 * nz - w00 * fz
            buffer[0, p + 1, q] += q10 * nx - w10 * fx
            buffer[1, p + 1, q] += q10 * ny - w10 * fy
            buffer[2, p + 1, q] += q10 * nz - w10 * fz
            buffer[0, p, q + 1] += q01 * nx - w01 * fx
            buffer[1, p, q + 1] += q01 * ny - w01 * fy
            buffer[2, p, q + 1] += q01 * nz - w01 * fz
            buffer[0, p + 1, q + 1] += q11 * nx - w11 * fx
            buffer[1, p + 1, q + 1] += q11 * ny - w11 * fy
            buffer[2, p + 1, q + 1] += q11 * nz - w11 * fz
