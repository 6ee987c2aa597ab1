"""Fibre tension of the lattice ply: bars along both families, integrated implicitly along each fibre line.

A bar of reference length a and width w stores  U = 1/2 E h a w (ln lambda)^2,  lambda = |d|/a. Its tension is
T = E h w ln(lambda)/lambda, along its direction e. With q = lambda^2 - 1, ln(1+q)/(1+q) is taken from its
series q (1 - 3/2 q + 11/6 q^2 - 25/12 q^3 + 137/60 q^4 - 49/20 q^5): right to 2e-10 of itself at 1 % of
strain and 2e-4 at 10 %.

Only the fibres' waves need a small step (about 1/85 of everything else's), and nobody wants to see them. So
tension alone takes a backward Euler step, linearised at x_n:

    T' = T_n + k dt g.v',    M v' = M v - dt sum g T',    k = E h w / a

with g = (-e, e) on a bar's two nodes. Given the other family's tensions, that is along a fibre line a tridiagonal
system for one impulse p = dt T' a bar, solved directly (Thomas' algorithm), side by side for many lines:

    p (1 + kappa (w_a + w_b)) - kappa (w_a cos p_before + w_b cos p_after) = kappa g.v + dt T_n,  kappa = k dt^2

w_a, w_b inverse masses of the bar's nodes, cos the cosines to the neighbouring bars, v without p. The families are
coupled where they are not square (a sheared or folded ply). Taken one after the other once, from nothing, they
settle on a wrong state: strains of some 0.1 % in sheared, some % in folded plies, other ones for each order, so that
a ply at rest went to and fro for good (measured: 750 mm/s). So the tensions of the last step are kept in the state,
these are applied first, and each family is corrected twice in turn, 1 2 1 2 and in the next step 2 1 2 1
(block Gauss-Seidel): with v as it stands, the same system gives the correction of p for the right side
kappa g.v + dt T_n - p. A ply at rest stays at rest, whatever its shape. (Applying only 98 % of the kept tensions, to
damp the scheme, cost 0.6 % of strain where families run nearly alike: what two tensions that cancel lose moves no node,
and only stretch can give it back.) For two bars at 15 degrees or more to each other the spectral radius of this scheme
is below 1 (in the tests; one sweep, or two in the same order every step, are unstable beyond 40 and 55 degrees from
square). A viscous part, T' = T_n + c k dt g.v', was tried with c of 1.2 to 12: what is kept then is not the tension
of the next step, and the energy of a sheared ply that is let go is multiplied, by up to 20. Waves lose energy to the
scheme: the numerical dissipation, which the ledger states. No mass is added to any motion that leaves the bars' lengths
alone.

Across itself a tensioned line is a string of stiffness T'/a. Left explicit, it would limit the step by the largest
tension anywhere. So each line takes one more backward Euler step, of that stiffness alone and in all directions:

    (1 + w_i (s_(i-1) + s_i)) v_i - w_i s_(i-1) v_(i-1) - w_i s_i v_(i+1) = v*_i,    s = dt max(p, 0) / a

after the family's last correction: a contraction. It resists the axial rates too, by T/(E h) of
what the bars themselves do. Its impulses are not along the bars: where T varies along a line, angular momentum is
lost at the rate dt T/(m R^2) for motions of size R (a few per cent a second in a formed ply; linear momentum is kept).

In a half model (`dynamics.mirror`) lines that meet the mirror plane squarely end there, at nodes that move within it
only: w becomes w (1 - (e.n)^2) in the pivot, and what acts on them along n is left out. Their inverse masses come with
a minus sign. Where a line ends there at its last node the string's step takes it for free, which only makes its damping
smaller.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import FAST

LINES = 16
"""Fibre lines that are solved side by side."""


@njit(**FAST)
def _forward(
    xa, ya, za, xb, yb, zb, ua, va, wa, ub, vb, wb, ma, mb, width, kept, law, ex, ey, ez, px, py, pz, s, ps, t, pt, c
):
    """One bar of every line: direction e, pivot s, reduced right side t; c belongs to the bar before (p...).

    law = (1/a, dt^2 E h / a, dt E h / 2, dt); y is normal to the mirror plane, if there is one.
    """
    inverse_a, stiff, pull, dt = law
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
        coupled = abs(ma[j]) * cosine
        before = ps[j] * coupled
        c[j] = before
        low = kappa * coupled
        strain = dx * (ub[j] - ua[j]) + dy * (vb[j] - va[j]) + dz * (wb[j] - wa[j])
        right = kappa * strain + tension - dt * kept[j]
        along = 1.0 - dy * dy
        free = (ma[j] if ma[j] >= 0.0 else -ma[j] * along) + (mb[j] if mb[j] >= 0.0 else -mb[j] * along)
        inverse = 1.0 / (1.0 + kappa * free - low * before)
        t[j] = (right + low * pt[j]) * inverse
        s[j] = kappa * inverse
        ex[j] = dx
        ey[j] = dy
        ez[j] = dz


@njit(**FAST)
def _correct(ua, va, wa, ub, vb, wb, ma, mb, ex, ey, ez, t, c, last, kept, per_dt):
    """Correction of each bar's impulse from that of the bar after it (last), applied to both nodes' velocities."""
    for j in range(t.shape[0]):
        p = t[j] + c[j] * last[j]
        last[j] = p
        kept[j] += per_dt * p
        pa, pb = abs(ma[j]) * p, abs(mb[j]) * p
        ua[j] += pa * ex[j]
        va[j] += max(ma[j], 0.0) * p * ey[j]
        wa[j] += pa * ez[j]
        ub[j] -= pb * ex[j]
        vb[j] -= max(mb[j], 0.0) * p * ey[j]
        wb[j] -= pb * ez[j]


@njit(**FAST)
def _correct_string(
    ua, va, wa, ub, vb, wb, uc, vc, wc, ma, mb, ex, ey, ez, t, c, last, kept, per_dt, g, g_after, s_after, scale
):
    """The same; then node b is final for the axial part, and the string's system is reduced by it: v_b += g v_a.

    g and string stiffness s_after of the bar after it, (uc, vc, wc) the reduced velocity of the node after it.
    """
    for j in range(t.shape[0]):
        p = t[j] + c[j] * last[j]
        last[j] = p
        tension = kept[j] + per_dt * p
        kept[j] = tension
        pa, pb = abs(ma[j]) * p, abs(mb[j]) * p
        ua[j] += pa * ex[j]
        va[j] += max(ma[j], 0.0) * p * ey[j]
        wa[j] += pa * ez[j]
        s = max(tension, 0.0) * scale
        after = abs(mb[j]) * s_after[j]
        inverse = 1.0 / (1.0 + abs(mb[j]) * s + after * (1.0 - g_after[j]))
        ub[j] = (ub[j] - pb * ex[j] + after * uc[j]) * inverse
        vb[j] = (vb[j] - pb * ey[j] + after * vc[j]) * inverse if mb[j] >= 0.0 else 0.0
        wb[j] = (wb[j] - pb * ez[j] + after * wc[j]) * inverse
        g[j] = abs(mb[j]) * s * inverse
        s_after[j] = s


@njit(**FAST)
def _first_node(u, v, w, u1, v1, w1, mass, s, g):
    """Reduce the string's system by a line's first node: it is final then."""
    for j in range(u.shape[0]):
        k = abs(mass[j]) * s[j]
        inverse = 1.0 / (1.0 + k * (1.0 - g[j]))
        u[j] = (u[j] + k * u1[j]) * inverse
        v[j] = (v[j] + k * v1[j]) * inverse if mass[j] >= 0.0 else 0.0
        w[j] = (w[j] + k * w1[j]) * inverse


@njit(**FAST)
def _substitute(ua, va, wa, ub, vb, wb, mb, g):
    """Velocity of the next node of each line, given that of the one before."""
    for j in range(g.shape[0]):
        ub[j] += g[j] * ua[j]
        vb[j] += g[j] * va[j] if mb[j] >= 0.0 else 0.0
        wb[j] += g[j] * wa[j]


@njit(**FAST)
def pull_lines(x, v, inverse_mass, bar, kept, law, string, mirror, a, b, work):
    """Correct the tension along the first grid direction, lines a..b-1; v and kept are changed in place.

    x, v (3, n, m) [mm], [mm/s]; inverse_mass [1/tonne], below 0 on the mirror plane, which is normal to component
    `mirror` (if any); bar (n, m) widths [mm]; kept (n, m) tensions [N], which are
    in v; law = (1/a, dt^2 E h / a, dt E h / 2, dt^2 / a, dt) in mm, s, N; string: whether to take the
    string's step as well; work (6 (n + 1) + 2, LINES).
    """
    # the kernels above take the component normal to the mirror plane as the second one
    r, q, s = (1, 0, 2) if mirror == 0 else (0, 1, 2)
    n, w = x.shape[1], b - a
    per_dt = 1.0 / law[4]
    ahead = (law[0], law[1], law[2], law[4])
    work[:6] = 0.0
    for i in range(n - 1):
        o, p = 6 * (i + 1), 6 * i  # rows of a bar: ex, ey, ez, s, t, c
        _forward(
            x[r, i, a:b], x[q, i, a:b], x[s, i, a:b], x[r, i + 1, a:b], x[q, i + 1, a:b], x[s, i + 1, a:b],
            v[r, i, a:b], v[q, i, a:b], v[s, i, a:b], v[r, i + 1, a:b], v[q, i + 1, a:b], v[s, i + 1, a:b],
            inverse_mass[i, a:b], inverse_mass[i + 1, a:b], bar[i, a:b], kept[i, a:b], ahead,
            work[o, :w], work[o + 1, :w], work[o + 2, :w], work[p, :w], work[p + 1, :w], work[p + 2, :w],
            work[o + 3, :w], work[p + 3, :w], work[o + 4, :w], work[p + 4, :w], work[p + 5, :w],
        )  # fmt: skip
    work[6 * (n - 1) + 5] = 0.0
    work[6 * n : 6 * n + 4] = 0.0
    last, stiff = work[6 * n, :w], work[6 * n + 1, :w]
    if not string:
        for i in range(n - 2, -1, -1):
            o = 6 * (i + 1)
            _correct(
                v[r, i, a:b], v[q, i, a:b], v[s, i, a:b], v[r, i + 1, a:b], v[q, i + 1, a:b], v[s, i + 1, a:b],
                inverse_mass[i, a:b], inverse_mass[i + 1, a:b], work[o, :w], work[o + 1, :w], work[o + 2, :w],
                work[o + 4, :w], work[o + 5, :w], last, kept[i, a:b], per_dt,
            )  # fmt: skip
        return
    for i in range(n - 2, -1, -1):
        o, k = 6 * (i + 1), min(i + 2, n - 1)  # the last node has none after it, and no string stiffness there
        _correct_string(
            v[r, i, a:b], v[q, i, a:b], v[s, i, a:b], v[r, i + 1, a:b], v[q, i + 1, a:b], v[s, i + 1, a:b],
            v[r, k, a:b], v[q, k, a:b], v[s, k, a:b], inverse_mass[i, a:b], inverse_mass[i + 1, a:b],
            work[o, :w], work[o + 1, :w], work[o + 2, :w], work[o + 4, :w], work[o + 5, :w], last,
            kept[i, a:b], per_dt, work[o + 3, :w], work[o + 9, :w], stiff, law[3],
        )  # fmt: skip
    _first_node(
        v[r, 0, a:b], v[q, 0, a:b], v[s, 0, a:b], v[r, 1, a:b], v[q, 1, a:b], v[s, 1, a:b],
        inverse_mass[0, a:b], stiff, work[9, :w],
    )  # fmt: skip
    for i in range(n - 1):
        _substitute(
            v[r, i, a:b], v[q, i, a:b], v[s, i, a:b], v[r, i + 1, a:b], v[q, i + 1, a:b], v[s, i + 1, a:b],
            inverse_mass[i + 1, a:b], work[6 * i + 9, :w],
        )  # fmt: skip


@njit(**FAST)
def pull_rows(x, v, inverse_mass, bar, kept, law, string, mirror, low, high, tile, work):
    """The same along the second grid direction for rows low..high-1, at most LINES of them.

    tile (9, m, LINES) holds the rows turned, so that the lines lie side by side; work as in `pull_lines`.
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
            tile[8, j, r] = kept[low + r, j]
    pull_lines(tile[0:3], tile[3:6], tile[6], tile[7], tile[8], law, string, mirror, 0, w, work)
    for r in range(w):
        for c in range(3):
            for j in range(m):
                v[c, low + r, j] = tile[3 + c, j, r]
        for j in range(m):
            kept[low + r, j] = tile[8, j, r]


