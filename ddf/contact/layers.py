"""Contact of neighbouring sheets: slave nodes against the smooth surface of a master sheet.

A slave node keeps its place (u, v) on the master's grid; one step of the closest-point projection a time step
tracks it, with the metric stiffened by |d n.S_aa|: in a fold as tight as the sheet is thick, where Newton's
step would overshoot or have no answer, places then creep instead of jumping about. With N_k the weights of the
surface's nodes there (`patch.py`), tangents S_1, S_2, normal n, r = x_s - N_k x_k:

    gap    g = sign r.n - offset;             damping C A g', penalty energy where g < 0:
           U = A c (1/2 K g^2 + (H - 1)/2 K <-g - HARD offset>^2),  <.> positive part,
           c = s^2 (3 - 2 s), s: cover between 0 and 1
    r^a    contravariant components of r (metric of S_1, S_2): what the projection still lacks
    slip   s = s^a S_a;                       friction spring of stiffness 0.3 K A, Coulomb limit mu N
           kept along S_1 and across it [mm]: it turns with the master, which does not stretch it
    rates  of gap and slip are those on which the forces below do work: with w = v_s - (N_k + N_k,a r^a) v_k,
           g' = sign n.w,  s'_a = w.S_a + d n.(N_k,a v_k)

The force f on the slave is balanced on the master's nodes by

    f_k = -(N_k + N_k,a r^a) f + d f^a N_k,a n,     d = r.n,  f^a the contravariant components of f

Sum f_k = -f since sum N_k,a = 0; and because sum N_k,a x_k = S_a the moments cancel exactly too, for
r x f = r^a S_a x f + d n x f, whether or not the projection has converged. Without the second term the two
forces lie a gap apart and every contact would be a couple. Slip is a history and not the way of the place from an
anchor: in folds as tight as the contact distance places move where nothing slips. Nor are its components s^a kept: a
master that stretched took what slip was held along, and gave the springs energy that no force had worked for.

A node whose place lies outside the master's fabric is not in contact. Over half a cell on both sides of a ply's edge U
fades to nothing, and so does the energy of the friction spring (cover s, interpolated like the surface; -dU/ds s_a
pushes the node off the edge; it is the gradient to the first order in d times the master's curvature): the corner of
one ply that lies on the edge of another would else be pushed with all of K in one step and with none in the next, at 10
to 30 m/s (seen). One that is far away rests for as many steps as it needs at the given reach to come near.

A node that did not touch and is found deep (its projection failed for some steps, or a sheet has been pressed through
another and comes back) did no work to get there. With all its depth at once the penalty threw it out: in a stack
crushed on a ridge such nodes brought in more energy than the damping took, and it never came to rest. So the depth that
g stands for grows no faster than twice the rate and `GROWTH_S` allow, until it is the whole depth; what the springs
gain by growing is booked with the contact damping, like that of any contact that begins within a step.

Forces on the master go to one buffer a block of slave rows; the buffers are summed in a fixed order, so the
result does not depend on the number of threads.

The work goes by chunks of nodes that are awake, in passes over arrays short enough for the first cache:
`_fetch` interpolates node by node, `_project` and `_press` are loops that the compiler vectorises over nodes,
`_settle` decides who touches, `_scatter` adds the forces node by node.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.friction import TANGENTIAL, coulomb
from ddf.contact.patch import first_order, interpolate, spread, weights
from ddf.jit import FAST, INLINE
from ddf.quad import add_scaled, part, quad, quad_with

HARD, HARDENING = 0.2, 3.0
"""Part of the offset beyond which the penalty is stiffer, and how much. Only where the tool bears the stack do sheets
come so deep: tension of the fibres presses them on ridges and apexes with some MPa. There the tool's implicit
contact adds to the mass that the stiffness acts on."""

GROWTH_S = 5e-3
"""Time [s] in which the depth of a contact that is found deep, not come to, grows by the offset."""

WHOLE_COVER = 1.0 - 1e-9  # weights add up to 1 but for rounding
LONGEST_REST = 8
UNKNOWN = 1.0e30  # gap of a node that rests
DEEPEST = 3.0  # a node more than this many offsets beyond contact has been lost, not pressed
FARTHEST = 1.0  # a node whose projection lacks more than this, in cells, has been lost too
NOWHERE = np.int64(2**40)  # first column of an empty span

CHUNK = 32
"""Awake nodes that go through the passes together."""

ONE, FOUR, NEXT = np.uint64(1), np.uint64(4), np.uint64(CHUNK)
# fields of a chunk: where each begins in `w`
(
    X, Y, Z,  # slave node [mm]
    U0, V0, TU, TV,  # its place at the start, and from the patch's centre
    AREA, WHOLE, SU, SV,  # area (0: does not touch), area in any case, slip along S_1 and across
    COVER,  # s
    BEFORE,  # depth taken in the last step, 0 if it did not touch
    DU, DV, U, V,  # Newton step, new place
    NX, NY, NZ, D, GAP,  # normal, height above the surface, gap
    GUU, GUV, INVERSE,  # metric and inverse of its determinant
    WX, WY, WZ, BU, BV,  # w, and n.(N_k,a v_k)
    OLD_RATE, OLD_DRAG, RATE, DRAG,  # rate of the gap and viscous normal force, in the last step and now
    FN,  # normal force
    FX, FY, FZ, GX, GY, GZ, HX, HY, HZ,  # what `spread` takes: f,  e^1 n - r^1 f,  e^2 n - r^2 f  with e^a = d f^a
    SX, SY, SZ, SC, UX, UY, UZ, UC, VX, VY, VZ, VC,  # S, S_1, S_2: place on the surface and cover
    AX, AY, AZ, CX, CY, CZ,  # S_11, S_22
) = (np.uint64(k * CHUNK) for k in range(62))  # fmt: skip
FIELDS = 62


def chunk_scratch(members: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Scratch of the passes, one row a member of the team."""
    return (
        np.zeros((members, FIELDS * CHUNK)),
        np.zeros((members, 3, CHUNK), np.int64),
        np.zeros((members, CHUNK), np.uint64),
    )


