"""The tool bears plies through the diaphragm that is squeezed between them, implicit in time.

Tight fibres press on a tool's apex and ridges with some 10 MPa. The layers' penalty, which nodes in the open have to
bear at explicit steps, gives a millimetre there: plies went through the diaphragm (all formed parts had some fifty
crossings at the apex; plies of 1 mm elements on a diaphragm of 2.5 mm fell through it, with 6 % of fibre strain).
Rubber between fabric and tool has no room to give so much. So nodes of a ply nearer to the tool than

    h = offset of the diaphragm + half the sum of the distances at which the layers below and the ply touch

where all layers in between would be pressed in by half of these distances, are pushed by the tool itself:

    F = K A (h + s - d) - dt K A n.v'    along n, the gradient of the distance d, where F > 0
    s <- max(0, s + RISE (h - d))        each step: the bed rises until the node lies at h

K at most that of `contact.tool`, and so that dt^2 K A is at most MASSES of the node's mass; v' the velocity that comes
of F and of all other impulses of the step, those of the kept fibre tensions too: (m + dt^2 K A) of the node's motion
along n in place of m. Coulomb friction on the tool, through the sheets between, takes what it can of the motion along
the surface that the step would end with. The spring's energy counts with the tool's; what the rate takes is booked as
the tool's damping, on the node's mean velocity of the step, friction with the tool's, and what the bed's rise puts in
as the tool's work.

What corrects the fibres' tensions afterwards knows nothing of the bed. With all of the tool's stiffness, 8 masses at 2
mm, no crossing at all was left at the apex of the 0/90 case, but plies on the apexes of regular tetrahedra at 5 mm (13
masses) never came to rest, three of three without friction, one of three with it; that one does below 3. The rise
bears what a soft spring alone would not: it is slow beside a step, and so as good as none to what goes to and fro. (To
let the full stiffness act once more after the fibres' corrections was tried: both settle on a state in which each
undoes the other, and bars at the apex had crept to 7 % of strain at the end of the 0/90 case.)
"""

from __future__ import annotations

from numba import njit

from ddf.contact.field import look_forward, sample
from ddf.contact.friction import length
from ddf.contact.tool import LONGEST_SLEEP
from ddf.jit import FAST

MASSES = 2.6
"""Largest dt^2 K A over the mass of a ply's node."""

RISE = 0.02
"""Of what is left of h, how much the bed rises in a step."""

FORWARD = 8
"""Nodes before its turn that what the tool's field has at a node is asked for."""

#: columns of what bears a node: spring force [N], its rate coefficient [N s/mm], normal (3), velocity before (3) [mm/s]
BED = 8


@njit(**FAST)
def find_borne(x, v, area, inverse, tool, origin, spacing, law, motion, reach, dt, sleep, borne, rise, bed, low, high):
    """Find what bears the nodes of rows low..high-1, before they are kicked.

    x, v (3, n, m); area, inverse of the masses (n, m); law = (h [mm], K [N/mm3]); motion = (z, speed) of the tool's
    base; reach: way that a node can go in a step [mm]; sleep (n, m) int16; borne (n, m) bool and bed (n, m, BED) are
    set; rise (n, m), s, moves on. Returns the energy stored, what is lost where contact begins or ends and the work of
    the rise [N mm].
    """
    h, stiffness = law
    z, speed = motion
    stored = lost = work = 0.0
    for i in range(low, high):
        for j in range(x.shape[2]):
            borne[i, j] = False
            k = j + FORWARD
            if k < x.shape[2] and sleep[i, k] <= 0:
                look_forward(tool, origin, spacing, x[0, i, k], x[1, i, k], x[2, i, k] - z)
            if sleep[i, j] > 0:
                sleep[i, j] -= 1
                continue
            if inverse[i, j] == 0.0:
                continue
            d, nx, ny, nz = sample(tool, origin, spacing, x[0, i, j], x[1, i, j], x[2, i, j] - z)
            raised = rise[i, j]
            near = d - h - raised
            if near > reach:  # one that touched a step ago is no farther
                sleep[i, j] = min(LONGEST_SLEEP, int(near / reach) - 1)
                rise[i, j] = 0.0
                continue
            rate = nx * v[0, i, j] + ny * v[1, i, j] + nz * (v[2, i, j] - speed)
            k = stiffness * area[i, j]
            before, now = max(0.0, dt * rate - near), max(0.0, -near)
            spring, energy = k * now, 0.5 * k * now * now
            if max(before, now) > 0.0 and min(before, now) == 0.0:  # the mean force acts on all of the way
                lost -= 0.5 * k * (now + before) * dt * rate + energy - 0.5 * k * before * before
            rise[i, j] = 0.0
            if now > 0.0:
                more = max(-raised, RISE * (now - raised))
                rise[i, j] = raised + more
                work += k * more * (now + 0.5 * more + 0.5 * dt * rate)
                spring, energy = k * (now + more), 0.5 * k * (now + more) * (now + more)
                stored += energy
                borne[i, j] = True
                bed[i, j, 0], bed[i, j, 1] = spring, dt * k
                bed[i, j, 2], bed[i, j, 3], bed[i, j, 4] = nx, ny, nz
                for c in range(3):
                    bed[i, j, 5 + c] = v[c, i, j]
    return stored, lost, work


