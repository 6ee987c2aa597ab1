"""Contact of a diaphragm with the rigid tool, the platform around it and the box's walls, implicit in time.

The platform is met by the nodes (d = z, n = e_z), the tool by nodes, middles of edges and centres of cells, so that
no ridge passes between nodes. A point at p (tool frame: it moves with the tool) with signed distance d(p) and
gradient n is pushed by

    (K A (offset - d) - (C A + dt K A) n.v) n   where d < offset and K (offset - d) > (C + dt K) n.v*

(v*: the velocity at the end of the step without the tool: by then it would still be pushed; beyond the depths HARD and
HARDER it is 3 and 6 times as stiff, also against the rate), and held by Coulomb friction on a spring to its anchor
of stiffness 0.3 K A. K [N/mm3], A the area it stands for; dt K v is the spring's force at the place that the point is
moving to. The force goes to the node, or to the cell's four
with the point's bilinear weights N_i, and with it the tensor

    J_i = N_i (dt C A + dt^2 K A) (n n + 0.3 share (1 - n n)),   share: see `friction.coulomb`

A node of mass m that touches is then accelerated by  (m + J) a = F,  F the sum of all its forces: one step of
backward Euler in which the consistent stiffness matrix is replaced by its row sums. These are no smaller (all its
entries are positive), so the tool, however stiff, sets no limit to the step: with an explicit stiffness K_e besides,
leapfrog's limit  K_e dt^2 < 4 m  becomes  K_e dt^2 < 4 m + dt^2 K. What the tensor takes from F and the viscous
forces is dissipation, booked with the mid-step velocity.

Under a sheet in a frame the box has walls: vertical planes through the frame's edges that keep nodes inside, without
friction. A vacuum of 0.1 MPa over a box 82 mm deep else blows the rubber out under the frame until it bursts at the
corners. And while the platform stands lower than the frame, by over half a thickness, friction on it does not hold the
nodes next to the frame, nor those nearer to the walls than it is deep: as it comes up the sheet rolls off the walls on
this rim, and cells that stick there are crushed between frame and platform like struts, on which they press with more
than the sheet's pressure.

Forces and tensors are gathered in `press`, while all other forces stand in f. The last row of a block of cells belongs
to the next block: it goes to `carry`, which is added later in a fixed order. A cell found far from the tool does not
look at it for as many steps as it needs at the given reach to come near.
"""

from __future__ import annotations

from numba import njit

from ddf.contact.field import sample
from ddf.contact.friction import TANGENTIAL, coulomb, length
from ddf.jit import FAST, INLINE

FREE = 1.0e30
HARD, HARDER = 0.1, 0.15
"""Depths [mm] beyond which the penalty is 3 and 6 times as stiff: on apexes, where fibres press with some 10 MPa."""
WALL, POINTS = 5, 7
"""Of the contact points of a node: the first on a wall, and how many there are."""
LONGEST_SLEEP = 16

#: columns of `press`, what the tool does to each node: force [N], tensor J (xx, yy, zz, xy, xz, yz) [tonne], viscous
#: part of the force [N]
PRESS = 12


@njit(**INLINE)
def _spring(k, depth):
    """Force of the penalty at a depth, and what it stores."""
    hard, harder = max(0.0, depth - HARD), max(0.0, depth - HARDER)
    return k * (depth + 2.0 * hard + 3.0 * harder), 0.5 * k * (depth**2 + 2.0 * hard**2 + 3.0 * harder**2)


@njit(**INLINE)
def _times(depth):
    """How many times as stiff the penalty is at a depth."""
    return 6.0 if depth > HARDER else 3.0 if depth > HARD else 1.0


@njit(**INLINE)
def _held(p, v, dt, anchor, nx, ny, nz):
    """Stretches of the friction spring along the surface, now and in the last step, multiplied."""
    x, y, z = p[0] - anchor[0], p[1] - anchor[1], p[2] - anchor[2]
    ox, oy, oz = x - dt * v[0], y - dt * v[1], z - dt * v[2]
    return x * ox + y * oy + z * oz - (x * nx + y * ny + z * nz) * (ox * nx + oy * ny + oz * nz)


