"""The tool bears plies through the diaphragm that is squeezed between them, implicit in time.

Tight fibres press on a tool's apex and ridges with some 10 MPa. The layers' penalty, which nodes in the open have to
bear at explicit steps, gives a millimetre there: plies went through the diaphragm (all formed parts had some fifty
crossings at the apex; plies of 1 mm elements on a diaphragm of 2.5 mm fell through it, with 6 % of fibre strain).
Rubber between fabric and tool has no room to give so much. So nodes of a ply nearer to the tool than

    h = offset of the diaphragm + half the sum of the distances at which the layers below and the ply touch

where all layers in between would be pressed in by half of these distances, are pushed by the tool itself:

    F = K A (h - d) - dt K A n.v'    along n, the gradient of the distance d, where F > 0

K half of that of `contact.tool` (with all of it, and stiffer with depth as there, stacks of plies on apexes of regular
tetrahedra never came to rest, three of three), v' the velocity that comes of F and of all other impulses of the step,
those of the kept fibre tensions too: (m + dt^2 K A) of the node's motion along n in place of m. There is no friction in
it: that is between the layers. The spring's energy counts with the tool's; what the rate takes is booked as the tool's
damping, on the node's mean velocity of the step.
"""

from __future__ import annotations

from numba import njit

from ddf.contact.field import sample
from ddf.contact.tool import LONGEST_SLEEP
from ddf.jit import FAST

SHARE = 0.5
"""Of the tool's stiffness [N/mm3]."""

#: columns of what bears a node: spring force [N], its rate coefficient [N s/mm], normal (3), velocity before (3) [mm/s]
BED = 8


@njit(**FAST)
def find_borne(x, v, area, inverse, tool, origin, spacing, law, motion, reach, dt, sleep, borne, bed, low, high):
    """Find what bears the nodes of rows low..high-1, before they are kicked.

    x, v (3, n, m); area, inverse of the masses (n, m); law = (h [mm], K [N/mm3]); motion = (z, speed) of the tool's
    base; reach: way that a node can go in a step [mm]; sleep (n, m) int16; borne (n, m) bool and bed (n, m, BED) are
    set. Returns the energy stored and what is lost where contact begins or ends [N mm].
    """
    h, stiffness = law
    z, speed = motion
    stored = lost = 0.0
    for i in range(low, high):
        for j in range(x.shape[2]):
            borne[i, j] = False
            if sleep[i, j] > 0:
                sleep[i, j] -= 1
                continue
            if inverse[i, j] == 0.0:
                continue
            d, nx, ny, nz = sample(tool, origin, spacing, x[0, i, j], x[1, i, j], x[2, i, j] - z)
            near = d - h
            if near > reach:  # one that touched a step ago is no farther
                sleep[i, j] = min(LONGEST_SLEEP, int(near / reach) - 1)
                continue
            rate = nx * v[0, i, j] + ny * v[1, i, j] + nz * (v[2, i, j] - speed)
            k = stiffness * area[i, j]
            before, now = max(0.0, dt * rate - near), max(0.0, -near)
            spring, energy = k * now, 0.5 * k * now * now
            if max(before, now) > 0.0 and min(before, now) == 0.0:  # the mean force acts on all of the way
                lost -= 0.5 * k * (now + before) * dt * rate + energy - 0.5 * k * before * before
            if now > 0.0:
                stored += energy
                borne[i, j] = True
                bed[i, j, 0], bed[i, j, 1] = spring, dt * k
                bed[i, j, 2], bed[i, j, 3], bed[i, j, 4] = nx, ny, nz
                for c in range(3):
                    bed[i, j, 5 + c] = v[c, i, j]
    return stored, lost


@njit(**FAST)
def bear(v, f, inverse, borne, bed, motion, keep, dt, low, high):
    """Let the bed act on rows low..high-1 after all other impulses.

    v, f (3, n, m): F is added to f; keep: what mass damping left of the velocities before; bed[0] becomes F less the
    spring. Returns the power of F on the velocities before [N mm/s], the tool's work, and the half of what is lost that
    goes with these velocities [N mm].
    """
    speed = motion[1]
    power = work = lost = 0.0
    for i in range(low, high):
        for j in range(v.shape[2]):
            if not borne[i, j]:
                continue
            spring, c, nx, ny, nz = bed[i, j, 0], bed[i, j, 1], bed[i, j, 2], bed[i, j, 3], bed[i, j, 4]
            ahead = nx * v[0, i, j] + ny * v[1, i, j] + nz * (v[2, i, j] - speed)
            push = max(0.0, (spring - c * ahead) / (1.0 + dt * c * inverse[i, j]))
            for a, n in ((0, nx), (1, ny), (2, nz)):
                f[a, i, j] += push * n
                v[a, i, j] += dt * inverse[i, j] * push * n
            rate = nx * bed[i, j, 5] + ny * bed[i, j, 6] + nz * bed[i, j, 7]
            power += push * rate
            work += dt * push * nz * speed
            bed[i, j, 0] = push - spring
            lost -= 0.5 * dt * (push - spring) * (keep * rate - nz * speed)
    return power, work, lost


@njit(**FAST)
def lose(v, borne, bed, motion, dt, low, high):
    """The other half of what is lost, with the velocities at the step's end [N mm]."""
    lost = 0.0
    for i in range(low, high):
        for j in range(v.shape[2]):
            if borne[i, j]:
                rate = bed[i, j, 2] * v[0, i, j] + bed[i, j, 3] * v[1, i, j] + bed[i, j, 4] * (v[2, i, j] - motion[1])
                lost -= 0.5 * dt * bed[i, j, 0] * rate
    return lost
