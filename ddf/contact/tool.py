"""Contact of a diaphragm with the rigid tool, the platform around it and the box's walls, implicit in time.

The platform is met by the nodes (d = z, n = e_z), the tool by nodes, middles of edges and centres of cells, so that
no ridge passes between nodes; the law of a point is in `tool_point.py`. Its force goes to the node, or to the cell's
four with the point's bilinear weights N_i, and its tensor J likewise.

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

Points that touch, did a step ago or would in this one, are pressed together by chunks. Forces and tensors are gathered
in `press`, while all other forces stand in f. The last row of a block of cells belongs to the next block: it goes to
`carry`, which is added later in a fixed order. A cell found far from the tool does not look at it for as many steps as
it needs at the given reach to come near.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.field import look_forward, sample
from ddf.contact.friction import length
from ddf.contact.tool_point import (
    ANCHOR,
    CHUNK,
    DAMPED,
    FREE,
    FRICTION,
    GIVE,
    LATER,
    NEAR,
    NEXT,
    NORMAL,
    PLACE,
    POINT_ROWS,
    PRESS,
    STIFF,
    THIRD,
    TOUCHES,
    VELOCITY,
    press_points,
    set_vector,
)
from ddf.jit import FAST, INLINE
from ddf.quad import add_scaled, load, part, quad_with, scaled, store

PLATFORM, NODE, ALONG_COLUMNS, ALONG_ROWS, CENTRE, WALL = range(6)
"""Points of a node: on the platform; on the tool itself, with the middles of two of its cell's edges and the cell's
centre; the first of two on walls (across x and y)."""
POINTS = 7
LONGEST_SLEEP = 16
ONE, TWO, FOUR = np.uint64(1), np.uint64(2), np.uint64(4)


def point_scratch(members: int, widest: int) -> tuple[np.ndarray, ...]:
    """Scratch of `tool_forces`, one row a member.

    Numbers of a chunk's points and whose they are; velocities ahead; of a row's points on the tool: places, distance
    and normal, kind and column.
    """
    return (
        np.zeros((members, POINT_ROWS * CHUNK)),
        np.zeros((members, 3, CHUNK), np.int64),
        np.zeros((members, 8 * widest)),
        np.zeros((members, 16 * widest)),
        np.zeros((members, 16 * widest)),
        np.zeros((members, 2, 4 * widest), np.int64),
    )


@njit(**INLINE)
def put(row, k, weight, w, t):
    """Add a weight of what the tool does to point t of a chunk to PRESS numbers, from place k of `row` on."""
    o = GIVE + t
    for _ in range(3):
        give = quad_with(w[o], w[o + NEXT], w[o + NEXT + NEXT], w[o + THIRD])
        store(row, k, add_scaled(weight, give, load(row, k)))
        o += THIRD + NEXT
        k += FOUR


@njit(**INLINE)
def _add(w, whose, t, kind, i, j, p, u, later, near, normal, law, anchors):
    """Add point t to a chunk; p, u, later: quads; law = (K A, C A, friction). Returns how many there are now."""
    whose[0, t], whose[1, t], whose[2, t] = kind, i, j
    set_vector(w, PLACE, t, part(p, 0), part(p, 1), part(p, 2))
    set_vector(w, VELOCITY, t, part(u, 0), part(u, 1), part(u, 2))
    set_vector(w, LATER, t, part(later, 0), part(later, 1), part(later, 2))
    set_vector(w, NORMAL, t, normal[0], normal[1], normal[2])
    set_vector(w, ANCHOR, t, anchors[kind, 0, i, j], anchors[kind, 1, i, j], anchors[kind, 2, i, j])
    w[NEAR + t] = near
    w[STIFF + t], w[DAMPED + t], w[FRICTION + t] = law
    return t + ONE


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
def _look_ahead(v, f, inverse, dt, i, later):
    """Velocities of row i at the step's end without the tool, as quads, into its half of `later` (8 m,)."""
    m = inverse.shape[1]
    row = later[4 * m * (i % 2) : 4 * m * (i % 2 + 1)].reshape((m, 4))
    for j in range(m):
        h = dt * inverse[i, j]
        row[j, 0] = v[0, i, j] + h * f[0, i, j]
        row[j, 1] = v[1, i, j] + h * f[1, i, j]
        row[j, 2] = v[2, i, j] + h * f[2, i, j]


@njit(**INLINE)
def _middle(y, kind, a, b, c, d):
    """Mean of the nodes between which a point lies; a, b, c, d: where the cell's four begin in y."""
    if kind == NODE:
        return load(y, a)
    if kind == ALONG_COLUMNS:
        return scaled(0.5, add_scaled(1.0, load(y, a), load(y, b)))
    if kind == ALONG_ROWS:
        return scaled(0.5, add_scaled(1.0, load(y, a), load(y, c)))
    first, second = add_scaled(1.0, load(y, a), load(y, b)), add_scaled(1.0, load(y, c), load(y, d))
    return scaled(0.25, add_scaled(1.0, first, second))


