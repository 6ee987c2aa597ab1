"""Contact of a diaphragm with the rigid tool and the platform around it, implicit in time.

Every node is a contact point. So that no ridge or corner passes between nodes, a cell whose nodes are near the tool
and see normals that differ by more than 14 degrees carries 2 x 2 more at its quarters. A point at p (tool frame: it
moves with the tool) with signed distance d(p) and gradient n is pushed by

    (K A (offset - d) - (C A + dt K A) n.v) n   where d < offset,   likewise by the platform (d = z, n = e_z),

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
order. A node found far from the tool does not look at it for as many steps as it needs at the given reach to come
near; it looks at the platform all the time.
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
SMOOTH = 0.97  # least cosine of two normals across a cell that needs no points of its own
CARRY = 3 + PRESS  # force and `press` of the row that belongs to the next block


@njit(inline="always")
def _held(p, anchor, nx, ny, nz):
    """Squared length of the friction spring along the surface."""
    x, y, z = p[0] - anchor[0], p[1] - anchor[1], p[2] - anchor[2]
    s = x * nx + y * ny + z * nz
    return x * x + y * y + z * z - s * s


@njit(**FAST)
def _point(p, v, field, offset, k, c, mu, dt, anchor, out, give):
    """Force, tensor and viscous force of one contact point, into give (12,); returns its distance.

    p, v: position and velocity relative to the tool; field: distance and normal there from `sample`; k [N/mm],
    c [N s/mm]; updates its anchor and the energies out (4,): normal spring, tangential spring, friction loss, loss
    where contact begins or ends [N mm].
    """
    px, py, pz = p
    d1, nx, ny, nz = field
    near = min(d1, pz) - offset
    if near >= 0.0:
        if anchor[0] < FREE:
            rate = v[2] if pz < d1 else nx * v[0] + ny * v[1] + nz * v[2]
            before = max(0.0, dt * rate - near)
            out[2] += 0.5 * TANGENTIAL * k * _held(p, anchor, nx, ny, nz)
            out[3] -= 0.5 * k * before * (dt * rate - before)
        anchor[0] = FREE
        return near
    c += dt * k
    inertia = dt * c
    fx = fy = fz = normal = 0.0
    bx = by = bz = 0.0  # viscous part
    jxx = jyy = jzz = jxy = jxz = jyz = 0.0
    if d1 < offset:
        spring = k * (offset - d1)
        n1 = max(0.0, spring - c * (nx * v[0] + ny * v[1] + nz * v[2]))
        out[0] += 0.5 * spring * (offset - d1)
        fx, fy, fz, normal = n1 * nx, n1 * ny, n1 * nz, n1
        bx, by, bz = (n1 - spring) * nx, (n1 - spring) * ny, (n1 - spring) * nz
        if n1 > 0.0:
            jxx, jyy, jzz = inertia * nx * nx, inertia * ny * ny, inertia * nz * nz
            jxy, jxz, jyz = inertia * nx * ny, inertia * nx * nz, inertia * ny * nz
    if pz < offset:
        spring = k * (offset - pz)
        n2 = max(0.0, spring - c * v[2])
        out[0] += 0.5 * spring * (offset - pz)
        fz += n2
        bz += n2 - spring
        normal += n2
        if n2 > 0.0:
            jzz += inertia
        if pz < d1:
            nx, ny, nz = 0.0, 0.0, 1.0
    if anchor[0] >= FREE:
        anchor[0], anchor[1], anchor[2] = px, py, pz
        out[3] += 0.5 * k * near * (dt * (nx * v[0] + ny * v[1] + nz * v[2]) - near)
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
    before = sx * (sx - dt * vx) + sy * (sy - dt * vy) + sz * (sz - dt * vz)
    out[2] += 0.5 * k * (1.0 - keep) * (before + keep * stretch * stretch)
    held = k * keep
    inertia *= TANGENTIAL * share
    give[0], give[1], give[2] = fx + tx, fy + ty, fz + tz
    give[3], give[4], give[5] = (
        jxx + inertia * (1.0 - nx * nx),
        jyy + inertia * (1.0 - ny * ny),
        jzz + inertia * (1.0 - nz * nz),
    )
    give[6], give[7], give[8] = jxy - inertia * nx * ny, jxz - inertia * nx * nz, jyz - inertia * ny * nz
    give[9], give[10], give[11] = bx + tx + held * sx, by + ty + held * sy, bz + tz + held * sz
    return near


@njit(**FAST)
def _put(f, press, i, j, weight, give):
    """Add a point's share to node (i, j) of f (3, n, m) and press (n, m, 9)."""
    for c in range(3):
        f[c, i, j] += weight * give[c]
    for c in range(PRESS):
        press[i, j, c] += weight * give[3 + c]


@njit(inline="always")
def _note(seen, j, field, pz):
    """Keep for a node the distance to the nearer of tool and platform, and its normal; seen (4, m)."""
    if pz < field[0]:
        seen[0, j], seen[1, j], seen[2, j], seen[3, j] = pz, 0.0, 0.0, 1.0
    else:
        seen[0, j], seen[1, j], seen[2, j], seen[3, j] = field


