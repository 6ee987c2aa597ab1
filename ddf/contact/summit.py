"""Sharp vertices of the tool under the sheet: one contact point each, wherever the vertex meets the sheet.

The tool's other points are places of the sheet (nodes, middles of edges, centres of cells): an apex that is small
against the cells comes up between them, with faces of 70 degrees by 3 mm before any of them notices. So each sharp
vertex (summit) has a point of its own: half the sheet's thickness beyond it, S, where the mid-surface is to stay. It
has its closest place (u, v) on the smooth surface that other sheets touch too (`patch.py`), found from the last one by
Newton's method as in `layers.py`. With n the surface's normal there, away from the tool, and N_k the weights of the
surface's nodes,

    d = n.(x - S),  x = N_k x_k;        U = A/2 K <-d>^2 and so on, as at any other point (`tool_point.py`)

and, for x is closest to S, dU/dx_k = - A K <-d> N_k n. A is the area of a cell; there is no friction. The surface lies
inside a ridge of the nodes, by h^2 k/8, so that what is drawn over the vertex covers it. (Tried before: on the bilinear
cells, whose normals jump, a vertex in a kink was thrown to and fro by 0.2 mm a step; and the vertex itself at the
distance of half a thickness, where a surface drawn tight over it, with 120 N, has no well-defined closest place.)

One member of the team does all summits into `pushes`; each block then adds what belongs to its rows.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.patch import first_order, interpolate, weights
from ddf.contact.tool_point import (
    ANCHOR,
    DAMPED,
    FRICTION,
    GIVE,
    LATER,
    NEAR,
    NEXT,
    NORMAL,
    PLACE,
    PRESS,
    STIFF,
    TOUCHES,
    VELOCITY,
    press_points,
    set_vector,
)
from ddf.jit import FAST
from ddf.quad import part

SUMMIT = 6
"""Columns of a summit: S and the vertex's outward axis (tool frame) [mm]."""
SPOT = 5
"""Columns of a spot: u, v on the sheet's grid; anchor of its point."""
PUSH = 8 + PRESS
"""Columns of a push: row and column of the patch's centre (row -1: no contact), weights along rows, columns; push."""
ROUNDS = 4
"""Newton steps a time step. With one, as for layers, the push came a step late and drove a tight sheet to and fro."""
ASTRAY = 0.1  # a place that lacks more than this, in cells, after all rounds, is none
AWAY = 1.0e3  # distance of what is not met [mm]
ZERO = np.uint64(0)
GRAZING = 0.2  # cosine between axis and normal below which the sheet is not met but grazed


@njit(**FAST)
def _look(y, centre, spot, place):
    """From a spot on the surface to S: centre of the patch, normal, n.(x - S), and Newton step to the closest place."""
    n, m = centre.shape[0], centre.shape[1]
    i, j = min(max(int(spot[0] + 0.5), 0), n - 1), min(max(int(spot[1] + 0.5), 0), m - 1)
    p, q = np.int64(centre[i, j, 0]), np.int64(centre[i, j, 1])
    first, stride = np.uint64(4 * ((p - 1) * m + q - 1)), np.uint64(4 * m)
    at, su, sv, suu, svv = interpolate(y, first, stride, spot[0] - p, spot[1] - q)
    ux, uy, uz, vx, vy, vz = part(su, 0), part(su, 1), part(su, 2), part(sv, 0), part(sv, 1), part(sv, 2)
    rx, ry, rz = place[0] - part(at, 0), place[1] - part(at, 1), place[2] - part(at, 2)
    guu, gvv, guv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
    size = 1.0 / np.sqrt(max(guu * gvv - guv * guv, 1e-30))
    nx, ny, nz = (uy * vz - uz * vy) * size, (uz * vx - ux * vz) * size, (ux * vy - uy * vx) * size
    d = -(rx * nx + ry * ny + rz * nz)
    ru, rv = rx * ux + ry * uy + rz * uz, rx * vx + ry * vy + rz * vz
    auu = guu + abs(d * (nx * part(suu, 0) + ny * part(suu, 1) + nz * part(suu, 2)))
    avv = gvv + abs(d * (nx * part(svv, 0) + ny * part(svv, 1) + nz * part(svv, 2)))
    step = 1.0 / (auu * avv - guv * guv + 1e-30)
    return p, q, (nx, ny, nz), d, ((avv * ru - guv * rv) * step, (auu * rv - guv * ru) * step)