@njit(**FAST)
def _flush(w, whose, count, press, pressed, carry, anchors, speed, dt, high, out):
    """Press a chunk's points, add what the tool does to their nodes; returns its work, and if carry is used."""
    m = press.shape[1]
    press_points(w, count, dt, out)
    work = 0.0
    carried = False
    for t in range(count):
        kind, i, j = whose[0, t], whose[1, t], whose[2, t]
        for c in range(3):
            anchors[kind, c, i, j] = w[ANCHOR + np.uint64(c) * NEXT + t]
        if w[TOUCHES + t] == 0.0:
            continue
        work += w[GIVE + NEXT + NEXT + t] * speed * dt
        pressed[i] = True
        beside = kind in (ALONG_COLUMNS, CENTRE)
        below = kind in (ALONG_ROWS, CENTRE)
        weight = 0.25 if beside and below else 0.5 if beside or below else 1.0
        k = np.uint64(PRESS * (i * m + j))
        put(press, k, weight, w, t)
        if beside:
            put(press, k + np.uint64(PRESS), weight, w, t)
        if below and i + 1 < high:
            pressed[i + 1] = True
            k += np.uint64(PRESS * m)
            put(press, k, weight, w, t)
            if beside:
                put(press, k + np.uint64(PRESS), weight, w, t)
        elif below:
            carried = True
            k = np.uint64(PRESS * j)
            put(carry, k, weight, w, t)
            if beside:
                put(carry, k + np.uint64(PRESS), weight, w, t)
    return work, carried


@njit(**FAST)
def _points_of_row(y, lift, sleep, i, n, tool, origin, spacing, places, whose):
    """Places of a row's points on the tool's own grid, and kind and column of each; returns how many.

    What the tool's field has there is seldom in a cache: it is asked for here and looked up later.
    """
    m = sleep.shape[1]
    k = min(i + 1, n - 1)
    count = 0
    for j in range(m):
        if sleep[i, j] > 0:
            sleep[i, j] -= 1
            continue
        l = min(j + 1, m - 1)
        a, b = np.uint64(4 * (i * m + j)), np.uint64(4 * (i * m + l))
        c, d = np.uint64(4 * (k * m + j)), np.uint64(4 * (k * m + l))
        for kind in range(NODE, CENTRE + 1):
            if (kind >= ALONG_ROWS and k == i) or (kind in (ALONG_COLUMNS, CENTRE) and l == j):
                continue
            p = add_scaled(1.0, _middle(y, kind, a, b, c, d), lift)
            look_forward(tool, origin, spacing, part(p, 0), part(p, 1), part(p, 2))
            store(places, np.uint64(4 * count), p)
            whose[0, count], whose[1, count] = kind, j
            count += 1
    return count


@njit(**FAST)
def _look_up(tool, origin, spacing, places, count, found):
    """Distance and normal at the first `count` places, as quads."""
    for q in range(count):
        d, nx, ny, nz = sample(tool, origin, spacing, places[4 * q], places[4 * q + 1], places[4 * q + 2])
        store(found, np.uint64(4 * q), quad_with(d, nx, ny, nz))


