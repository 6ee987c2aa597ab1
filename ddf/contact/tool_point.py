"""What the rigid tool does to single points of a sheet: penalty, damping and Coulomb friction, implicit in time.

A point at p (tool frame: it moves with the tool) at the distance g from where it touches (signed distance less the
offset), with the outward normal n, is pushed by

    (- K A g - (C A + dt K A) n.v) n   where - K A g > (C A + dt K A) n.v*

(v*: the velocity at the end of the step without the tool: at the place that it leads to the point would be pushed.
Beyond the depths HARD and HARDER it is 3 and 6 times as stiff, also against the rate), and held by Coulomb friction on
a spring to its anchor of stiffness 0.3 K A. K [N/mm3], A the area it stands for; dt K v is the spring's force at the
place that the point is moving to. A point that does not touch yet (g > 0) and would with the v it has is stopped in
this step, by a force that is all viscous in the books; C acts where g < 0.

With the force goes the tensor

    J = (dt C A + dt^2 K A) (n n + 0.3 share (1 - n n)),   share: see `friction.coulomb`

by which `tool.settle_row` makes it implicit. The spring's mean force acts on the way of a step in which contact begins,
ends or meets another stiffness.

Points go through `press_points` by chunks, one row of the scratch `w` a quantity, in a loop that the compiler
vectorises.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.friction import TANGENTIAL, coulomb, length
from ddf.jit import FAST, INLINE

FREE = 1.0e30
"""First component of an anchor where the point did not touch."""
BACK = 3.0
"""C over dt K in formed scenes: a point that was found inside comes out in so many steps and one. In one step, as K
alone has it, it came out with 1 m/s, faster than pressure could stop it in the next, and parts chattered."""
HARD, HARDER = 0.1, 0.15
"""Depths [mm] beyond which the penalty is 3 and 6 times as stiff: on apexes, where fibres press with some 10 MPa."""

CHUNK = 64
"""Points that go through `press_points` together."""

# rows of a chunk: where each begins in `w`; vectors take three
PLACE, VELOCITY = np.uint64(0), np.uint64(3 * CHUNK)  # relative to the tool
LATER = np.uint64(6 * CHUNK)  # velocity at the end without the tool, relative to it
NORMAL, NEAR = np.uint64(9 * CHUNK), np.uint64(12 * CHUNK)  # distance from where it touches
STIFF, DAMPED, FRICTION = (np.uint64(k * CHUNK) for k in (13, 14, 15))  # K A [N/mm], C A [N s/mm], coefficient
ANCHOR = np.uint64(16 * CHUNK)  # updated
TOUCHES = np.uint64(19 * CHUNK)  # 1 or 0; 1 also where it is stopped before
GIVE = np.uint64(20 * CHUNK)
"""What the tool does, PRESS rows: force, tensor J (xx, yy, zz, xy, xz, yz) [tonne], viscous part of the force [N]."""
PRESS = 12
POINT_ROWS = 20 + PRESS
NEXT, THIRD = np.uint64(CHUNK), np.uint64(3 * CHUNK)


@njit(**INLINE)
def _vector(w, row, t):
    """Three rows of point t, from `row` on."""
    return w[row + t], w[row + NEXT + t], w[row + NEXT + NEXT + t]


@njit(**INLINE)
def set_vector(w, row, t, x, y, z):
    """Set three rows of point t, from `row` on."""
    w[row + t], w[row + NEXT + t], w[row + NEXT + NEXT + t] = x, y, z


@njit(**INLINE)
def _spring(k, depth):
    """Force of the penalty at a depth, and what it stores."""
    hard, harder = max(0.0, depth - HARD), max(0.0, depth - HARDER)
    force = k * (depth + 2.0 * hard + 3.0 * harder)
    return force, 0.5 * k * (depth * depth + 2.0 * hard * hard + 3.0 * harder * harder)


@njit(**INLINE)
def _times(depth):
    """How many times as stiff the penalty is at a depth."""
    return 6.0 if depth > HARDER else 3.0 if depth > HARD else 1.0


@njit(**FAST)
def press_points(w, count, dt, out):
    """What the tool does to the first `count` points of a chunk: TOUCHES, GIVE and new anchors in w.

    Adds the energies to out (4,): normal spring, tangential spring, friction loss, loss where contact begins or ends
    [N mm].
    """
    normal_spring = tangential_spring = rubbed = lost = 0.0
    for t in range(count):
        px, py, pz = _vector(w, PLACE, t)
        vx, vy, vz = _vector(w, VELOCITY, t)
        ex, ey, ez = _vector(w, LATER, t)
        nx, ny, nz = _vector(w, NORMAL, t)
        ax, ay, az = _vector(w, ANCHOR, t)
        near, k = w[NEAR + t], w[STIFF + t]
        touches = near < 0.0
        there = 1.0 if touches else 0.0
        new = ax >= FREE
        rate = nx * vx + ny * vy + nz * vz
        depth = max(0.0, -near)
        before = 0.0 if new else max(0.0, dt * rate - near)
        spring, stored = _spring(k, depth)
        held, left = _spring(k, before)
        # the mean force acts on the way, but stores less where it has a kink
        kink = new or not touches or before == 0.0 or _times(before) != _times(depth)
        lost -= 0.5 * (spring + held) * dt * rate + stored - left if kink else 0.0
        c = there * w[DAMPED + t] + dt * k * _times(depth)
        signed = spring - (1.0 - there) * k * near
        pushed = signed > c * (nx * ex + ny * ey + nz * ez) and (touches or signed > c * rate)
        push = 1.0 if pushed else 0.0
        normal = push * (signed - c * rate)
        meets = max(there, push)
        drag = TANGENTIAL * (there * w[DAMPED + t] + dt * k) * meets
        normal_spring += stored
        # friction
        ax, ay, az = px if new else ax, py if new else ay, pz if new else az
        sx, sy, sz = px - ax, py - ay, pz - az
        s = sx * nx + sy * ny + sz * nz
        sx, sy, sz = sx - s * nx, sy - s * ny, sz - s * nz
        vx, vy, vz = vx - rate * nx, vy - rate * ny, vz - rate * nz
        across = sx * (sx - dt * vx) + sy * (sy - dt * vy) + sz * (sz - dt * vz)
        kt = TANGENTIAL * k
        lost += (1.0 - meets) * 0.5 * kt * across  # all that it held where contact has ended
        kt *= meets
        tx, ty, tz = -kt * sx - drag * vx, -kt * sy - drag * vy, -kt * sz - drag * vz
        limit = w[FRICTION + t] * max(0.0, normal)
        share = coulomb(length(tx, ty, tz), limit)
        tx, ty, tz = tx * share, ty * share, tz * share
        stretch = length(sx, sy, sz)
        keep = min(1.0, limit / max(kt * stretch, 1e-30)) if share < 1.0 else 1.0
        tangential_spring += 0.5 * kt * (keep * stretch) * (keep * stretch)
        gave = 0.5 * kt * (1.0 - keep) * (across + keep * stretch * stretch)
        rubbed += push * gave
        lost += (1.0 - push) * gave
        slips = share < 1.0
        ax = px - keep * sx if slips else ax
        w[ANCHOR + t] = ax if meets > 0.0 else FREE
        w[ANCHOR + NEXT + t] = py - keep * sy if slips else ay
        w[ANCHOR + NEXT + NEXT + t] = pz - keep * sz if slips else az
        w[TOUCHES + t] = meets
        along = dt * drag * share
        more = push * dt * c - along
        viscous = normal - spring * there
        held = kt * keep
        set_vector(w, GIVE, t, normal * nx + tx, normal * ny + ty, normal * nz + tz)
        set_vector(w, GIVE + THIRD, t, along + more * nx * nx, along + more * ny * ny, along + more * nz * nz)
        set_vector(w, GIVE + THIRD + THIRD, t, more * nx * ny, more * nx * nz, more * ny * nz)
        x, y, z = viscous * nx + tx + held * sx, viscous * ny + ty + held * sy, viscous * nz + tz + held * sz
        set_vector(w, GIVE + THIRD + THIRD + THIRD, t, x, y, z)
    out[0] += normal_spring
    out[1] += tangential_spring
    out[2] += rubbed
    out[3] += lost
