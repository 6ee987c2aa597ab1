"""Pressure through the thickness acts in the plane of a sheet as well.

Sheets are mid-surfaces that touch at fixed distances, half their thicknesses. In such a stack a pressure p on the
outermost mid-surface arrives at the innermost one with the whole force, though that one, bent around the same
tool, is smaller: as if a tension p d ran through the layers between them, d apart (0.2 N/mm under vacuum, more
than wrinkles need to be suppressed). A solid pressed by p on its faces holds -p in its plane instead,

    N = -p t,   t = t0 A0 / A

with the layer's volume kept (rubber is incompressible; fabric in trellis shear keeps its volume of fibres). Half a
sheet's thickness lies between its mid-surface and each contact, so each contact of pressure p adds -p t/2 to the sheet
on either side. Nothing is added for the gas on the outer faces: it is applied to mid-surfaces, and what that neglects
cancels against -p t/2. With P the contact force on the cloth of a cell (each node's is shared out among the cells
around it by their cloth) the corners get

    f = P t0 A0 / (2 A^2) dA/dx,   A = |t1 x t2|,   t1, t2 the cell's mean tangents,   with g_ab = t_a . t_b
    dA/dt1 = (g22 t1 - g12 t2)/A,   dA/dt2 = (g11 t2 - g12 t1)/A

(forces and moments balance). A0 and A are those of the whole cell, also of one that an outline cuts: only P and the
width on which N acts go with its share of cloth. The power of these forces is what pressure would do on layers that
thin; mid-surfaces keep their distance in the model, so it is booked as work of its own.

On nodes that the frame holds it takes half of the force, three quarters in its corners. (With all of it the outermost
cells pushed those within, and where a rising platform pressed on sheets in its gap these were crushed: a random scene
stopped.)

P is the mean of the contact forces over some fifty steps (SHARE). As they are, the pair of a force in the plane that
follows the pressure and a pressure that does not follow the area flutters: a flat stack at 2 mm, clamped, gained 10 J.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.cells import MINUS, NEXT, ONE, PLUS, SHARES, TILE, WEIGHTLESS, add_shares, filled, tangents
from ddf.jit import FAST

SHARE = 0.02
"""Of a step's contact force in its running mean."""

LEAST_AREA = 0.25
"""Share of its first area below which a cell counts as no smaller: it is collapsing, which guards tell."""


# fields of `w`, the scratch of a tile: half of P t0 A0 / (2 A^3) times g11, g22, g12
Q11, Q22, Q12 = (np.uint64(k * TILE) for k in range(3))
SCRATCH = 3 * TILE + SHARES


@njit(**FAST)
def _pressed(press, i, start, count):
    """Whether anything presses on the nodes of a tile."""
    total = 0.0
    for t in range(count + ONE):
        total += press[i, start + t] + press[i + ONE, start + t]
    return total > 0.0


@njit(**FAST)
def _factors(x, v, cell, whole, press, inverse_area, half, i, start, count, w):
    """Set Q11, Q22, Q12 of a tile of cells; returns the power of their forces."""
    power = 0.0
    for t in range(count):
        j = start + t
        ax, bx = tangents(x, 0, i, j)
        ay, by = tangents(x, 1, i, j)
        az, bz = tangents(x, 2, i, j)
        g11, g22, g12 = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, ax * bx + ay * by + az * bz
        first = whole if whole > 0.0 else cell[i, j]
        area = max(np.sqrt(abs(g11 * g22 - g12 * g12)), LEAST_AREA * first) + 1e-30
        force = press[i, j] * inverse_area[i, j] + press[i, j + ONE] * inverse_area[i, j + ONE]
        force += press[i + ONE, j] * inverse_area[i + ONE, j]
        force += press[i + ONE, j + ONE] * inverse_area[i + ONE, j + ONE]
        q = 0.125 * cell[i, j] * force * half * first / (area * area * area)
        w[Q11 + t], w[Q22 + t], w[Q12 + t] = q * g11, q * g22, q * g12
        rx, sx = tangents(v, 0, i, j)
        ry, sy = tangents(v, 1, i, j)
        rz, sz = tangents(v, 2, i, j)
        along = g22 * (ax * rx + ay * ry + az * rz) + g11 * (bx * sx + by * sy + bz * sz)
        across = (ax * sx + ay * sy + az * sz) + (bx * rx + by * ry + bz * rz)
        power += 2.0 * q * (along - g12 * across)
    return power


@njit(**FAST)
def _push(x, i, start, count, w, g):
    """Shares of the corners, all components."""
    for t in range(count):
        j = start + t
        q11, q22, q12 = w[Q11 + t], w[Q22 + t], w[Q12 + t]
        o = t + ONE
        a, b = tangents(x, 0, i, j)
        g1, g2 = q22 * a - q12 * b, q11 * b - q12 * a
        g[PLUS + o], g[MINUS + o] = g1 + g2, g1 - g2
        o += NEXT
        a, b = tangents(x, 1, i, j)
        g1, g2 = q22 * a - q12 * b, q11 * b - q12 * a
        g[PLUS + o], g[MINUS + o] = g1 + g2, g1 - g2
        o += NEXT
        a, b = tangents(x, 2, i, j)
        g1, g2 = q22 * a - q12 * b, q11 * b - q12 * a
        g[PLUS + o], g[MINUS + o] = g1 + g2, g1 - g2


@njit(**FAST)
def squeeze_forces(x, v, f, cell, whole, press, inverse_area, thickness, low, high, work):
    """Add the in-plane forces of contact pressure to rows low..high-1 of f.

    x, v, f (3, n, m); cell (n, m) reference areas of the cloth in cells, whole that of a cell which is full of it, 0
    where all are [mm2]; press (n, m) mean contact force on each node [N]; inverse_area (n, m) one over a node's
    reference area [1/mm2]; thickness at the reference area [mm]; work: at least SCRATCH numbers, flat. Returns the
    power of the forces of the cells in rows low..high-1, on their nodes in all rows [N mm/s].
    """
    n, m = x.shape[1], x.shape[2]
    w, g = work[: 3 * TILE], work[3 * TILE : SCRATCH]
    power = 0.0
    for i in range(max(low - 1, 0), min(high, n - 1)):
        row = np.uint64(i)
        begin, end = filled(cell, i, WEIGHTLESS)
        for first in range(begin, min(end, m - 1), TILE):
            start, count = np.uint64(first), np.uint64(min(TILE, min(end, m - 1) - first))
            if not _pressed(press, row, start, count):
                continue
            done = _factors(x, v, cell, whole, press, inverse_area, 0.5 * thickness, row, start, count, w)
            if i >= low:
                power += done
            _push(x, row, start, count, w, g)
            add_shares(f, row, start, count, g, low, high)
    return power
