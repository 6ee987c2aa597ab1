"""Fibre tension of the lattice ply: bars along both families, and their trapezoidal step.

A bar of reference length a and width w stores  U = 1/2 E h a w (ln lambda)^2,  lambda^2 = |d|^2 / a^2.
With q = lambda^2 - 1 its force is  w/(2a) E h [ln(1+q)/(1+q)] d;  the bracket is taken from its series
q (1 - 3/2 q + 11/6 q^2 - 25/12 q^3 + 137/60 q^4 - 49/20 q^5), exact to 4e-12 at 1 % of strain and 3e-5 at
10 %. Axial viscosity adds  z dt k (e.v) e,  k = E h w / a, e the bar's direction.

Only the fibres' waves need a small step (about 1/85 of everything else's), and nobody wants to see them. So
tension alone is integrated by the trapezoidal rule (Newmark, beta 1/4), linearised at x_n, while all other
forces stay explicit:

    (M + kappa K) (v_(n+1/2) - v_(n-1/2)) = dt F(x_n),   K = sum over bars k g g^T,   kappa = (1/4 + z/2) dt^2

with g = (-e, e) on a bar's two nodes. No mass is added to any motion that leaves the bars' lengths alone, and
there is no resonance between the steps of a multi-rate scheme. K = K1 + K2 is factored,
(M + kappa K1) M^-1 (M + kappa K2), the order alternating from step to step. Along a fibre line each factor is

    dv = y - M^-1 G t,   (1/(kappa k) + G^T M^-1 G) t = G^T y,   y = M^-1 dt F

a tridiagonal system for one number t a bar (Thomas' algorithm), run side by side for many lines.
"""

from __future__ import annotations

import numpy as np
from numba import njit

FAST = {"fastmath": True, "error_model": "numpy", "boundscheck": False, "cache": True, "nogil": True}

LINES = 16
"""Fibre lines that are solved side by side."""


@njit(**FAST)
def _bars(x0, y0, z0, x1, y1, z1, u0, v0, w0, u1, v1, w1, width, gx, gy, gz, inv_a2, ka, kc):
    """Forces (gx, gy, gz) of one row of bars on their first node; returns sum of width (d.dv)^2 / a^2."""
    lost = 0.0
    for j in range(width.shape[0]):
        dx = x1[j] - x0[j]
        dy = y1[j] - y0[j]
        dz = z1[j] - z0[j]
        q = (dx * dx + dy * dy + dz * dz) * inv_a2 - 1.0
        rate = (dx * (u1[j] - u0[j]) + dy * (v1[j] - v0[j]) + dz * (w1[j] - w0[j])) * inv_a2
        p = q * (1.0 + q * (-1.5 + q * (11 / 6 + q * (-25 / 12 + q * (137 / 60 - 49 / 20 * q)))))
        t = width[j] * (ka * p + kc * rate)
        lost += width[j] * rate * rate
        gx[j] = t * dx
        gy[j] = t * dy
        gz[j] = t * dz
    return lost


@njit(**FAST)
def _gather(f, right, along, before):
    """Add to a row of nodes, one component; `right` has a leading zero: entry j + 1 is the bar right of j."""
    for j in range(f.shape[0]):
        f[j] += along[j] - before[j] + right[j + 1] - right[j]


@njit(**FAST)
def tension_forces(x, v, f, bar1, bar2, sheet, damping, dt, low, high, work):
    """Add the forces of fibre tension and axial viscosity to rows low..high-1 of f.

    x, v, f (3, n, m); bar1, bar2 (n, m) widths [mm]; damping z of the head of this file; dt [s]; work
    (9, m + 2). Returns the energy that the viscosity of these rows' bars takes in a step [N mm].
    """
    n, m = x.shape[1], x.shape[2]
    c1, c2 = damping * dt * sheet.eh1 / sheet.a1, damping * dt * sheet.eh2 / sheet.a2
    work[:] = 0.0
    lost = 0.0
    for i in range(max(low - 1, 0), high):
        new, old = (3, 6) if i & 1 else (6, 3)
        if i < n - 1:
            part = _bars(
                x[0, i], x[1, i], x[2, i], x[0, i + 1], x[1, i + 1], x[2, i + 1],
                v[0, i], v[1, i], v[2, i], v[0, i + 1], v[1, i + 1], v[2, i + 1],
                bar1[i], work[new, :m], work[new + 1, :m], work[new + 2, :m],
                1 / sheet.a1**2, sheet.eh1 / (2 * sheet.a1), c1,
            )  # fmt: skip
            if i >= low:
                lost += part * c1 * sheet.a1**2
        else:
            work[new : new + 3] = 0.0
        if i < low:
            continue
        part = _bars(
            x[0, i, :-1], x[1, i, :-1], x[2, i, :-1], x[0, i, 1:], x[1, i, 1:], x[2, i, 1:],
            v[0, i, :-1], v[1, i, :-1], v[2, i, :-1], v[0, i, 1:], v[1, i, 1:], v[2, i, 1:],
            bar2[i, :-1], work[0, 1:m], work[1, 1:m], work[2, 1:m],
            1 / sheet.a2**2, sheet.eh2 / (2 * sheet.a2), c2,
        )  # fmt: skip
        lost += part * c2 * sheet.a2**2
        for c in range(3):
            _gather(f[c, i], work[c], work[new + c, :m], work[old + c, :m])
    return lost * dt