@njit(**FAST)
def touched(span, i):
    """First and last+1 column written in row i of a buffer: those of the patches centred in rows i-1 .. i+1."""
    low, high = max(i - 1, 0), min(i + 2, span.shape[0])
    a, b = NOWHERE, np.int64(0)
    for k in range(low, high):
        a, b = min(a, span[k, 0]), max(b, span[k, 1])
    return a, b


@njit(**FAST)
def clear_buffer(buffer, span):
    """Zero what the last step wrote: buffer (n, m, 4), span (n, 2) columns touched by patches centred in a row."""
    for i in range(span.shape[0]):
        a, b = touched(span, i)
        for j in range(a, b):
            for c in range(4):
                buffer[i, j, c] = 0.0
    for i in range(span.shape[0]):
        span[i, 0] = NOWHERE
        span[i, 1] = 0


@njit(**FAST)
def collect_row(f, normal, share, buffer, i, a, b):
    """Add columns a..b-1 of row i of a buffer (n, m, 4) to f (3, n, m), a share of the last to normal forces (n, m)."""
    n0 = normal[i]
    f0, f1, f2, row = f[0, i], f[1, i], f[2, i], buffer[i]
    for j in range(a, b):
        f0[j] += row[j, 0]
        f1[j] += row[j, 1]
        f2[j] += row[j, 2]
        n0[j] += share * row[j, 3]


@njit(**FAST)
def pack_rows(x, cover, packed, low, high):
    """Rows low..high-1 of x (3, n, m) and of cover (n, m) as (x, y, z, cover) into packed (n, m, 4)."""
    for i in range(low, high):
        x0, x1, x2, c, row = x[0, i], x[1, i], x[2, i], cover[i], packed[i]
        for j in range(x0.shape[0]):
            row[j, 0] = x0[j]
            row[j, 1] = x1[j]
            row[j, 2] = x2[j]
            row[j, 3] = c[j]


@njit(**FAST)
def _find(u, v, centre, patch, w, t):
    """Choose the patch around a place; False where the master has none near.

    patch (3, CHUNK): where its first node begins in the packed master, row and column of its centre.
    """
    i = np.uint64(min(max(int(u + 0.5), 0), centre.shape[0] - 1))
    j = np.uint64(min(max(int(v + 0.5), 0), centre.shape[1] - 1))
    p, q = np.int64(centre[i, j, 0]), np.int64(centre[i, j, 1])
    patch[0, t] = 4 * ((p - 1) * centre.shape[1] + q - 1)
    patch[1, t] = p
    patch[2, t] = q
    w[U0 + t], w[V0 + t], w[TU + t], w[TV + t] = u, v, u - p, v - q
    return p >= 0


