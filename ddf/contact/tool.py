"""Contact of a diaphragm with the rigid tool and the platform around it.

Each cell carries 2 x 2 contact points at its quarters, so that a ridge cannot pass between nodes. A point at
p (tool frame: it moves with the tool) with signed distance d(p) and gradient n is pushed by

    K A (offset - d) n - C A n.v n   where d < offset,   likewise by the platform (d = z, n = e_z),

and held by Coulomb friction on a spring to its anchor. K [N/mm3], A a quarter of the cell's area. The force
goes to the four nodes with the point's bilinear weights. The last row of a block of cells belongs to the
next block: it goes to `carry`, which is added later in a fixed order.

A cell that was found far away sleeps for as many steps as it needs at the given reach to come near.
"""

from __future__ import annotations

from numba import njit

from ddf.contact.field import sample
from ddf.contact.friction import TANGENTIAL, coulomb, length
from ddf.elements.tension import FAST

FREE = 1.0e30
LONGEST_SLEEP = 16


@njit(**FAST)
def _point(p, v, tool, origin, spacing, offset, k, c, mass, mu, dt, anchor, out):
    """Force (fx, fy, fz) on one contact point and its distance; updates its anchor and the energies.

    p, v: position and velocity relative to the tool; out (4,): normal spring, tangential spring, friction and
    damping loss [N mm].
    """
    px, py, pz = p
    d1, nx, ny, nz = sample(tool, origin, spacing, px, py, pz)
    near = min(d1, pz) - offset
    if near >= 0.0:
        anchor[0] = FREE
        return 0.0, 0.0, 0.0, near
    slow = 1.0 / (1.0 + 0.5 * c * dt / mass)  # damping acts on mid-step velocities
    c *= slow
    fx = fy = fz = normal = 0.0
    if d1 < offset:
        rate = nx * v[0] + ny * v[1] + nz * v[2]
        n1 = max(0.0, k * (offset - d1) - c * rate)
        out[0] += 0.5 * k * (offset - d1) ** 2
        out[3] -= dt * (n1 - k * (offset - d1)) * rate * slow
        fx, fy, fz, normal = n1 * nx, n1 * ny, n1 * nz, n1
    if pz < offset:
        n2 = max(0.0, k * (offset - pz) - c * v[2])
        out[0] += 0.5 * k * (offset - pz) ** 2
        out[3] -= dt * (n2 - k * (offset - pz)) * v[2] * slow
        fz += n2
        normal += n2
        if pz < d1:
            nx, ny, nz = 0.0, 0.0, 1.0
    if anchor[0] >= FREE:
        anchor[0], anchor[1], anchor[2] = px, py, pz
    sx, sy, sz = px - anchor[0], py - anchor[1], pz - anchor[2]
    s = sx * nx + sy * ny + sz * nz
    sx, sy, sz = sx - s * nx, sy - s * ny, sz - s * nz
    rate = nx * v[0] + ny * v[1] + nz * v[2]
    vx, vy, vz = v[0] - rate * nx, v[1] - rate * ny, v[2] - rate * nz
    k, c = TANGENTIAL * k, TANGENTIAL * c
    tx, ty, tz = -k * sx - c * vx, -k * sy - c * vy, -k * sz - c * vz
    limit = mu * normal
    share = coulomb(length(tx, ty, tz), limit)
    tx, ty, tz = tx * share, ty * share, tz * share
    stretch = length(sx, sy, sz)
    keep = 1.0
    if share < 1.0:
        keep = min(1.0, limit / max(k * stretch, 1e-30))
        anchor[0], anchor[1], anchor[2] = px - keep * sx, py - keep * sy, pz - keep * sz
    out[1] += 0.5 * k * (keep * stretch) ** 2
    held = k * keep
    viscous = (tx + held * sx) * vx + (ty + held * sy) * vy + (tz + held * sz) * vz
    out[2] += k * stretch * stretch * keep * (1.0 - keep) - dt * viscous
    return fx + tx, fy + ty, fz + tz, near


@njit(**FAST)
def tool_forces(x, v, f, carry, dx, dy, tool, origin, spacing, law, motion, reach, dt, anchors, sleep, low, high, out):
    """Add the forces of the contact points of cell rows low..high-1; returns the tool's work [N mm].

    x, v, f (3, n, m); carry (3, m + 2); dx, dy reference cell sizes [mm]; law = (offset, stiffness, damping,
    areal mass, friction); motion = (z, speed) of the tool's base; reach: way that a point can go in a step [mm];
    anchors (n-1, m-1, 4, 3); sleep (n-1, m-1) int16; out (4,) as in `_point`.
    """
    offset, stiffness, damping, mass, mu = law
    z, speed = motion
    work = 0.0
    for i in range(low, min(high, x.shape[1] - 1)):
        for j in range(x.shape[2] - 1):
            if sleep[i, j] > 0:
                sleep[i, j] -= 1
                continue
            area = 0.25 * dx[i] * dy[j]
            nearest = 1.0e3
            for q in range(4):
                a = 0.25 if q < 2 else 0.75
                b = 0.25 if q % 2 == 0 else 0.75
                w00, w10, w01, w11 = (1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b
                p = (
                    w00 * x[0, i, j] + w10 * x[0, i + 1, j] + w01 * x[0, i, j + 1] + w11 * x[0, i + 1, j + 1],
                    w00 * x[1, i, j] + w10 * x[1, i + 1, j] + w01 * x[1, i, j + 1] + w11 * x[1, i + 1, j + 1],
                    w00 * x[2, i, j] + w10 * x[2, i + 1, j] + w01 * x[2, i, j + 1] + w11 * x[2, i + 1, j + 1] - z,
                )
                u = (
                    w00 * v[0, i, j] + w10 * v[0, i + 1, j] + w01 * v[0, i, j + 1] + w11 * v[0, i + 1, j + 1],
                    w00 * v[1, i, j] + w10 * v[1, i + 1, j] + w01 * v[1, i, j + 1] + w11 * v[1, i + 1, j + 1],
                    w00 * v[2, i, j] + w10 * v[2, i + 1, j] + w01 * v[2, i, j + 1] + w11 * v[2, i + 1, j + 1] - speed,
                )
                fx, fy, fz, near = _point(
                    p,
                    u,
                    tool,
                    origin,
                    spacing,
                    offset,
                    stiffness * area,
                    damping * area,
                    mass * area,
                    mu,
                    dt,
                    anchors[i, j, q],
                    out,
                )
                nearest = min(nearest, near)
                if near >= 0.0:
                    continue
                work += fz * speed * dt
                f[0, i, j] += w00 * fx
                f[1, i, j] += w00 * fy
                f[2, i, j] += w00 * fz
                f[0, i, j + 1] += w01 * fx
                f[1, i, j + 1] += w01 * fy
                f[2, i, j + 1] += w01 * fz
                up = carry[:, 0 : x.shape[2]] if i == high - 1 else f[:, i + 1, :]
                up[0, j] += w10 * fx
                up[1, j] += w10 * fy
                up[2, j] += w10 * fz
                up[0, j + 1] += w11 * fx
                up[1, j + 1] += w11 * fy
                up[2, j + 1] += w11 * fz
            if nearest > reach:
                sleep[i, j] = min(LONGEST_SLEEP, int(nearest / reach) - 1)
    return work