@njit(**FAST)
def _forward(xa, ya, za, xb, yb, zb, ua, va, wa, ub, vb, wb, ma, mb, width, k, ex, ey, ez, px, py, pz, s, ps, t, pt, c):
    """One bar of every line: direction e, pivot s, reduced right side t; c belongs to the bar before (p...)."""
    for j in range(width.shape[0]):
        dx = xb[j] - xa[j]
        dy = yb[j] - ya[j]
        dz = zb[j] - za[j]
        r = 1.0 / np.sqrt(dx * dx + dy * dy + dz * dz)
        dx *= r
        dy *= r
        dz *= r
        kappa = k * width[j]
        cosine = dx * px[j] + dy * py[j] + dz * pz[j]
        coupled = ma[j] * cosine
        before = ps[j] * coupled
        c[j] = before
        low = kappa * coupled
        right = kappa * (dx * (ub[j] - ua[j]) + dy * (vb[j] - va[j]) + dz * (wb[j] - wa[j]))
        inverse = 1.0 / (1.0 + kappa * (ma[j] + mb[j]) - low * before)
        t[j] = (right + low * pt[j]) * inverse
        s[j] = kappa * inverse
        ex[j] = dx
        ey[j] = dy
        ez[j] = dz


@njit(**FAST)
def _backward(ua, va, wa, ub, vb, wb, ma, mb, ex, ey, ez, t, c, last):
    """Solve for t from the bar after (last) and apply it to both nodes' velocity changes."""
    for j in range(t.shape[0]):
        p = t[j] + c[j] * last[j]
        last[j] = p
        ua[j] += ma[j] * p * ex[j]
        va[j] += ma[j] * p * ey[j]
        wa[j] += ma[j] * p * ez[j]
        ub[j] -= mb[j] * p * ex[j]
        vb[j] -= mb[j] * p * ey[j]
        wb[j] -= mb[j] * p * ez[j]


@njit(**FAST)
def solve_lines(x, y, inverse_mass, bar, k, a, b, work):
    """Apply (M + kappa K)^-1 M to y along the first grid direction, lines a..b-1, in place.

    x, y (3, n, m) positions [mm] and velocity changes [mm/s]; inverse_mass, bar (n, m); k = kappa E h / a
    [N s2/mm2 per mm of width], so that k bar is kappa times a bar's stiffness; work (6 (n + 1) + 2, LINES).
    """
    n, w = x.shape[1], b - a
    work[:6] = 0.0
    for i in range(n - 1):
        o, p = 6 * (i + 1), 6 * i  # rows of a bar: ex, ey, ez, s, t, c
        _forward(
            x[0, i, a:b], x[1, i, a:b], x[2, i, a:b], x[0, i + 1, a:b], x[1, i + 1, a:b], x[2, i + 1, a:b],
            y[0, i, a:b], y[1, i, a:b], y[2, i, a:b], y[0, i + 1, a:b], y[1, i + 1, a:b], y[2, i + 1, a:b],
            inverse_mass[i, a:b], inverse_mass[i + 1, a:b], bar[i, a:b], k,
            work[o, :w], work[o + 1, :w], work[o + 2, :w], work[p, :w], work[p + 1, :w], work[p + 2, :w],
            work[o + 3, :w], work[p + 3, :w], work[o + 4, :w], work[p + 4, :w], work[p + 5, :w],
        )  # fmt: skip
    last = work[6 * n, :w]
    last[:] = 0.0
    work[6 * (n - 1) + 5] = 0.0
    for i in range(n - 2, -1, -1):
        o = 6 * (i + 1)
        _backward(
            y[0, i, a:b], y[1, i, a:b], y[2, i, a:b], y[0, i + 1, a:b], y[1, i + 1, a:b], y[2, i + 1, a:b],
            inverse_mass[i, a:b], inverse_mass[i + 1, a:b],
            work[o, :w], work[o + 1, :w], work[o + 2, :w], work[o + 4, :w], work[o + 5, :w], last,
        )  # fmt: skip


@njit(**FAST)
def solve_rows(x, y, inverse_mass, bar, k, low, high, tile, work):
    """The same along the second grid direction for rows low..high-1, at most LINES of them.

    tile (8, m, LINES) holds the rows turned, so that the lines lie side by side; work as in `solve_lines`.
    """
    m, w = x.shape[2], high - low
    for r in range(w):
        for c in range(3):
            for j in range(m):
                tile[c, j, r] = x[c, low + r, j]
                tile[3 + c, j, r] = y[c, low + r, j]
        for j in range(m):
            tile[6, j, r] = inverse_mass[low + r, j]
            tile[7, j, r] = bar[low + r, j]
    solve_lines(tile[0:3], tile[3:6], tile[6], tile[7], k, 0, w, work)
    for r in range(w):
        for c in range(3):
            for j in range(m):
                y[c, low + r, j] = tile[3 + c, j, r]


def tension_energy(x: np.ndarray, bar1: np.ndarray, bar2: np.ndarray, sheet: np.void) -> tuple[float, float]:
    """Energy 1/2 E h a w (ln lambda)^2 of all bars of family 1 and 2 [N mm]; x (3, n, m), bars (n, m)."""
    total = []
    for axis, width, a, eh in ((1, bar1, sheet["a1"], sheet["eh1"]), (2, bar2, sheet["a2"], sheet["eh2"])):
        d = np.diff(x, axis=axis)
        log = 0.5 * np.log((d * d).sum(axis=0) / a**2)
        w = width[:-1, :] if axis == 1 else width[:, :-1]
        total.append(float(0.5 * eh * a * np.sum(w * log * log)))
    return total[0], total[1]