@njit(**FAST)
def _awake(node, end, rest, place, centre, patch, nodes, w):
    """Fill a chunk with nodes that are awake from `node` on; returns the node to go on with, and how many."""
    t = np.uint64(0)
    while node < end and t < np.uint64(CHUNK):
        if rest[node] > 0:
            rest[node] -= 1
        elif rest[node] == 0:
            if _find(place[0, node], place[1, node], centre, patch, w, t):
                nodes[t] = node
                t += ONE
            else:
                rest[node] = LONGEST_REST
        node += ONE
    return node, t


@njit(**INLINE)
def _put(w, k, q):
    """First three components of a quad into the fields from k on."""
    w[k], w[k + NEXT], w[k + NEXT + NEXT] = part(q, 0), part(q, 1), part(q, 2)


@njit(**FAST)
def _fetch(w, patch, nodes, count, x, area, place, slip, y, cols):
    """Copy what the slave nodes bring, and the surface at their places.

    By fields, not as quads: the loops that go over nodes would have to gather what lies four apart.
    """
    stride = FOUR * cols
    for t in range(count):
        node = nodes[t]
        w[X + t], w[Y + t], w[Z + t] = x[0, node], x[1, node], x[2, node]
        w[OLD_RATE + t], w[OLD_DRAG + t], w[AREA + t] = place[3, node], place[4, node], area[node]
        w[WHOLE + t] = area[node]
        w[BEFORE + t] = max(0.0, -place[2, node])
        w[SU + t], w[SV + t] = slip[0, node], slip[1, node]
        s, su, sv, suu, svv = interpolate(y, np.uint64(patch[0, t]), stride, w[TU + t], w[TV + t])
        _put(w, SX + t, s)
        _put(w, UX + t, su)
        _put(w, VX + t, sv)
        _put(w, AX + t, suu)
        _put(w, CX + t, svv)
        w[SC + t], w[UC + t], w[VC + t] = part(s, 3), part(su, 3), part(sv, 3)


@njit(**FAST)
def _fetch_rates(w, patch, nodes, count, v, y, cols):
    """W and n.(N_k,a v_k) of the nodes that touch or just left; y: the master's velocities."""
    stride = FOUR * cols
    for t in range(count):
        if w[AREA + t] == 0.0 and w[BEFORE + t] == 0.0:
            continue
        node = nodes[t]
        m, mu, mv = first_order(y, np.uint64(patch[0, t]), stride, w[TU + t], w[TV + t])
        m = add_scaled(w[DU + t], mu, add_scaled(w[DV + t], mv, m))
        nx, ny, nz = w[NX + t], w[NY + t], w[NZ + t]
        w[WX + t], w[WY + t], w[WZ + t] = v[0, node] - part(m, 0), v[1, node] - part(m, 1), v[2, node] - part(m, 2)
        w[BU + t] = nx * part(mu, 0) + ny * part(mu, 1) + nz * part(mu, 2)
        w[BV + t] = nx * part(mv, 0) + ny * part(mv, 1) + nz * part(mv, 2)


@njit(**FAST)
def _tangents(w, t):
    """S_1 and S_2 of node t of a chunk."""
    return w[UX + t], w[UY + t], w[UZ + t], w[VX + t], w[VY + t], w[VZ + t]