@njit(**FAST)
def tool_forces(
    x, v, f, y, rates, inverse, press, pressed, carry, area, dx, dy, tool, origin, spacing, law, box, motion, reach, dt,
    anchors, sleep, low, high, out, scratch,
):  # fmt: skip
    """Gather what the tool does to nodes and cells of rows low..high-1; returns its work [N mm], and if carry is used.

    x, v, f (3, n, m): f all other forces; y, rates (4 n m,): x and v as quads; inverse (n, m) of the masses; press
    (n, m, PRESS); carry (m + 2, PRESS); pressed (n,) bool: rows of press in use; area (n, m) of the nodes [mm2]; dx, dy
    reference cell sizes [mm]; law = (offset, stiffness, damping, friction); box: whether walls stand under the sheet's
    edges, and where (4,): least and largest x, then y; motion = (z, speed) of the tool's base; reach: way that a point
    can go in a step [mm]; anchors (POINTS, 3, n, m); sleep (n, m) int16; out (4,) as in `press_points`; scratch of a
    member from `point_scratch`.
    """
    offset, stiffness, damping, mu = law
    boxed, walls = box
    z, speed = motion
    w, whose, later, places, found, owners = scratch
    n, m = inverse.shape
    lift, moving = quad_with(0.0, 0.0, -z, 0.0), quad_with(0.0, 0.0, -speed, 0.0)
    work = 0.0
    carried = False
    depth = x[2, 0, 0] - offset - z if boxed else 0.0
    t = np.uint64(0)
    if low < high:
        _look_ahead(v, f, inverse, dt, low, later)
    for i in range(low, high):
        k = min(i + 1, n - 1)
        if k > i:
            _look_ahead(v, f, inverse, dt, k, later)
        count = _points_of_row(y, lift, sleep, i, n, tool, origin, spacing, places, owners)
        _look_up(tool, origin, spacing, places, count, found)
        q = 0
        for j in range(m):
            if t > np.uint64(CHUNK - POINTS):
                done, used = _flush(w, whose, t, press, pressed, carry, anchors, speed, dt, high, out)
                work, carried, t = work + done, carried or used, np.uint64(0)
            a, ahead = np.uint64(4 * (i * m + j)), np.uint64(4 * (m * (i % 2) + j))
            if boxed and _from_wall(x, walls, i, j) < reach:  # one that touched a step ago is no farther
                for axis in range(2):
                    middle = 0.5 * (walls[2 * axis] + walls[2 * axis + 1])
                    inward = 1.0 if x[axis, i, j] < middle else -1.0
                    near = inward * (x[axis, i, j] - (walls[2 * axis] if inward > 0.0 else walls[2 * axis + 1]))
                    lands = near + dt * inward * later[ahead + np.uint64(axis)] < 0.0
                    if (near < 0.0 or lands or anchors[WALL + axis, 0, i, j] < FREE) and inverse[i, j] > 0.0:
                        normal = (inward, 0.0, 0.0) if axis == 0 else (0.0, inward, 0.0)
                        hard = (stiffness * area[i, j], damping * area[i, j], 0.0)
                        p, u, e = load(y, a), load(rates, a), load(later, ahead)
                        t = _add(w, whose, t, WALL + axis, i, j, p, u, e, near, normal, hard, anchors)
            near = x[2, i, j] - z - offset
            lands = near < reach and near + dt * (later[ahead + TWO] - speed) < 0.0
            if near < 0.0 or lands or anchors[PLATFORM, 0, i, j] < FREE:
                rim = depth > offset and (
                    i == 1 or i == n - 2 or j == 1 or j == m - 2 or _from_wall(x, walls, i, j) < depth
                )
                p, u = add_scaled(1.0, load(y, a), lift), add_scaled(1.0, load(rates, a), moving)
                e = add_scaled(1.0, load(later, ahead), moving)
                hard = (stiffness * area[i, j], damping * area[i, j], 0.0 if rim else mu)
                t = _add(w, whose, t, PLATFORM, i, j, p, u, e, near, (0.0, 0.0, 1.0), hard, anchors)
            nearest = -1.0 if q == count or owners[1, q] != j else 1.0e3
            l = min(j + 1, m - 1)
            b, c, d = np.uint64(4 * (i * m + l)), np.uint64(4 * (k * m + j)), np.uint64(4 * (k * m + l))
            beside, below = np.uint64(4 * (m * (i % 2) + l)), np.uint64(4 * (m * (k % 2) + j))
            across = np.uint64(4 * (m * (k % 2) + l))
            while q < count and owners[1, q] == j:
                kind, near = owners[0, q], found[4 * q] - offset
                nearest = min(nearest, near)
                if near < reach:  # one that touched a step ago is no farther
                    normal = (found[4 * q + 1], found[4 * q + 2], found[4 * q + 3])
                    e = add_scaled(1.0, _middle(later, kind, ahead, beside, below, across), moving)
                    lands = near + dt * (normal[0] * part(e, 0) + normal[1] * part(e, 1) + normal[2] * part(e, 2)) < 0.0
                    if not (lands or near < 0.0 or anchors[kind, 0, i, j] < FREE):
                        q += 1
                        continue
                    size = 0.25 * (dx[i] if kind >= ALONG_ROWS else _dual(dx, i))
                    size *= dy[j] if kind in (ALONG_COLUMNS, CENTRE) else _dual(dy, j)
                    u = add_scaled(1.0, _middle(rates, kind, a, b, c, d), moving)
                    hard = (stiffness * size, damping * size, mu)
                    p = load(places, np.uint64(4 * q))
                    t = _add(w, whose, t, kind, i, j, p, u, e, near, normal, hard, anchors)
                q += 1
            if nearest > reach:
                sleep[i, j] = min(LONGEST_SLEEP, int(nearest / reach) - 1)
    if t > np.uint64(0):
        done, used = _flush(w, whose, t, press, pressed, carry, anchors, speed, dt, high, out)
        work, carried = work + done, carried or used
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
