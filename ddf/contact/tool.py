"""Contact of a diaphragm with the rigid tool and the platform around it, implicit in time.

The platform is met by the nodes (d = z, n = e_z), the tool by 2 x 2 points a cell at its quarters, so that no ridge
passes between nodes. A point at p (tool frame: it moves with the tool) with signed distance d(p) and gradient n is
pushed by

    (K A (offset - d) - (C A + dt K A) n.v) n   where d < offset,

never pulled, and held by Coulomb friction on a spring to its anchor of stiffness 0.3 K A. K [N/mm3], A the node's
area or a quarter of the cell's; dt K v is the spring's force at the place that the point is moving to. The force goes
to the node, or to the cell's four with the point's bilinear weights N_i, and with it the tensor

    J_i = N_i (dt C A + dt^2 K A) (n n + 0.3 share (1 - n n)),   share: see `friction.coulomb`

A node of mass m that touches is then accelerated by  (m + J) a = F,  F the sum of all its forces: one step of
backward Euler in which the consistent stiffness matrix is replaced by its row sums. These are no smaller (all its
entries are positive), so the tool, however stiff, sets no limit to the step: with an explicit stiffness K_e besides,
leapfrog's limit  K_e dt^2 < 4 m  becomes  K_e dt^2 < 4 m + dt^2 K. What the tensor takes from F and the viscous
forces is dissipation, booked with the mid-step velocity.

The last row of a block of cells belongs to the next block: it goes to `carry`, which is added later in a fixed
order. A cell found far from the tool does not look at it for as many steps as it needs at the given reach to come near.
"""

from __future__ import annotations

from numba import njit

from ddf.contact.field import sample
from ddf.contact.friction import TANGENTIAL, coulomb, length
from ddf.elements.tension import FAST

FREE = 1.0e30
LONGEST_SLEEP = 16

#: columns of `press`: tensor J (xx, yy, zz, xy, xz, yz) [tonne] and viscous force of the tool [N] on each node
PRESS = 9
CARRY = 3 + PRESS  # force and `press` of the row that belongs to the next block


@njit(inline="always")
def _held(p, anchor, nx, ny, nz):
    """Squared length of the friction spring along the surface."""
    x, y, z = p[0] - anchor[0], p[1] - anchor[1], p[2] - anchor[2]
    s = x * nx + y * ny + z * nz
    return x * x + y * y + z * z - s * s


@njit(**FAST)
def _point(p, v, d, n, offset, k, c, mu, dt, anchor, out, give):
    """Force, tensor and viscous force of one contact point, into give (12,), the order of CARRY; returns its gap.

    p, v: position and velocity relative to the tool; d, n: distance and normal there; k [N/mm], c [N s/mm]; updates
    its anchor and the energies out (4,): normal spring, tangential spring, friction loss, loss where contact begins
    or ends [N mm].
    """
    near = d - offset
    nx, ny, nz = n
    rate = nx * v[0] + ny * v[1] + nz * v[2]
    if near >= 0.0:
        if anchor[0] < FREE:
            before = max(0.0, dt * rate - near)
            out[2] += 0.5 * TANGENTIAL * k * _held(p, anchor, nx, ny, nz)
            out[3] -= 0.5 * k * before * (dt * rate - before)
        anchor[0] = FREE
        return near
    px, py, pz = p
    c += dt * k
    inertia = dt * c
    spring = -k * near
    normal = max(0.0, spring - c * rate)
    out[0] -= 0.5 * spring * near
    if anchor[0] >= FREE:
        anchor[0], anchor[1], anchor[2] = px, py, pz
        out[3] += 0.5 * k * near * (dt * rate - near)
    sx, sy, sz = px - anchor[0], py - anchor[1], pz - anchor[2]
    s = sx * nx + sy * ny + sz * nz
    sx, sy, sz = sx - s * nx, sy - s * ny, sz - s * nz
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
    before = sx * (sx - dt * vx) + sy * (sy - dt * vy) + sz * (sz - dt * vz)
    out[2] += 0.5 * k * (1.0 - keep) * (before + keep * stretch * stretch)
    held = k * keep
    along = inertia * TANGENTIAL * share
    across = (inertia if normal > 0.0 else 0.0) - along
    viscous = normal - spring
    give[0], give[1], give[2] = normal * nx + tx, normal * ny + ty, normal * nz + tz
    give[3], give[4], give[5] = along + across * nx * nx, along + across * ny * ny, along + across * nz * nz
    give[6], give[7], give[8] = across * nx * ny, across * nx * nz, across * ny * nz
    give[9], give[10], give[11] = (
        viscous * nx + tx + held * sx,
        viscous * ny + ty + held * sy,
        viscous * nz + tz + held * sz,
    )
    return near


@njit(**FAST)
def _put(f, press, i, j, weight, give):
    """Add a point's share to node (i, j) of f (3, n, m) and press (n, m, 9)."""
    for c in range(3):
        f[c, i, j] += weight * give[c]
    for c in range(PRESS):
        press[i, j, c] += weight * give[3 + c]