@njit(**INLINE)
def _point(p, v, ahead, d, n, offset, k, c, mu, dt, anchor, out, give):
    """What one contact point does, into give (PRESS,); returns whether it touches.

    p, v, ahead: position, velocity, and velocity at the end without the tool, relative to the tool; d, n: distance
    and normal there; k [N/mm], c [N s/mm]; updates its anchor and the energies out (4,): normal spring, tangential
    spring, friction loss, loss where contact begins or ends [N mm].
    """
    near = d - offset
    nx, ny, nz = n
    rate = nx * v[0] + ny * v[1] + nz * v[2]
    if near >= 0.0:
        if anchor[0] < FREE:
            before = max(0.0, dt * rate - near)
            out[3] += 0.5 * TANGENTIAL * k * _held(p, v, dt, anchor, nx, ny, nz)
            spring, stored = _spring(k, before)
            out[3] += stored - 0.5 * spring * dt * rate
        anchor[0] = FREE
        return False
    px, py, pz = p
    spring, stored = _spring(k, -near)
    drag = TANGENTIAL * (c + dt * k)
    c += dt * k * _times(-near)
    inertia = dt * c
    pushed = spring > c * (nx * ahead[0] + ny * ahead[1] + nz * ahead[2])
    normal = spring - c * rate if pushed else 0.0
    out[0] += stored
    new = anchor[0] >= FREE
    before = 0.0 if new else max(0.0, dt * rate - near)
    if new or _times(before) != _times(-near):  # the mean force acts on the way, but stores less where it has a kink
        held, left = _spring(k, before)
        out[3] -= 0.5 * (spring + held) * dt * rate + stored - left
    if new:
        anchor[0], anchor[1], anchor[2] = px, py, pz
    sx, sy, sz = px - anchor[0], py - anchor[1], pz - anchor[2]
    s = sx * nx + sy * ny + sz * nz
    sx, sy, sz = sx - s * nx, sy - s * ny, sz - s * nz
    vx, vy, vz = v[0] - rate * nx, v[1] - rate * ny, v[2] - rate * nz
    k *= TANGENTIAL
    tx, ty, tz = -k * sx - drag * vx, -k * sy - drag * vy, -k * sz - drag * vz
    limit = mu * max(0.0, normal)
    share = coulomb(length(tx, ty, tz), limit)
    tx, ty, tz = tx * share, ty * share, tz * share
    stretch = length(sx, sy, sz)
    keep = 1.0
    if share < 1.0:
        keep = min(1.0, limit / max(k * stretch, 1e-30))
        anchor[0], anchor[1], anchor[2] = px - keep * sx, py - keep * sy, pz - keep * sz
    out[1] += 0.5 * k * (keep * stretch) ** 2
    before = sx * (sx - dt * vx) + sy * (sy - dt * vy) + sz * (sz - dt * vz)
    out[2 if pushed else 3] += 0.5 * k * (1.0 - keep) * (before + keep * stretch * stretch)
    held = k * keep
    along = dt * drag * share
    across = (inertia if pushed else 0.0) - along
    viscous = normal - spring
    give[0], give[1], give[2] = normal * nx + tx, normal * ny + ty, normal * nz + tz
    give[3], give[4], give[5] = along + across * nx * nx, along + across * ny * ny, along + across * nz * nz
    give[6], give[7], give[8] = across * nx * ny, across * nx * nz, across * ny * nz
    give[9], give[10], give[11] = (
        viscous * nx + tx + held * sx,
        viscous * ny + ty + held * sy,
        viscous * nz + tz + held * sz,
    )
    return True


@njit(**FAST)
def push_point(p, v, ahead, d, n, offset, k, c, mu, dt, anchor, out, give):
    """`_point`, compiled once for where it is not worth a copy of its own."""
    return _point(p, v, ahead, d, n, offset, k, c, mu, dt, anchor, out, give)


@njit(**INLINE)
def put(row, weight, give):
    """Add a point's share to a node's row of press (PRESS,)."""
    for c in range(PRESS):
        row[c] += weight * give[c]


@njit(**INLINE)
def _mean(a, c, i, k, j, l, r, s):
    """Component c of a (3, n, m) at the place (r, s) between rows i, k and columns j, l."""
    return (1 - r) * ((1 - s) * a[c, i, j] + s * a[c, i, l]) + r * ((1 - s) * a[c, k, j] + s * a[c, k, l])


@njit(**INLINE)
def _push(f, inverse, c, i, k, j, l, r, s):
    """The same of f / m."""
    return (1 - r) * ((1 - s) * f[c, i, j] * inverse[i, j] + s * f[c, i, l] * inverse[i, l]) + r * (
        (1 - s) * f[c, k, j] * inverse[k, j] + s * f[c, k, l] * inverse[k, l]
    )


@njit(**INLINE)
def _dual(d, j):
    """Length that line j of a grid stands for, from its cells' sizes d."""
    return 0.5 * ((d[j - 1] if j > 0 else 0.0) + (d[j] if j < d.shape[0] else 0.0))