@njit(**FAST)
def _project(w, count, end_u, end_v, sign, offset):
    """One Newton step of the projection of all nodes of a chunk: places, normals, gaps."""
    for t in range(count):
        ux, uy, uz, vx, vy, vz = _tangents(w, t)
        rx, ry, rz = w[X + t] - w[SX + t], w[Y + t] - w[SY + t], w[Z + t] - w[SZ + t]
        guu = ux * ux + uy * uy + uz * uz
        gvv = vx * vx + vy * vy + vz * vz
        guv = ux * vx + uy * vy + uz * vz
        inv = 1.0 / max(guu * gvv - guv * guv, 1e-30)
        ru = rx * ux + ry * uy + rz * uz
        rv = rx * vx + ry * vy + rz * vz
        du = (gvv * ru - guv * rv) * inv
        dv = (guu * rv - guv * ru) * inv
        il = np.sqrt(inv)
        nx, ny, nz = (uy * vz - uz * vy) * il, (uz * vx - ux * vz) * il, (ux * vy - uy * vx) * il
        d = rx * nx + ry * ny + rz * nz
        bu = abs(d * (nx * w[AX + t] + ny * w[AY + t] + nz * w[AZ + t]))
        bv = abs(d * (nx * w[CX + t] + ny * w[CY + t] + nz * w[CZ + t]))
        auu, avv = guu + bu, gvv + bv
        step = 1.0 / (auu * avv - guv * guv + 1e-30)
        su = min(max((avv * ru - guv * rv) * step, -0.5), 0.5)
        sv = min(max((auu * rv - guv * ru) * step, -0.5), 0.5)
        w[DU + t] = du
        w[DV + t] = dv
        w[U + t] = min(max(w[U0 + t] + su, -1.0), end_u)
        w[V + t] = min(max(w[V0 + t] + sv, -1.0), end_v)
        w[NX + t] = nx
        w[NY + t] = ny
        w[NZ + t] = nz
        w[D + t] = d
        cover = min(1.0, max(0.0, w[SC + t]))
        fade = cover * cover * (3.0 - 2.0 * cover)
        w[COVER + t] = cover
        w[AREA + t] *= fade
        w[WHOLE + t] *= fade
        w[GAP + t] = sign * d - offset
        w[GUU + t] = guu
        w[GUV + t] = guv
        w[INVERSE + t] = inv


@njit(**FAST)
def _settle(w, nodes, count, place, slip, rest, rows, cols, deepest, inverse_reach):
    """New places; nodes that do not touch get area 0 and lose their slip. Returns how many touch or just left."""
    end_u, end_v = rows - 1.0, cols - 1.0
    touching = 0
    for t in range(count):
        node, u, v, gap = nodes[t], w[U + t], w[V + t], w[GAP + t]
        place[0, node] = u
        place[1, node] = v
        place[2, node] = gap
        place[3, node] = 0.0
        place[4, node] = 0.0
        touches = gap < 0.0 and gap >= deepest and u >= 0.0 and v >= 0.0 and u < end_u and v < end_v
        touches = touches and abs(w[DU + t]) < FARTHEST and abs(w[DV + t]) < FARTHEST
        if touches and w[COVER + t] > 0.0:
            touching += 1
            continue
        if w[BEFORE + t] > 0.0:
            touching += 1
        w[AREA + t] = 0.0
        place[2, node] = max(0.0, gap)  # below 0 only where it touches
        slip[0, node] = 0.0
        slip[1, node] = 0.0
        if gap >= 0.0:
            steps = min(np.float64(LONGEST_REST), gap * inverse_reach)
            rest[node] = np.int8(steps)
            if steps >= 1.0:
                place[2, node] = UNKNOWN
    return touching


@njit(**INLINE)
def _spring(k, depth, hard):
    """Force of the penalty at a depth, and what it stores."""
    excess = max(0.0, depth - hard)
    force = k * (depth + (HARDENING - 1.0) * excess)
    return force, 0.5 * k * (depth * depth + (HARDENING - 1.0) * excess * excess)


