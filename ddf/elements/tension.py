"""Fibre tension of the lattice ply: bars along both families, integrated implicitly along each fibre line.

A bar of reference length a and width w stores  U = 1/2 E h a w (ln lambda)^2,  lambda = |d|/a. Its tension is
T = E h w ln(lambda)/lambda, along its direction e. With q = lambda^2 - 1, ln(1+q)/(1+q) is taken from its
series q (1 - 3/2 q + 11/6 q^2 - 25/12 q^3 + 137/60 q^4 - 49/20 q^5): right to 2e-10 of itself at 1 % of
strain and 2e-4 at 10 %.

Only the fibres' waves need a small step (about 1/85 of everything else's), and nobody wants to see them. So
tension alone takes a backward Euler step, linearised at x_n, one family after the other:

    T' = T_n + k dt g.v',    M v' = M v - dt sum g T',    k = E h w / a

with g = (-e, e) on a bar's two nodes. Along a fibre line that is a tridiagonal system for one impulse p = dt T'
a bar, solved directly (Thomas' algorithm) and side by side for many lines:

    p (1 + kappa (w_a + w_b)) - kappa (w_a cos p_before + w_b cos p_after) = kappa g.v + dt T_n,  kappa = k dt^2

w_a, w_b inverse masses of the bar's nodes, cos the cosines to the neighbouring bars. With P the product of
both families' contractions (M + dt^2 K)^-1 M, the linear scheme maps (X, Y = X + dt v) to (P Y, 2 P Y - X):
its eigenvalues have the modulus sqrt(p), p in (0, 1] those of P, for any step, stiffness and angle between
the families. Waves lose 1 - p of their energy a step: the numerical dissipation, which the ledger states.
No mass is added to any motion that leaves the bars' lengths alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

FAST: dict[str, Any] = {"fastmath": True, "error_model": "numpy", "boundscheck": False, "cache": True, "nogil": True}

LINES = 16
"""Fibre lines that are solved side by side."""


@njit(**FAST)
def _forward(
    xa, ya, za, xb, yb, zb, ua, va, wa, ub, vb, wb, ma, mb, width, law, ex, ey, ez, px, py, pz, s, ps, t, pt, c
):
    """One bar of every line: direction e, pivot s, reduced right side t; c belongs to the bar before (p...).

    law = (1/a, dt^2 E h / a, dt E h / 2).
    """
    inverse_a, stiff, pull = law
    for j in range(width.shape[0]):
        dx = xb[j] - xa[j]
        dy = yb[j] - ya[j]
        dz = zb[j] - za[j]
        square = dx * dx + dy * dy + dz * dz
        r = 1.0 / np.sqrt(square)
        dx *= r
        dy *= r
        dz *= r
        q = square * inverse_a * inverse_a - 1.0
        log = q * (1.0 + q * (-1.5 + q * (11 / 6 + q * (-25 / 12 + q * (137 / 60 - 49 / 20 * q)))))
        tension = pull * width[j] * log * square * r * inverse_a
        kappa = stiff * width[j]
        cosine = dx * px[j] + dy * py[j] + dz * pz[j]
        coupled = ma[j] * cosine
        before = ps[j] * coupled
        c[j] = before
        low = kappa * coupled
        right = kappa * (dx * (ub[j] - ua[j]) + dy * (vb[j] - va[j]) + dz * (wb[j] - wa[j])) + tension
        inverse = 1.0 / (1.0 + kappa * (ma[j] + mb[j]) - low * before)
        t[j] = (right + low * pt[j]) * inverse
        s[j] = kappa * inverse
        ex[j] = dx
        ey[j] = dy
        ez[j] = dz


@njit(**FAST)
def _backward(ua, va, wa, ub, vb, wb, ma, mb, ex, ey, ez, t, c, last):
    """Impulse of each bar from that of the bar after it (last), applied to both nodes' velocities."""
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
def pull_lines(x, v, inverse_mass, bar, law, a, b, work):
    """Implicit step of the tension along the first grid direction, lines a..b-1; v is changed in place.

    x, v (3, n, m) [mm], [mm/s]; inverse_mass [1/tonne], bar (n, m) widths [mm]; law = (1/a, dt^2 E h / a,
    dt E h / 2) in mm, s, N; work (6 (n + 1) + 2, LINES).
    """
    n, w = x.shape[1], b - a
    work[:6] = 0.0
    for i in range(n - 1):
        o, p = 6 * (i + 1), 6 * i  # rows of a bar: ex, ey, ez, s, t, c
        _forward(
            x[0, i, a:b], x[1, i, a:b], x[2, i, a:b], x[0, i + 1, a:b], x[1, i + 1, a:b], x[2, i + 1, a:b],
            v[0, i, a:b], v[1, i, a:b], v[2, i, a:b], v[0, i + 1, a:b], v[1, i + 1, a:b], v[2, i + 1, a:b],
            inverse_mass[i, a:b], inverse_mass[i + 1, a:b], bar[i, a:b], law,
            work[o, :w], work[o + 1, :w], work[o + 2, :w], work[p, :w], work[p + 1, :w], work[p + 2, :w],
            work[o + 3, :w], work[p + 3, :w], work[o + 4, :w], work[p + 4, :w], work[p + 5, :w],
        )  # fmt: skip
    last = work[6 * n, :w]
    last[:] = 0.0
    work[6 * (n - 1) + 5] = 0.0
    for i in range(n - 2, -1, -1):
        o = 6 * (i + 1)
        _backward(
            v[0, i, a:b], v[1, i, a:b], v[2, i, a:b], v[0, i + 1, a:b], v[1, i + 1, a:b], v[2, i + 1, a:b],
            inverse_mass[i, a:b], inverse_mass[i + 1, a:b],
            work[o, :w], work[o + 1, :w], work[o + 2, :w], work[o + 4, :w], work[o + 5, :w], last,
        )  # fmt: skip


@njit(**FAST)
def pull_rows(x, v, inverse_mass, bar, law, low, high, tile, work):
    """The same along the second grid direction for rows low..high-1, at most LINES of them.

    tile (8, m, LINES) holds the rows turned, so that the lines lie side by side; work as in `pull_lines`.
    """
    m, w = x.shape[2], high - low
    for r in range(w):
        for c in range(3):
            for j in range(m):
                tile[c, j, r] = x[c, low + r, j]
                tile[3 + c, j, r] = v[c, low + r, j]
        for j in range(m):
            tile[6, j, r] = inverse_mass[low + r, j]
            tile[7, j, r] = bar[low + r, j]
    pull_lines(tile[0:3], tile[3:6], tile[6], tile[7], law, 0, w, work)
    for r in range(w):
        for c in range(3):
            for j in range(m):
                v[c, low + r, j] = tile[3 + c, j, r]


def tension_energy(x: np.ndarray, bar1: np.ndarray, bar2: np.ndarray, sheet: np.void) -> tuple[float, float]:
    """Energy 1/2 E h a w (ln lambda)^2 of all bars of family 1 and 2 [N mm]; x (3, n, m), bars (n, m)."""
    total = []
    for axis, width, a, eh in ((1, bar1, sheet["a1"], sheet["eh1"]), (2, bar2, sheet["a2"], sheet["eh2"])):
        d = np.diff(x, axis=axis)
        log = 0.5 * np.log((d * d).sum(axis=0) / a**2)
        w = width[:-1, :] if axis == 1 else width[:, :-1]
        total.append(float(0.5 * eh * a * np.sum(w * log * log)))
    return total[0], total[1]