@njit(inline="always")
def _needs_points(near, far, j, reach):
    """Whether the cell between nodes j, j+1 of two rows is near the tool where it is not smooth."""
    least = min(min(near[0, j], near[0, j + 1]), min(far[0, j], far[0, j + 1]))
    one = near[1, j] * far[1, j + 1] + near[2, j] * far[2, j + 1] + near[3, j] * far[3, j + 1]
    two = near[1, j + 1] * far[1, j] + near[2, j + 1] * far[2, j] + near[3, j + 1] * far[3, j]
    return least < reach and min(one, two) < SMOOTH


@njit(**FAST)
def tool_forces(
    x, v, f, press, pressed, carry, area, dx, dy, tool, origin, spacing, law, motion, reach, dt, anchors, sleep,
    low, high, out, give, seen,
):  # fmt: skip
    """Add the forces of the nodes of rows low..high-1 and of the cells between them and the next row.

    Returns the tool's work [N mm] and whether carry is used. x, v, f (3, n, m); press (n, m, 9), carry (m + 2, 12):
    see PRESS, CARRY; pressed (n,) bool: rows of press in use; area (n, m) of the nodes [mm2]; dx, dy reference cell
    sizes [mm]; law = (offset, stiffness, damping, friction); motion = (z, speed) of the tool's base; reach: way that a
    point can go in a step [mm]; anchors (n, m, 5, 3): of the node, of the cell's points; sleep (n, m) int16; out (4,)
    as in `_point`; give (12,), seen (2, 4, m) scratch.
    """
    offset, stiffness, damping, mu = law
    z, speed = motion
    n, m = x.shape[1], x.shape[2]
    work = 0.0
    carried = False
    for i in range(low, min(high + 1, n)):
        here = seen[i % 2]
        for j in range(m):
            p = (x[0, i, j], x[1, i, j], x[2, i, j] - z)
            if i == high:  # of the next block: seen here for the cells of the row before
                _note(here, j, sample(tool, origin, spacing, p[0], p[1], p[2]), p[2])
                continue
            field = (1.0e3, 0.0, 0.0, 1.0)
            if sleep[i, j] > 0:
                sleep[i, j] -= 1
            else:
                field = sample(tool, origin, spacing, p[0], p[1], p[2])
                if field[0] - offset > reach:
                    sleep[i, j] = min(LONGEST_SLEEP, int((field[0] - offset) / reach) - 1)
            _note(here, j, field, p[2])
            if here[0, j] >= offset and anchors[i, j, 0, 0] >= FREE:
                continue
            a = area[i, j]
            u = (v[0, i, j], v[1, i, j], v[2, i, j] - speed)
            near = _point(p, u, field, offset, stiffness * a, damping * a, mu, dt, anchors[i, j, 0], out, give)
            if near < 0.0:
                work += give[2] * speed * dt
                pressed[i] = True
                _put(f, press, i, j, 1.0, give)
        if i == low:
            continue
        before = seen[(i - 1) % 2]
        for j in range(m - 1):
            k = i - 1
            if not _needs_points(before, here, j, offset + 0.5 * (dx[k] + dy[j])):
                continue
            a = 0.25 * dx[k] * dy[j]
            for q in range(4):
                r = 0.25 if q < 2 else 0.75
                s = 0.25 if q % 2 == 0 else 0.75
                w00, w10, w01, w11 = (1 - r) * (1 - s), r * (1 - s), (1 - r) * s, r * s
                p = (
                    w00 * x[0, k, j] + w10 * x[0, i, j] + w01 * x[0, k, j + 1] + w11 * x[0, i, j + 1],
                    w00 * x[1, k, j] + w10 * x[1, i, j] + w01 * x[1, k, j + 1] + w11 * x[1, i, j + 1],
                    w00 * x[2, k, j] + w10 * x[2, i, j] + w01 * x[2, k, j + 1] + w11 * x[2, i, j + 1] - z,
                )
                u = (
                    w00 * v[0, k, j] + w10 * v[0, i, j] + w01 * v[0, k, j + 1] + w11 * v[0, i, j + 1],
                    w00 * v[1, k, j] + w10 * v[1, i, j] + w01 * v[1, k, j + 1] + w11 * v[1, i, j + 1],
                    w00 * v[2, k, j] + w10 * v[2, i, j] + w01 * v[2, k, j + 1] + w11 * v[2, i, j + 1] - speed,
                )
                field = sample(tool, origin, spacing, p[0], p[1], p[2])
                near = _point(p, u, field, offset, stiffness * a, damping * a, mu, dt, anchors[k, j, 1 + q], out, give)
                if near >= 0.0:
                    continue
                work += give[2] * speed * dt
                pressed[k] = True
                _put(f, press, k, j, w00, give)
                _put(f, press, k, j + 1, w01, give)
                if i < high:
                    pressed[i] = True
                    _put(f, press, i, j, w10, give)
                    _put(f, press, i, j + 1, w11, give)
                else:
                    carried = True
                    for c in range(CARRY):
                        carry[j, c] += w10 * give[c]
                        carry[j + 1, c] += w11 * give[c]
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