@njit(**FAST)
def bear(v, f, inverse, borne, bed, friction, motion, keep, dt, low, high):
    """Let the bed act on rows low..high-1 after all other impulses.

    v, f (3, n, m): F and friction are added to f; keep: what mass damping left of the velocities before; bed[0] becomes
    F less the spring, bed[5:] friction. Returns the power of both on the velocities before [N mm/s], the tool's work,
    and the halves of what damping and friction lose that go with these velocities [N mm].
    """
    speed = motion[1]
    power = work = lost = rubbed = 0.0
    for i in range(low, high):
        for j in range(v.shape[2]):
            if not borne[i, j]:
                continue
            spring, c, nx, ny, nz = bed[i, j, 0], bed[i, j, 1], bed[i, j, 2], bed[i, j, 3], bed[i, j, 4]
            x, y, z = v[0, i, j], v[1, i, j], v[2, i, j] - speed
            ahead = nx * x + ny * y + nz * z
            push = max(0.0, (spring - c * ahead) / (1.0 + dt * c * inverse[i, j]))
            x, y, z = x - ahead * nx, y - ahead * ny, z - ahead * nz
            share = min(1.0, friction * push * dt * inverse[i, j] / max(length(x, y, z), 1e-30))
            hold = -share / (dt * inverse[i, j])
            x, y, z = hold * x, hold * y, hold * z
            ox, oy, oz = keep * bed[i, j, 5], keep * bed[i, j, 6], keep * bed[i, j, 7]
            rate = nx * ox + ny * oy + nz * oz
            along = x * ox + y * oy + z * oz
            v[0, i, j] += dt * inverse[i, j] * (push * nx + x)
            v[1, i, j] += dt * inverse[i, j] * (push * ny + y)
            v[2, i, j] += dt * inverse[i, j] * (push * nz + z)
            f[0, i, j] += push * nx + x
            f[1, i, j] += push * ny + y
            f[2, i, j] += push * nz + z
            power += push * rate + along
            work += dt * (push * nz + z) * speed
            bed[i, j, 0], bed[i, j, 5], bed[i, j, 6], bed[i, j, 7] = push - spring, x, y, z
            lost -= 0.5 * dt * (push - spring) * (rate - nz * speed)
            rubbed -= 0.5 * dt * (along - z * speed)
    return power, work, lost, rubbed


@njit(**FAST)
def lose(v, borne, bed, motion, dt, low, high):
    """The other halves, with the velocities at the step's end [N mm]."""
    lost = rubbed = 0.0
    for i in range(low, high):
        for j in range(v.shape[2]):
            if borne[i, j]:
                x, y, z = v[0, i, j], v[1, i, j], v[2, i, j] - motion[1]
                lost -= 0.5 * dt * bed[i, j, 0] * (bed[i, j, 2] * x + bed[i, j, 3] * y + bed[i, j, 4] * z)
                rubbed -= 0.5 * dt * (bed[i, j, 5] * x + bed[i, j, 6] * y + bed[i, j, 7] * z)
    return lost, rubbed