@njit(**FAST)
def _press(w, count, sign, mu, stiffness, offset, damping, slow, dt):
    """Forces and new slips of all nodes of a chunk; returns the four sums of `layer_forces`."""
    normal = tangential = rubbed = damped = 0.0
    inverse_dt, hard, growth = 1.0 / dt, HARD * offset, offset * dt / GROWTH_S
    for t in range(count):
        guu = w[GUU + t]
        nx, ny, nz, d = w[NX + t], w[NY + t], w[NZ + t], w[D + t]
        wx, wy, wz = w[WX + t], w[WY + t], w[WZ + t]
        ux, uy, uz, vx, vy, vz = _tangents(w, t)
        # unit vectors along S_1 and across it: e_1 = S_1 / |S_1|, e_2 = (S_2 - lean S_1) / |S_2 - lean S_1|
        inverse_u, inverse_v = 1.0 / np.sqrt(guu), np.sqrt(guu * w[INVERSE + t])
        lean = w[GUV + t] * inverse_u * inverse_u
        k, c = stiffness * w[AREA + t], damping * w[AREA + t] * slow
        rate = sign * (nx * wx + ny * wy + nz * wz)
        # no deeper than the last step's depth and the rate can account for
        before, whole = w[BEFORE + t], max(0.0, -w[GAP + t])
        depth = min(whole, before + growth + 2.0 * dt * max(0.0, -rate))
        w[GAP + t] = -depth
        spring, stored = _spring(k, depth, hard)
        fn = max(0.0, spring - c * rate)
        # slip rate m, and the spring's slip p if nothing gave way, o before
        ru = wx * ux + wy * uy + wz * uz + d * w[BU + t]
        rv = wx * vx + wy * vy + wz * vz + d * w[BV + t]
        m1, m2 = ru * inverse_u, (rv - lean * ru) * inverse_v
        o1, o2 = w[SU + t], w[SV + t]
        p1, p2 = o1 + dt * m1, o2 + dt * m2
        kt, cs = TANGENTIAL * k, TANGENTIAL * c
        t1, t2 = -kt * p1 - cs * m1, -kt * p2 - cs * m2
        limit = mu * fn
        share = coulomb(np.sqrt(t1 * t1 + t2 * t2), limit)
        t1, t2 = t1 * share, t2 * share
        stretch2 = p1 * p1 + p2 * p2
        # where friction slips the spring keeps what it alone can carry
        keep = min(1.0, limit / max(kt * np.sqrt(stretch2), 1e-30)) if share < 1.0 else 1.0
        w[SU + t], w[SV + t] = keep * p1, keep * p2
        normal += stored
        tangential += kt * stretch2 * keep * keep
        held = kt * keep  # friction less the spring's part of it is viscous
        viscous = (t1 + held * p1) * m1 + (t2 + held * p2) * m2
        # the spring's mean force on the way it gave way; all that it held where the contact has opened
        across = o1 * p1 + o2 * p2
        rubbed += 0.5 * kt * (1.0 - keep) * (across + keep * stretch2) - dt * viscous
        opened = stiffness * (w[WHOLE + t] - w[AREA + t]) if w[BEFORE + t] > 0.0 else 0.0
        rubbed += 0.5 * TANGENTIAL * opened * across
        # the spring's force is taken to act through all of the step in which contact begins or ends
        pull, left = _spring(opened, before, hard)
        damped += left * inverse_dt - 0.5 * pull * rate
        # the same where the depth has grown by itself (whole + dt rate: the whole depth of the last step)
        pull, left = _spring(k, before, hard)
        abrupt = 1.0 if before == 0.0 or depth < whole or whole + dt * rate > before + growth else 0.0
        damped -= abrupt * (0.5 * (spring + pull) * rate + (stored - left) * inverse_dt)
        # the viscous force of the last step worked on the mean of the rates before and after it
        damped -= 0.5 * w[OLD_DRAG + t] * (w[OLD_RATE + t] + rate)
        w[RATE + t] = rate
        w[DRAG + t] = fn - spring if w[AREA + t] > 0.0 else 0.0
        # off the master's edge, where its cover is less than whole
        cover = max(w[COVER + t], 1e-30)
        edge = cover < WHOLE_COVER and w[AREA + t] > 0.0
        both = stored + 0.5 * kt * stretch2 * keep * keep
        slope = -both * 6.0 * (1.0 - cover) / (cover * (3.0 - 2.0 * cover)) if edge else 0.0
        eu, ev = slope * w[UC + t], slope * w[VC + t]
        t1, t2 = t1 + eu * inverse_u, t2 + (ev - lean * eu) * inverse_v
        # contravariant components
        cv = t2 * inverse_v
        cu = t1 * inverse_u - lean * cv
        fx = sign * fn * nx + cu * ux + cv * vx
        fy = sign * fn * ny + cu * uy + cv * vy
        fz = sign * fn * nz + cu * uz + cv * vz
        eu, ev = d * cu, d * cv
        du, dv = w[DU + t], w[DV + t]
        w[FN + t] = fn
        w[FX + t], w[FY + t], w[FZ + t] = fx, fy, fz
        w[GX + t], w[GY + t], w[GZ + t] = eu * nx - du * fx, eu * ny - du * fy, eu * nz - du * fz
        w[HX + t], w[HY + t], w[HZ + t] = ev * nx - dv * fx, ev * ny - dv * fy, ev * nz - dv * fz
    return normal, 0.5 * tangential, rubbed, dt * damped