@njit(**FAST)
def summit_forces(y, rates, f, inverse, centre, dx, dy, law, motion, dt, summits, spots, pushes, out, w):
    """What all summits do to the sheet, into pushes (k, PUSH); returns the tool's work [N mm].

    y, rates (4 n m,): positions and velocities as quads; f (3, n, m), inverse (n, m): all other forces and of masses;
    centre (n, m, 2) from `patch_centres`; dx, dy reference cell sizes [mm]; summits (k, SUMMIT), spots (k, SPOT), which
    are updated; law, motion and out as in `tool.tool_forces`; w: scratch of a chunk of points.
    """
    _, stiffness, damping, _ = law
    z, speed = motion
    n, m = inverse.shape
    stride = np.uint64(4 * m)
    work = 0.0
    for t in range(summits.shape[0]):
        spot, push = spots[t], pushes[t]
        place = (summits[t, 0], summits[t, 1], summits[t, 2] + z)
        for _ in range(ROUNDS):
            du, dv = _look(y, centre, spot, place)[4]
            spot[0] = min(max(spot[0] + min(max(du, -0.5), 0.5), 0.0), n - 1.0)
            spot[1] = min(max(spot[1] + min(max(dv, -0.5), 0.5), 0.0), m - 1.0)
        p, q, normal, d, (du, dv) = _look(y, centre, spot, place)
        nx, ny, nz = normal
        cosine = nx * summits[t, 3] + ny * summits[t, 4] + nz * summits[t, 5]
        if cosine < 0.0:
            normal, cosine, d = (-nx, -ny, -nz), -cosine, -d
        if abs(du) > ASTRAY or abs(dv) > ASTRAY or cosine < GRAZING:
            d = AWAY
        first = np.uint64(4 * ((p - 1) * m + q - 1))
        a, b = weights(spot[0] - p), weights(spot[1] - q)
        v = first_order(rates, first, stride, spot[0] - p, spot[1] - q)[0]
        u = (part(v, 0), part(v, 1), part(v, 2) - speed)
        fx, fy, fz = u
        for k in range(3):
            for l in range(3):
                row, col = p - 1 + k, q - 1 + l
                h = dt * a[k] * b[l] * inverse[row, col]
                fx += h * f[0, row, col]
                fy += h * f[1, row, col]
                fz += h * f[2, row, col]
        area = dx[min(p, n - 2)] * dy[min(q, m - 2)]
        nx, ny, nz = normal
        set_vector(w, PLACE, ZERO, place[0], place[1], place[2])
        set_vector(w, VELOCITY, ZERO, u[0], u[1], u[2])
        set_vector(w, LATER, ZERO, fx, fy, fz)
        set_vector(w, NORMAL, ZERO, nx, ny, nz)
        set_vector(w, ANCHOR, ZERO, spot[2], spot[3], spot[4])
        # the point stays at the vertex: friction on a spring would see no slip
        w[NEAR], w[STIFF], w[DAMPED], w[FRICTION] = d, stiffness * area, damping * area, 0.0
        press_points(w, np.uint64(1), dt, out)
        for c in range(3):
            spot[2 + c] = w[ANCHOR + np.uint64(c) * NEXT]
        push[0] = -1.0
        if w[TOUCHES] > 0.0:
            push[0], push[1] = p, q
            for k in range(3):
                push[2 + k], push[5 + k] = a[k], b[k]
            for c in range(PRESS):
                push[8 + c] = w[GIVE + np.uint64(c) * NEXT]
            work += push[10] * speed * dt
    return work


@njit(**FAST)
def add_pushes(press, pressed, pushes, low, high):
    """Add all pushes to rows low..high-1 of press (n, m, PRESS)."""
    for t in range(pushes.shape[0]):
        push = pushes[t]
        p, q = int(push[0]), int(push[1])
        if p < 0:
            continue
        for row in range(max(low, p - 1), min(high, p + 2)):
            pressed[row] = True
            for l in range(3):
                weight = push[3 + row - p] * push[5 + l]
                for c in range(PRESS):
                    press[row, q - 1 + l, c] += weight * push[8 + c]
