"""Fibre tension of the lattice ply: bars along both families, advanced in small inner steps.

A bar of reference length a and width w stores  U = 1/2 E h a w (ln lambda)^2,  lambda^2 = |d|^2 / a^2.
With q = lambda^2 - 1 the force is  w/(2a) E h [ln(1+q)/(1+q)] d;  the bracket is taken from its series
q (1 - 3/2 q + 11/6 q^2 - 25/12 q^3 + 137/60 q^4 - 49/20 q^5), exact to 4e-12 at 1 % of strain and 3e-5 at
10 %. Axial viscosity adds w eta/(2a) dq/dt d, which dissipates w eta a/4 (dq/dt)^2.

The inner steps run as a wavefront: row i takes step s as soon as row i+1 has taken step s-1, so that a few
rows stay in the cache for all inner steps. A tile of rows carries a halo of one row an inner step, and so
needs nothing from its neighbours while it runs.
"""

from __future__ import annotations

import numpy as np
from numba import njit

FAST = {"fastmath": True, "error_model": "numpy", "boundscheck": False, "cache": True, "nogil": True}


@njit(**FAST)
def _bars(x0, y0, z0, x1, y1, z1, width, old, gx, gy, gz, inv_a2, ka, kc):
    """Forces (gx, gy, gz) of one row of bars on their first node; returns sum w (dq)^2."""
    lost = 0.0
    for j in range(width.shape[0]):
        dx = x1[j] - x0[j]
        dy = y1[j] - y0[j]
        dz = z1[j] - z0[j]
        q = (dx * dx + dy * dy + dz * dz) * inv_a2 - 1.0
        dq = q - old[j]
        old[j] = q
        p = q * (1.0 + q * (-1.5 + q * (11 / 6 + q * (-25 / 12 + q * (137 / 60 - 49 / 20 * q)))))
        t = width[j] * (ka * p + kc * dq)
        lost += width[j] * dq * dq
        gx[j] = t * dx
        gy[j] = t * dy
        gz[j] = t * dz
    return lost


@njit(**FAST)
def _move(x, v, inv_mass, right, along, before, dt):
    """Kick and drift of one component of a row; `right` has a leading and a trailing zero."""
    for j in range(x.shape[0]):
        v[j] += dt * inv_mass[j] * (along[j] - before[j] + right[j + 1] - right[j])
        x[j] += dt * v[j]


@njit(**FAST)
def _row_step(x, v, bar1, bar2, inv_mass, green1, green2, i, j0, j1, last, before, right, along, k, dt):
    """One inner step of row i; k = (1/a1^2, 1/a2^2, ka1, ka2, kc1, kc2) as the kernel wants them."""
    lost2 = _bars(
        x[0, i, j0 : j1 - 1], x[1, i, j0 : j1 - 1], x[2, i, j0 : j1 - 1],
        x[0, i, j0 + 1 : j1], x[1, i, j0 + 1 : j1], x[2, i, j0 + 1 : j1],
        bar2[i, j0 : j1 - 1], green2[i, j0 : j1 - 1],
        right[0, j0 + 1 : j1], right[1, j0 + 1 : j1], right[2, j0 + 1 : j1], k[1], k[3], k[5],
    )  # fmt: skip
    for c in range(3):
        right[c, j0] = 0.0
        right[c, j1] = 0.0
    lost1 = 0.0
    if last or j0 > 0 or j1 < x.shape[2]:
        along[:] = 0.0
    if not last:
        lost1 = _bars(
            x[0, i, j0:j1], x[1, i, j0:j1], x[2, i, j0:j1],
            x[0, i + 1, j0:j1], x[1, i + 1, j0:j1], x[2, i + 1, j0:j1],
            bar1[i, j0:j1], green1[i, j0:j1],
            along[0, j0:j1], along[1, j0:j1], along[2, j0:j1], k[0], k[2], k[4],
        )  # fmt: skip
    for c in range(3):
        _move(
            x[c, i, j0:j1], v[c, i, j0:j1], inv_mass[i, j0:j1],
            right[c, j0 : j1 + 1], along[c, j0:j1], before[c, j0:j1], dt,
        )  # fmt: skip
    return lost1 * k[6], lost2 * k[7]


@njit(**FAST)
def inner_steps(x, v, bar1, bar2, inv_mass, green1, green2, span, sheet, tile, steps, dt, work):
    """Advance rows of a tile by `steps` inner steps of `dt` [s] of fibre tension and drift, in place.

    Shapes: x, v (3, r, m); bar1, bar2, inv_mass, green1, green2 (r, m); span (r, 2): nodes that exist.
    tile = (low, high, top, bottom): rows low..high-1 are wanted; top (bottom) is true if row 0 (r-1) is the
    sheet's own edge. Other rows are the halo: row i is advanced while its neighbours are still known.
    work (2 steps + 2, 3, m + 2) is scratch. Returns the energy lost to axial viscosity in the wanted rows
    [N mm].
    """
    low, high, top, bottom = tile
    r = x.shape[1]
    a1, a2 = sheet.a1, sheet.a2
    c1 = sheet.viscosity1 / (2.0 * a1 * dt)
    c2 = sheet.viscosity2 / (2.0 * a2 * dt)
    k = (
        1 / a1**2, 1 / a2**2, sheet.eh1 / (2 * a1), sheet.eh2 / (2 * a2), c1, c2,
        0.5 * c1 * a1 * a1, 0.5 * c2 * a2 * a2,
    )  # fmt: skip
    work[:] = 0.0
    lost = 0.0
    for front in range(r + steps):
        for s in range(steps):
            i = front - s
            first = 0 if top else low - (steps - 1 - s)
            end = r if bottom else high + (steps - 1 - s)
            if i < first - 1 or i >= end or i < 0:
                continue
            j0, j1 = span[i, 0], span[i, 1]
            before = work[2 + 2 * s + (i & 1)]
            along = work[3 + 2 * s - (i & 1)]
            if i == first - 1:  # only the force on the first row that moves
                _bars(
                    x[0, i], x[1, i], x[2, i], x[0, i + 1], x[1, i + 1], x[2, i + 1],
                    bar1[i], green1[i], along[0, : x.shape[2]], along[1, : x.shape[2]],
                    along[2, : x.shape[2]], k[0], k[2], k[4],
                )  # fmt: skip
                continue
            if j1 - j0 < 1:
                along[:] = 0.0
                continue
            b1, b2 = _row_step(
                x, v, bar1, bar2, inv_mass, green1, green2, i, j0, j1, i == r - 1, before, work[0], along, k, dt
            )
            if low <= i < high:
                lost += b1 + b2
    return lost


def tension_energy(x: np.ndarray, bar1: np.ndarray, bar2: np.ndarray, sheet: np.void) -> tuple[float, float]:
    """Energy 1/2 E h a w (ln lambda)^2 of all bars of family 1 and 2 [N mm]; x (3, n, m), bars (n, m)."""
    total = []
    for axis, width, a, eh in ((1, bar1, sheet["a1"], sheet["eh1"]), (2, bar2, sheet["a2"], sheet["eh2"])):
        d = np.diff(x, axis=axis)
        log = 0.5 * np.log((d * d).sum(axis=0) / a**2)
        w = width[:-1, :] if axis == 1 else width[:, :-1]
        total.append(float(0.5 * eh * a * np.sum(w * log * log)))
    return total[0], total[1]