@njit(**FAST)
def _scatter(w, patch, nodes, count, f, normal, place, slip, buffer, span, cols):
    """Add the forces of the nodes that touch to the slave and to the master's buffer; store their slips."""
    stride = FOUR * cols
    for t in range(count):
        if w[AREA + t] == 0.0:
            continue
        node = nodes[t]
        slip[0, node] = w[SU + t]
        slip[1, node] = w[SV + t]
        place[2, node] = w[GAP + t]
        place[3, node] = w[RATE + t]
        place[4, node] = w[DRAG + t]
        fx, fy, fz = w[FX + t], w[FY + t], w[FZ + t]
        normal[node] += w[FN + t]
        f[0, node] += fx
        f[1, node] += fy
        f[2, node] += fz
        a, b = weights(w[TU + t]), weights(w[TV + t])
        along_u = quad(w[GX + t], w[GY + t], w[GZ + t])
        along_v = quad(w[HX + t], w[HY + t], w[HZ + t])
        spread(buffer, np.uint64(patch[0, t]), stride, a, b, quad_with(-fx, -fy, -fz, w[FN + t]), along_u, along_v)
        p, q = patch[1, t], patch[2, t]
        span[p, 0] = min(span[p, 0], q - 1)
        span[p, 1] = max(span[p, 1], q + 2)


@njit(**FAST)
def _chunk(
    w, patch, nodes, count, x, v, f, normal, area, y, rates, rows, cols, place, slip, rest, buffer, span, pair,
    reach, dt, out,
):  # fmt: skip
    """All passes over one chunk; arguments as in `layer_forces`, grids of nodes and quads made flat."""
    end_u, end_v = np.float64(rows), np.float64(cols)
    _fetch(w, patch, nodes, count, x, area, place, slip, y, cols)
    _project(w, count, end_u, end_v, pair.sign, pair.offset)
    deepest = -DEEPEST * pair.offset
    if _settle(w, nodes, count, place, slip, rest, end_u, end_v, deepest, 1.0 / reach) > 0:
        _fetch_rates(w, patch, nodes, count, v, rates, cols)
        slow = 1.0 / (1.0 + 0.5 * pair.damping * dt / pair.mass)  # damping acts on mid-step velocities
        sums = _press(w, count, pair.sign, pair.friction, pair.stiffness, pair.offset, pair.damping, slow, dt)
        for k in range(4):
            out[k] += sums[k]
        _scatter(w, patch, nodes, count, f, normal, place, slip, buffer, span, cols)


@njit(**FAST)
def layer_forces(
    xs, vs, fs, normal, area, xm, vm, centre, place, slip, rest, buffer, span, pair, reach, dt, low, high,
    scratch, out,
):  # fmt: skip
    """Add the contact forces of slave rows low..high-1 to fs and to the master's buffer.

    xs, vs, fs (3, n, m) slave; normal (n, m) gathers its normal forces [N]; xm, vm (N, M, 4) master as from
    `pack_rows`, vm with zeros for the cover; area (n, m) [mm2]; centre (N, M, 2) from `patch_centres`; place (5, n, m):
    (u, v), gap (where it touches: less the depth taken), its rate and viscous force of the last step; slip (2, n, m)
    [mm]; both updated; rest (n, m) int8: steps to rest, negative for nodes that are not followed; buffer (N, M, 4),
    span (N, 2), cleared by `clear_buffer`; reach: way that a node can go in a step [mm]; scratch = (w, patch, nodes)
    from `chunk_scratch`. out (4,): normal and tangential spring energy now, friction and damping loss of this step
    [N mm].
    """
    size = xs.shape[1] * xs.shape[2]
    x, v, f = xs.reshape((3, size)), vs.reshape((3, size)), fs.reshape((3, size))
    place, slip = place.reshape((5, size)), slip.reshape((2, size))
    rest, area, normal = rest.reshape(size), area.reshape(size), normal.reshape(size)
    y, rates, forces = xm.reshape(xm.size), vm.reshape(vm.size), buffer.reshape(buffer.size)
    rows, cols = np.uint64(centre.shape[0]), np.uint64(centre.shape[1])
    w, patch, nodes = scratch
    node, end = np.uint64(low * xs.shape[2]), np.uint64(high * xs.shape[2])
    while node < end:
        node, t = _awake(node, end, rest, place, centre, patch, nodes, w)
        if t > np.uint64(0):
            _chunk(
                w, patch, nodes, t, x, v, f, normal, area, y, rates, rows, cols, place, slip, rest, forces,
                span, pair, reach, dt, out,
            )  # fmt: skip