@njit(**FAST)
def _bar_row(xa, ya, za, xb, yb, zb, kept, qx, qy, qz):
    """Force of each bar's tension on its node a."""
    for j in range(kept.shape[0]):
        dx, dy, dz = xb[j] - xa[j], yb[j] - ya[j], zb[j] - za[j]
        s = kept[j] / np.sqrt(dx * dx + dy * dy + dz * dz)
        qx[j], qy[j], qz[j] = s * dx, s * dy, s * dz


@njit(**FAST)
def _add_row(v, q, factor, inverse_mass):
    """V <- v + factor q / m."""
    for j in range(q.shape[0]):
        v[j] += factor * abs(inverse_mass[j]) * q[j]


@njit(**FAST)
def pull_kept(x, v, inverse_mass, kept1, kept2, impulse, i, q):
    """Apply `impulse` [s] times the kept tensions [N] of both families to the velocities of row i; q (3, m) scratch."""
    n, m = kept1.shape
    for k, sign in ((i, impulse), (i - 1, -impulse)):
        if k < 0 or k + 1 >= n:
            continue
        _bar_row(
            x[0, k], x[1, k], x[2, k], x[0, k + 1], x[1, k + 1], x[2, k + 1], kept1[k], q[0, :m], q[1, :m], q[2, :m]
        )
        for c in range(3):
            _add_row(v[c, i], q[c, :m], sign, inverse_mass[i])
    y = x[:, i]
    _bar_row(
        y[0, : m - 1], y[1, : m - 1], y[2, : m - 1], y[0, 1:], y[1, 1:], y[2, 1:], kept2[i, : m - 1],
        q[0, : m - 1], q[1, : m - 1], q[2, : m - 1],
    )  # fmt: skip
    for c in range(3):
        _add_row(v[c, i, : m - 1], q[c, : m - 1], impulse, inverse_mass[i, : m - 1])
        _add_row(v[c, i, 1:], q[c, : m - 1], -impulse, inverse_mass[i, 1:])


def tension_energy(x: np.ndarray, bar1: np.ndarray, bar2: np.ndarray, sheet: np.void) -> tuple[float, float]:
    """Energy 1/2 E h a w (ln lambda)^2 of all bars of family 1 and 2 [N mm]; x (3, n, m), bars (n, m)."""
    total = []
    for axis, width, a, eh in ((1, bar1, sheet["a1"], sheet["eh1"]), (2, bar2, sheet["a2"], sheet["eh2"])):
        d = np.diff(x, axis=axis)
        log = 0.5 * np.log((d * d).sum(axis=0) / a**2)
        w = width[:-1, :] if axis == 1 else width[:, :-1]
        total.append(float(0.5 * eh * a * np.sum(w * log * log)))
    return total[0], total[1]
