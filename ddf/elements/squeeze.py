"""Pressure through the thickness acts in the plane of a sheet as well.

Sheets are mid-surfaces that touch at fixed distances, half their thicknesses. In such a stack a pressure p on the
outermost mid-surface arrives at the innermost one with the whole force, though that one, bent around the same
tool, is smaller: as if a tension p d ran through the layers between them, d apart (0.2 N/mm under vacuum, more
than wrinkles need to be suppressed). A solid pressed by p on its faces holds -p in its plane instead,

    N = -p t,   t = t0 A0 / A

with the layer's volume kept (rubber is incompressible; fabric in trellis shear keeps its volume of fibres). Half a
sheet's thickness lies between its mid-surface and each contact, so each contact of pressure p adds -p t/2 to the sheet
on either side. Nothing is added for the gas on the outer faces: it is applied to mid-surfaces, and what that neglects
cancels against -p t/2. With P the sum of the contact forces on a cell (a quarter of each node's)
the corners get

    f = P t0 A0 / (2 A^2) dA/dx,   dA = n . (dd1 x d2 + d1 x dd2) / 2,   d1, d2 the cell's diagonals

(forces and moments balance). The power of these forces is what pressure would do on layers that
thin; mid-surfaces keep their distance in the model, so it is booked as work of its own.

P is the mean of the contact forces over some fifty steps (SHARE). As they are, the pair of a force in the plane that
follows the pressure and a pressure that does not follow the area flutters: a flat stack at 2 mm, clamped, gained 10 J.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.tension import FAST

SHARE = 0.02
"""Of a step's contact force in its running mean."""

LEAST_AREA = 0.25
"""Share of its first area below which a cell counts as no smaller: it is collapsing, which guards tell."""


@njit(**FAST)
def _pressed(p, q):
    """Whether anything presses on two rows of nodes."""
    top = 0.0
    for j in range(p.shape[0]):
        top = max(top, p[j], q[j])
    return top > 0.0


@njit(**FAST)
def _diagonals(xa, xb, p, q):
    """Diagonals of a row of cells, one component; xa row i, xb row i+1."""
    for j in range(p.shape[0]):
        p[j] = xb[j + 1] - xa[j]
        q[j] = xa[j + 1] - xb[j]


@njit(**FAST)
def _scales(p, q, cell, press0, press1, half, normal, k):
    """Area vectors d1 x d2 of a row of cells, and the factors that make forces of them."""
    for j in range(k.shape[0]):
        a = p[1, j] * q[2, j] - p[2, j] * q[1, j]
        b = p[2, j] * q[0, j] - p[0, j] * q[2, j]
        c = p[0, j] * q[1, j] - p[1, j] * q[0, j]
        normal[0, j], normal[1, j], normal[2, j] = a, b, c
        area = max(0.5 * np.sqrt(a * a + b * b + c * c), LEAST_AREA * cell[j]) + 1e-30
        force = 0.25 * (press0[j] + press0[j + 1] + press1[j] + press1[j + 1])
        k[j] = 0.25 * force * half * cell[j] / (area * area * area)


@njit(**FAST)
def _corners(py, pz, qy, qz, ny, nz, k, u, w):
    """Forces along the first and the second diagonal, one component; y, z: the next two components."""
    for j in range(k.shape[0]):
        u[j] = k[j] * (qy[j] * nz[j] - qz[j] * ny[j])
        w[j] = k[j] * (ny[j] * pz[j] - nz[j] * py[j])


@njit(**FAST)
def _give(f, v, left, right, sign):
    """Add sign left[j] to node j of a row and -sign right[j] to node j+1, one component; returns their power."""
    power = 0.0
    for j in range(left.shape[0]):
        f[j] += sign * left[j]
        power += sign * left[j] * v[j]
    for j in range(right.shape[0]):
        f[j + 1] -= sign * right[j]
        power -= sign * right[j] * v[j + 1]
    return power


@njit(**FAST)
def squeeze_forces(x, v, f, cell, press, thickness, low, high, work):
    """Add the in-plane forces of contact pressure to rows low..high-1 of f; returns their power [N mm/s].

    x, v, f (3, n, m); cell (n, m) reference areas [mm2]; press (n, m) mean contact force on each node [N];
    thickness at the reference area [mm]; work (13, m).
    """
    n, m = x.shape[1], x.shape[2]
    c = m - 1
    p, q, normal, k = work[0:3, :c], work[3:6, :c], work[6:9, :c], work[9, :c]
    u, w = work[10, :c], work[11, :c]
    power = 0.0
    for i in range(max(low - 1, 0), min(high, n - 1)):
        if not _pressed(press[i], press[i + 1]):
            continue
        for a in range(3):
            _diagonals(x[a, i], x[a, i + 1], p[a], q[a])
        _scales(p, q, cell[i], press[i], press[i + 1], 0.5 * thickness, normal, k)
        for a in range(3):
            y, z = (a + 1) % 3, (a + 2) % 3
            _corners(p[y], p[z], q[y], q[z], normal[y], normal[z], k, u, w)
            if i >= low:
                power += _give(f[a, i], v[a, i], u, w, -1.0)
            if i + 1 < high:
                power += _give(f[a, i + 1], v[a, i + 1], w, u, -1.0)
    return power