@njit(**FAST)
def tool_forces(
    x, v, f, press, pressed, carry, area, dx, dy, tool, origin, spacing, law, motion, reach, dt, anchors, sleep,
    low, high, out, give,
):  # fmt: skip
    """Add the forces of the nodes and cells of rows low..high-1; returns the tool's work [N mm], and if carry is used.

    x, v, f (3, n, m); press (n, m, 9), carry (m + 2, 12): see PRESS, CARRY; pressed (n,) bool: rows of press in use;
    area (n, m) of the nodes [mm2]; dx, dy reference cell sizes [mm]; law = (offset, stiffness, damping, friction);
    motion = (z, speed) of the tool's base; reach: way that a point can go in a step [mm]; anchors (n, m, 5, 3): of the
    node, of the cell's points; sleep (n, m) int16 of the cells; out (4,) as in `_point`; give (12,) scratch.
    """
    offset, stiffness, damping, mu = law
    z, speed = motion
    n, m = x.shape[1], x.shape[2]
    work = 0.0
    carried = False
    for i in range(low, high):
        for j in range(m):
            if x[2, i, j] - z >= offset and anchors[i, j, 0, 0] >= FREE:
                continue
            p = (x[0, i, j], x[1, i, j], x[2, i, j] - z)
            u = (v[0, i, j], v[1, i, j], v[2, i, j] - speed)
            a, up = area[i, j], (0.0, 0.0, 1.0)
            near = _point(p, u, p[2], up, offset, stiffness * a, damping * a, mu, dt, anchors[i, j, 0], out, give)
            if near < 0.0:
                work += give[2] * speed * dt
                pressed[i] = True
                _put(f, press, i, j, 1.0, give)
        k = i + 1
        if k == n:
            break
        for j in range(m - 1):
            if sleep[i, j] > 0:
                sleep[i, j] -= 1
                continue
            a = 0.25 * dx[i] * dy[j]
            nearest = 1.0e3
            for q in range(4):
                r = 0.25 if q < 2 else 0.75
                s = 0.25 if q % 2 == 0 else 0.75
                w00, w10, w01, w11 = (1 - r) * (1 - s), r * (1 - s), (1 - r) * s, r * s
                p = (
                    w00 * x[0, i, j] + w10 * x[0, k, j] + w01 * x[0, i, j + 1] + w11 * x[0, k, j + 1],
                    w00 * x[1, i, j] + w10 * x[1, k, j] + w01 * x[1, i, j + 1] + w11 * x[1, k, j + 1],
                    w00 * x[2, i, j] + w10 * x[2, k, j] + w01 * x[2, i, j + 1] + w11 * x[2, k, j + 1] - z,
                )
                d, nx, ny, nz = sample(tool, origin, spacing, p[0], p[1], p[2])
                nearest = min(nearest, d - offset)
                if d >= offset and anchors[i, j, 1 + q, 0] >= FREE:
                    continue
                u = (
                    w00 * v[0, i, j] + w10 * v[0, k, j] + w01 * v[0, i, j + 1] + w11 * v[0, k, j + 1],
                    w00 * v[1, i, j] + w10 * v[1, k, j] + w01 * v[1, i, j + 1] + w11 * v[1, k, j + 1],
                    w00 * v[2, i, j] + w10 * v[2, k, j] + w01 * v[2, i, j + 1] + w11 * v[2, k, j + 1] - speed,
                )
                near = _point(
                    p, u, d, (nx, ny, nz), offset, stiffness * a, damping * a, mu, dt, anchors[i, j, 1 + q], out, give
                )
                if near >= 0.0:
                    continue
                work += give[2] * speed * dt
                pressed[i] = True
                _put(f, press, i, j, w00, give)
                _put(f, press, i, j + 1, w01, give)
                if k < high:
                    pressed[k] = True
                    _put(f, press, k, j, w10, give)
                    _put(f, press, k, j + 1, w11, give)
                else:
                    carried = True
                    for c in range(CARRY):
                        carry[j, c] += w10 * give[c]
                        carry[j + 1, c] += w11 * give[c]
            if nearest > reach:
                sleep[i, j] = min(LONGEST_SLEEP, int(nearest / reach) - 1)
    return work, carried


@njit(**FAST)
def settle_row(v, f, press, mass, speed, dt):
    """Forces of a row as the implicit tool lets them act: f <- m (m + J)^-1 f; press is cleared.

    v, f (3, m); press (m, 9); mass (m,), 0 where held. Returns the tool's further work and what was dissipated
    [N mm]: the viscous force and the change of f, times the mid-step velocity relative to the tool.
    """
    work = lost = 0.0
    for j in range(mass.shape[0]):
        m = mass[j]
        if m > 0.0 and press[j, 0] + press[j, 1] + press[j, 2] > 0.0:
            a, b, c = m + press[j, 0], m + press[j, 1], m + press[j, 2]
            d, e, g = press[j, 3], press[j, 4], press[j, 5]  # xy, xz, yz
            aa, bb, cc = b * c - g * g, a * c - e * e, a * b - d * d
            dd, ee, gg = e * g - d * c, d * g - e * b, d * e - a * g
            r = m / (a * aa + d * dd + e * ee)
            x, y, z = f[0, j], f[1, j], f[2, j]
            fx = r * (aa * x + dd * y + ee * z)
            fy = r * (dd * x + bb * y + gg * z)
            fz = r * (ee * x + gg * y + cc * z)
            f[0, j], f[1, j], f[2, j] = fx, fy, fz
            h = 0.5 * dt / m
            x, y, z = fx - x, fy - y, fz - z  # what the tensor took
            work += z * speed * dt
            lost -= dt * (
                (x + press[j, 6]) * (v[0, j] + h * fx)
                + (y + press[j, 7]) * (v[1, j] + h * fy)
                + (z + press[j, 8]) * (v[2, j] + h * fz - speed)
            )
        for k in range(PRESS):
            press[j, k] = 0.0
    return work, lost