@njit(**INLINE)
def _from_wall(x, walls, i, j):
    """Distance of node (i, j) from the nearest wall [mm]."""
    across = min(x[0, i, j] - walls[0], walls[1] - x[0, i, j])
    return min(across, x[1, i, j] - walls[2], walls[3] - x[1, i, j])


@njit(**FAST)
def _walls(x, v, f, inverse, area, walls, k, c, dt, i, j, anchors, out, give, press, pressed):
    """Let the box's walls keep node (i, j) inside; k, c per area; other arguments as in `tool_forces`."""
    for axis in range(2):
        low, high = walls[2 * axis], walls[2 * axis + 1]
        inward = 1.0 if x[axis, i, j] < 0.5 * (low + high) else -1.0
        d = x[axis, i, j] - low if inward > 0.0 else high - x[axis, i, j]
        anchor = anchors[i, j, WALL + axis]
        if (d >= 0.0 and anchor[0] >= FREE) or inverse[i, j] == 0.0:
            continue
        p, u = (x[0, i, j], x[1, i, j], x[2, i, j]), (v[0, i, j], v[1, i, j], v[2, i, j])
        h = dt * inverse[i, j]
        ahead = (u[0] + h * f[0, i, j], u[1] + h * f[1, i, j], u[2] + h * f[2, i, j])
        normal = (inward, 0.0, 0.0) if axis == 0 else (0.0, inward, 0.0)
        a = area[i, j]
        if push_point(p, u, ahead, d, normal, 0.0, k * a, c * a, 0.0, dt, anchor, out, give):
            pressed[i] = True
            put(press[i, j], 1.0, give)


@njit(**FAST)
def tool_forces(
    x, v, f, inverse, press, pressed, carry, area, dx, dy, tool, origin, spacing, law, box, motion, reach, dt,
    anchors, sleep, low, high, out, give,
):  # fmt: skip
    """Gather what the tool does to nodes and cells of rows low..high-1; returns its work [N mm], and if carry is used.

    x, v, f (3, n, m): f all other forces; inverse (n, m) of the masses; press (n, m, PRESS); carry (m + 2, PRESS);
    pressed (n,) bool: rows of press in use; area (n, m) of the nodes [mm2]; dx, dy reference cell sizes [mm];
    law = (offset, stiffness, damping, friction); box: whether walls stand under the sheet's edges, and where (4,):
    least and largest x, then y; motion = (z, speed) of the tool's base; reach: way that a point can go in a step [mm];
    anchors (n, m, POINTS, 3): of the node on the platform, then of the node, the middles of the edges along columns and
    rows, and the centre on the tool, of the node on the walls across x and y;
    sleep (n, m) int16; out (4,) as in `_point`; give (PRESS,) scratch.
    """
    offset, stiffness, damping, mu = law
    boxed, walls = box
    z, speed = motion
    n, m = x.shape[1], x.shape[2]
    work = 0.0
    carried = False
    depth = x[2, 0, 0] - offset - z if boxed else 0.0
    for i in range(low, high):
        for j in range(m):
            if boxed and _from_wall(x, walls, i, j) < reach:  # one that touched a step ago is no farther
                _walls(x, v, f, inverse, area, walls, stiffness, damping, dt, i, j, anchors, out, give, press, pressed)
            if x[2, i, j] - z >= offset and anchors[i, j, 0, 0] >= FREE:
                continue
            p = (x[0, i, j], x[1, i, j], x[2, i, j] - z)
            u = (v[0, i, j], v[1, i, j], v[2, i, j] - speed)
            h = dt * inverse[i, j]
            ahead = (u[0] + h * f[0, i, j], u[1] + h * f[1, i, j], u[2] + h * f[2, i, j])
            a, up = area[i, j], (0.0, 0.0, 1.0)
            rim = depth > offset and (
                i == 1 or i == n - 2 or j == 1 or j == m - 2 or _from_wall(x, walls, i, j) < depth
            )
            rough, k_a, c_a = 0.0 if rim else mu, stiffness * a, damping * a
            if _point(p, u, ahead, p[2], up, offset, k_a, c_a, rough, dt, anchors[i, j, 0], out, give):
                work += give[2] * speed * dt
                pressed[i] = True
                put(press[i, j], 1.0, give)
        k = min(i + 1, n - 1)
        for j in range(m):
            if sleep[i, j] > 0:
                sleep[i, j] -= 1
                continue
            l = min(j + 1, m - 1)
            nearest = 1.0e3
            for q in range(4):
                if (q >= 2 and k == i) or (q % 2 == 1 and l == j):
                    continue
                r = 0.0 if q < 2 else 0.5
                s = 0.0 if q % 2 == 0 else 0.5
                p = (
                    _mean(x, 0, i, k, j, l, r, s),
                    _mean(x, 1, i, k, j, l, r, s),
                    _mean(x, 2, i, k, j, l, r, s) - z,
                )
                d, nx, ny, nz = sample(tool, origin, spacing, p[0], p[1], p[2])
                nearest = min(nearest, d - offset)
                if d >= offset and anchors[i, j, 1 + q, 0] >= FREE:
                    continue
                a = 0.25 * (dx[i] if q >= 2 else _dual(dx, i)) * (dy[j] if q % 2 == 1 else _dual(dy, j))
                u = (
                    _mean(v, 0, i, k, j, l, r, s),
                    _mean(v, 1, i, k, j, l, r, s),
                    _mean(v, 2, i, k, j, l, r, s) - speed,
                )
                ahead = (
                    u[0] + dt * _push(f, inverse, 0, i, k, j, l, r, s),
                    u[1] + dt * _push(f, inverse, 1, i, k, j, l, r, s),
                    u[2] + dt * _push(f, inverse, 2, i, k, j, l, r, s),
                )
                if not _point(
                    p, u, ahead, d, (nx, ny, nz), offset, stiffness * a, damping * a, mu, dt, anchors[i, j, 1 + q],
                    out, give,
                ):  # fmt: skip
                    continue
                work += give[2] * speed * dt
                pressed[i] = True
                put(press[i, j], (1 - r) * (1 - s), give)
                if s > 0.0:
                    put(press[i, l], (1 - r) * s, give)
                if r == 0.0:
                    continue
                if k < high:
                    pressed[k] = True
                    put(press[k, j], r * (1 - s), give)
                    put(press[k, l], r * s, give)
                else:
                    carried = True
                    put(carry[j], r * (1 - s), give)
                    put(carry[l], r * s, give)
            if nearest > reach:
                sleep[i, j] = min(LONGEST_SLEEP, int(nearest / reach) - 1)
    return work, carried


