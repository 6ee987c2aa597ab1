"""Pin-jointed net (fishnet) on a surface: two generators, then every node from its three neighbours.

Yarns do not stretch and do not slip where they cross, so each node is where two spheres about its neighbours
(radii a1, a2: the lattice's spacing) and the surface meet (Mack and Taylor 1956, "The fitting of woven cloth to
surfaces"). Both generators are geodesics: from node to node a chord of the spacing in the plane of heading and
normal, the heading carried on by the rotation that turns the old normal to the new one.
"""

from __future__ import annotations

from math import cos, isnan, sin, sqrt

import numpy as np
from numba import njit

from ddf.kinematic.surface import cross, dot, meet_circle, normal, unit

#: states of a node: laid; not asked for; beyond a node that could not be laid; and why one could not be laid
LAID, UNUSED, BEYOND, SHEARED, OFF, FOLDED = range(6)


@njit(cache=True)
def lay_net(field, start, heading, spacing, i0, j0, needed, x, state):
    """Lay all nodes that are `needed` (n, m) and can be laid.

    field as in `surface`; start: point on the surface for node (i0, j0); heading: direction of family 1 there,
    family 2 starts at right angles to it; x (3, n, m) [mm], NaN where not laid; state (n, m) int8.
    """
    n, m = needed.shape
    x[:] = np.nan
    for i in range(n):
        for j in range(m):
            state[i, j] = BEYOND if needed[i, j] else UNUSED
    x[0, i0, j0], x[1, i0, j0], x[2, i0, j0] = start
    state[i0, j0] = LAID
    up = normal(field, start)
    first = _tangent(heading, up)
    second = cross(up, first)
    for sign in (-1, 1):
        _generator(field, start, (sign * first[0], sign * first[1], sign * first[2]), spacing[0], needed[:, j0],
                   i0, sign, x[:, :, j0], state[:, j0])  # fmt: skip
        _generator(field, start, (sign * second[0], sign * second[1], sign * second[2]), spacing[1], needed[i0],
                   j0, sign, x[:, i0], state[i0])  # fmt: skip
    for si in (-1, 1):
        for sj in (-1, 1):
            i = i0 + si
            while 0 <= i < n:
                j = j0 + sj
                while 0 <= j < m:
                    if needed[i, j]:
                        state[i, j] = _node(field, spacing, i, j, si, sj, x, state)
                    j += sj
                i += si


@njit(cache=True)
def _tangent(t, n):
    """Unit part of t square to n."""
    along = dot(t, n)
    return unit(t[0] - along * n[0], t[1] - along * n[1], t[2] - along * n[2])


@njit(cache=True)
def _turned(t, a, b):
    """Vector t (square to a) turned by the smallest rotation from unit a to unit b: t - (t.b)/(1 + a.b) (a + b)."""
    s = dot(t, b) / max(1.0 + dot(a, b), 1e-12)
    return _tangent((t[0] - s * (a[0] + b[0]), t[1] - s * (a[1] + b[1]), t[2] - s * (a[2] + b[2])), b)


@njit(cache=True)
def _generator(field, start, heading, step, needed, k0, sign, x, state):
    """Lay the nodes k0 + sign, k0 + 2 sign .. of a line x (3, k) along the geodesic from `start`."""
    p, t = start, heading
    up = normal(field, p)
    k = k0 + sign
    while 0 <= k < needed.size and needed[k]:
        angle = meet_circle(field, p, t, up, step)
        if isnan(angle):
            state[k] = OFF
            return
        c, s = step * cos(angle), step * sin(angle)
        p = (p[0] + c * t[0] + s * up[0], p[1] + c * t[1] + s * up[1], p[2] + c * t[2] + s * up[2])
        below = normal(field, p)
        t = _turned(t, up, below)
        up = below
        x[0, k], x[1, k], x[2, k] = p
        state[k] = LAID
        k += sign


@njit(cache=True)
def _at(x, i, j):
    return x[0, i, j], x[1, i, j], x[2, i, j]


@njit(cache=True)
def _node(field, spacing, i, j, si, sj, x, state):
    """Lay node (i, j) from its neighbours towards the start; returns its state."""
    if state[i - si, j] != LAID or state[i, j - sj] != LAID or state[i - si, j - sj] != LAID:
        return BEYOND
    a, b, c = _at(x, i - si, j), _at(x, i, j - sj), _at(x, i - si, j - sj)
    gap = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    size = sqrt(dot(gap, gap))
    if size >= spacing[0] + spacing[1] or size <= abs(spacing[0] - spacing[1]):
        return SHEARED
    axis = (gap[0] / size, gap[1] / size, gap[2] / size)
    along = (size * size + spacing[0] ** 2 - spacing[1] ** 2) / (2.0 * size)
    radius = sqrt(max(spacing[0] ** 2 - along * along, 0.0))
    centre = (a[0] + along * axis[0], a[1] + along * axis[1], a[2] + along * axis[2])
    out = _tangent((a[0] + b[0] - c[0] - centre[0], a[1] + b[1] - c[1] - centre[1], a[2] + b[2] - c[2] - centre[2]),
                   axis)  # fmt: skip
    side = cross(axis, out)
    angle = meet_circle(field, centre, out, side, radius)
    if isnan(angle):
        return OFF
    u, v = radius * cos(angle), radius * sin(angle)
    p = (
        centre[0] + u * out[0] + v * side[0],
        centre[1] + u * out[1] + v * side[1],
        centre[2] + u * out[2] + v * side[2],
    )
    if _turned_over(field, c, b, p, a, si * sj):
        return FOLDED
    x[0, i, j], x[1, i, j], x[2, i, j] = p
    return LAID


@njit(cache=True)
def _turned_over(field, c, b, p, a, sense):
    """Whether any corner of the cell c, b, p, a (family 1 from c to b) lies upside down on the surface."""
    for q, one, two in ((c, b, a), (b, p, c), (p, a, b), (a, c, p)):
        first = (one[0] - q[0], one[1] - q[1], one[2] - q[2])
        second = (two[0] - q[0], two[1] - q[1], two[2] - q[2])
        if sense * dot(cross(first, second), normal(field, q)) <= 0.0:
            return True
    return False