@njit(**INLINE)
def _along(row, x, y, z):
    """The tool's force on a node, with what the tensor took (x, y, z), along the force of its springs [N]."""
    a, b, c = row[0] - row[9], row[1] - row[10], row[2] - row[11]
    along = (row[0] + x) * a + (row[1] + y) * b + (row[2] + z) * c
    return max(0.0, along) / max(length(a, b, c), 1e-30)


@njit(**FAST)
def settle_row(v, f, normal, share, press, mass, speed, keep, dt):
    """Add the tool's forces to a row and let it act on the sum implicitly: f <- m (m + J)^-1 f; press is cleared.

    v, f (3, m); press (m, PRESS); mass (m,), 0 where held; normal (m,)
    gathers a share of the tool's normal forces [N]; keep: what mass
    damping leaves of v. Returns the tool's further work and what was dissipated
    [N mm]: the viscous force and the change of f, times the mid-step velocity relative to the tool.
    """
    work = lost = 0.0
    for j in range(mass.shape[0]):
        m = mass[j]
        viscous = abs(press[j, 9]) + abs(press[j, 10]) + abs(press[j, 11])
        if m > 0.0 and press[j, 3] + press[j, 4] + press[j, 5] + viscous > 0.0:
            a, b, c = m + press[j, 3], m + press[j, 4], m + press[j, 5]
            d, e, g = press[j, 6], press[j, 7], press[j, 8]  # xy, xz, yz
            aa, bb, cc = b * c - g * g, a * c - e * e, a * b - d * d
            dd, ee, gg = e * g - d * c, d * g - e * b, d * e - a * g
            r = m / (a * aa + d * dd + e * ee)
            x, y, z = f[0, j] + press[j, 0], f[1, j] + press[j, 1], f[2, j] + press[j, 2]
            fx = r * (aa * x + dd * y + ee * z)
            fy = r * (dd * x + bb * y + gg * z)
            fz = r * (ee * x + gg * y + cc * z)
            f[0, j], f[1, j], f[2, j] = fx, fy, fz
            h = 0.5 * dt / m
            x, y, z = fx - x, fy - y, fz - z  # what the tensor took
            normal[j] += share * _along(press[j], x, y, z)
            work += z * speed * dt
            lost -= dt * (
                (x + press[j, 9]) * (keep * v[0, j] + h * fx)
                + (y + press[j, 10]) * (keep * v[1, j] + h * fy)
                + (z + press[j, 11]) * (keep * v[2, j] + h * fz - speed)
            )
        for k in range(PRESS):
            press[j, k] = 0.0
    return work, lost
