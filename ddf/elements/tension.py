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

from ddf.elements.cells import filled
from ddf.jit import FAST
from ddf.quad import load, store, transposed

LINES = 16
"""Fibre lines that are solved side by side."""

# What the lines' nodes, and the bars from each to the next, carry: LINES numbers of each kind, kind by kind, node by
# node; before the first node and after the last a place with nothing in it. One array with constant distances: loops
# over lines are vectorised, which those over rows of a dozen arrays were not.
(
    X, Y, Z, U, V, W,  # place [mm] and velocity [mm/s]; y is normal to the mirror plane, if there is one
    MASS, BAR, KEPT,  # inverse mass [1/tonne], width [mm], tension [N]
    PIVOT,  # of the elimination; afterwards, in the string's step, what the next node's velocity adds
    PULL, COUPLED,  # reduced right side, then impulse [N s]; share of the next bar's impulse in it
) = (np.uint64(k * LINES) for k in range(12))  # fmt: skip
EX, EY, EZ = X, Y, Z  # direction, once the places are not needed any more
STIFF = BAR  # stiffness of the string [tonne], likewise
FIELDS = 13  # one more than there are: places a power of two of bytes apart would fight for few lines of the cache
NEXT = np.uint64(FIELDS * LINES)
LANES = np.uint64(LINES)
ONE, TWO, FOUR = np.uint64(1), np.uint64(2), np.uint64(4)


def line_scratch(nodes: int) -> int:
    """Numbers of scratch for lines of that many nodes."""
    return (nodes + 2) * FIELDS * LINES


@njit(**FAST)
def _forward(w, o, law):
    """One bar of every line, that of the node at o: direction, pivot, reduced right side.

    law = (1/a, dt^2 E h / a, dt E h / 2, dt).
    """
    inverse_a, stiff, pull, dt = law
    for j in range(LANES):
        k = o + j
        after, before = k + NEXT, k - NEXT
        dx = w[after + X] - w[k + X]
        dy = w[after + Y] - w[k + Y]
        dz = w[after + Z] - w[k + Z]
        square = dx * dx + dy * dy + dz * dz
        r = 1.0 / np.sqrt(square)
        dx *= r
        dy *= r
        dz *= r
        q = square * inverse_a * inverse_a - 1.0
        log = q * (1.0 + q * (-1.5 + q * (11 / 6 + q * (-25 / 12 + q * (137 / 60 - 49 / 20 * q)))))
        tension = pull * w[k + BAR] * log * square * r * inverse_a
        kappa = stiff * w[k + BAR]
        mass, mass_after = w[k + MASS], w[after + MASS]
        coupled = abs(mass) * (dx * w[before + EX] + dy * w[before + EY] + dz * w[before + EZ])
        share = w[before + PIVOT] * coupled
        w[before + COUPLED] = share
        low = kappa * coupled
        strain = dx * (w[after + U] - w[k + U]) + dy * (w[after + V] - w[k + V]) + dz * (w[after + W] - w[k + W])
        right = kappa * strain + tension - dt * w[k + KEPT]
        along = 1.0 - dy * dy
        free = (mass if mass >= 0.0 else -mass * along) + (mass_after if mass_after >= 0.0 else -mass_after * along)
        inverse = 1.0 / (1.0 + kappa * free - low * share)
        w[k + PULL] = (right + low * w[before + PULL]) * inverse
        w[k + PIVOT] = kappa * inverse
        w[k + EX] = dx
        w[k + EY] = dy
        w[k + EZ] = dz


@njit(**FAST)
def _correct(w, o, per_dt):
    """Correction of each bar's impulse from that of the bar after it, applied to both nodes' velocities."""
    for j in range(LANES):
        k = o + j
        after = k + NEXT
        p = w[k + PULL] + w[k + COUPLED] * w[after + PULL]
        w[k + PULL] = p
        w[k + KEPT] += per_dt * p
        a, b = abs(w[k + MASS]) * p, abs(w[after + MASS]) * p
        w[k + U] += a * w[k + EX]
        w[k + V] += max(w[k + MASS], 0.0) * p * w[k + EY]
        w[k + W] += a * w[k + EZ]
        w[after + U] -= b * w[k + EX]
        w[after + V] -= max(w[after + MASS], 0.0) * p * w[k + EY]
        w[after + W] -= b * w[k + EZ]


@njit(**FAST)
def _correct_string(w, o, per_dt, scale):
    """The same; then the bar's second node is final for the axial part, and the string's system is reduced by it.

    The node after that has its reduced velocity already: v_b += PIVOT v_a once v_a is known.
    """
    for j in range(LANES):
        k = o + j
        after = k + NEXT
        last = after + NEXT
        p = w[k + PULL] + w[k + COUPLED] * w[after + PULL]
        w[k + PULL] = p
        tension = w[k + KEPT] + per_dt * p
        w[k + KEPT] = tension
        a, mass = abs(w[k + MASS]) * p, w[after + MASS]
        b = abs(mass) * p
        w[k + U] += a * w[k + EX]
        w[k + V] += max(w[k + MASS], 0.0) * p * w[k + EY]
        w[k + W] += a * w[k + EZ]
        s = max(tension, 0.0) * scale
        pull = abs(mass) * w[after + STIFF]
        inverse = 1.0 / (1.0 + abs(mass) * s + pull * (1.0 - w[after + PIVOT]))
        w[after + U] = (w[after + U] - b * w[k + EX] + pull * w[last + U]) * inverse
        v = (w[after + V] - b * w[k + EY] + pull * w[last + V]) * inverse
        w[after + V] = v if mass >= 0.0 else 0.0
        w[after + W] = (w[after + W] - b * w[k + EZ] + pull * w[last + W]) * inverse
        w[k + PIVOT] = abs(mass) * s * inverse
        w[k + STIFF] = s


@njit(**FAST)
def _first_node(w, o):
    """Reduce the string's system by a line's first node: it is final then."""
    for j in range(LANES):
        k = o + j
        after = k + NEXT
        s = abs(w[k + MASS]) * w[k + STIFF]
        inverse = 1.0 / (1.0 + s * (1.0 - w[k + PIVOT]))
        w[k + U] = (w[k + U] + s * w[after + U]) * inverse
        v = (w[k + V] + s * w[after + V]) * inverse
        w[k + V] = v if w[k + MASS] >= 0.0 else 0.0
        w[k + W] = (w[k + W] + s * w[after + W]) * inverse


@njit(**FAST)
def _substitute(w, o):
    """Velocity of the next node of each line, given that of the one before."""
    for j in range(LANES):
        k = o + j
        after, g = k + NEXT, w[k + PIVOT]
        w[after + U] += g * w[k + U]
        w[after + V] += g * w[k + V] if w[after + MASS] >= 0.0 else 0.0
        w[after + W] += g * w[k + W]


@njit(**FAST)
def _solve(w, nodes, law, string):
    """Correct the tension along lines of so many nodes that have been gathered in w."""
    first, last = NEXT, NEXT * np.uint64(nodes)
    w[:NEXT] = 0.0
    w[last + PIVOT : last + np.uint64(2) * NEXT] = 0.0
    ahead = (law[0], law[1], law[2], law[4])
    o = first
    while o < last:
        _forward(w, o, ahead)
        o += NEXT
    w[last + STIFF : last + STIFF + LANES] = 0.0
    w[last - NEXT + COUPLED : last - NEXT + COUPLED + LANES] = 0.0
    per_dt = 1.0 / law[4]
    o = last - NEXT
    if not string:
        while o >= first:
            _correct(w, o, per_dt)
            o -= NEXT
        return
    while o >= first:
        _correct_string(w, o, per_dt, law[3])
        o -= NEXT
    _first_node(w, first)
    o = first
    while o < last:
        _substitute(w, o)
        o += NEXT


@njit(**FAST)
def pull_lines(x, v, inverse_mass, bar, kept, law, string, mirror, a, b, first, end, work):
    """Correct the tension along the first grid direction, nodes first..end-1 of lines a..b-1, at most LINES of them.

    x, v (3, n, m) [mm], [mm/s], of which v is changed in place, as is kept; inverse_mass [1/tonne], below 0 on the
    mirror plane, which is normal to component `mirror` (if any); bar (n, m) widths [mm]; kept (n, m) tensions [N],
    which are in v; law = (1/a, dt^2 E h / a, dt E h / 2, dt^2 / a, dt) in mm, s, N; string: whether to take the
    string's step as well; work (line_scratch(end - first),).
    """
    # the kernels above take the component normal to the mirror plane as the second one
    r, q, s = (1, 0, 2) if mirror == 0 else (0, 1, 2)
    o = np.int64(NEXT)
    for values in (x[r], x[q], x[s], v[r], v[q], v[s], inverse_mass, bar, kept):
        _gather(values, a, b, first, end, work, o)
        o += LINES
    _solve(work, end - first, law, string)
    _scatter(work, np.int64(NEXT + U), v[r], a, b, first, end)
    _scatter(work, np.int64(NEXT + V), v[q], a, b, first, end)
    _scatter(work, np.int64(NEXT + W), v[s], a, b, first, end)
    _scatter(work, np.int64(NEXT + KEPT), kept, a, b, first, end)


@njit(**FAST)
def pull_rows(x, v, inverse_mass, bar, kept, law, string, mirror, low, high, first, end, work):
    """The same along the second grid direction for nodes first..end-1 of rows low..high-1."""
    r, q, s = (1, 0, 2) if mirror == 0 else (0, 1, 2)
    o = np.int64(NEXT)
    for values in (x[r], x[q], x[s], v[r], v[q], v[s], inverse_mass, bar, kept):
        _turn(values, low, high, first, end, work, o)
        o += LINES
    _solve(work, end - first, law, string)
    _turn_back(work, np.int64(NEXT + U), v[r], low, high, first, end)
    _turn_back(work, np.int64(NEXT + V), v[q], low, high, first, end)
    _turn_back(work, np.int64(NEXT + W), v[s], low, high, first, end)
    _turn_back(work, np.int64(NEXT + KEPT), kept, low, high, first, end)


@njit(**FAST)
def _gather(values, a, b, first, end, work, o):
    """One kind of numbers of the nodes of lines a..b-1, side by side; lanes left over get those of the last line."""
    if b - a == LINES:
        q, p, row = np.uint64(o), np.uint64(first * values.shape[1] + a), np.uint64(values.shape[1])
        for _ in range(first, end):
            for j in range(np.uint64(0), LANES, FOUR):
                store(work, q + j, load(values, p + j))
            p += row
            q += NEXT
        return
    for i in range(first, end):
        for j in range(LINES):
            work[o + j] = values[i, min(a + j, b - 1)]
        o += FIELDS * LINES


@njit(**FAST)
def _scatter(work, o, values, a, b, first, end):
    """One kind of numbers of lines a..b-1 back."""
    if b - a == LINES:
        q, p, row = np.uint64(o), np.uint64(first * values.shape[1] + a), np.uint64(values.shape[1])
        for _ in range(first, end):
            for j in range(np.uint64(0), LANES, FOUR):
                store(values, p + j, load(work, q + j))
            p += row
            q += NEXT
        return
    for i in range(first, end):
        for j in range(b - a):
            values[i, a + j] = work[o + j]
        o += FIELDS * LINES


@njit(**FAST)
def _turn(values, low, high, first, end, work, o):
    """One kind of numbers of nodes first..end-1 of rows low..high-1, node by node, rows side by side.

    Four rows and four nodes at a time; lanes left over get those of the last row.
    """
    row = values.shape[1]
    for lane in range(0, LINES, 4):
        i, j = min(low + lane, high - 1), min(low + lane + 1, high - 1)
        k, l = min(low + lane + 2, high - 1), min(low + lane + 3, high - 1)
        p, q = np.uint64(i * row + first), np.uint64(j * row + first)
        r, s = np.uint64(k * row + first), np.uint64(l * row + first)
        to, node = np.uint64(o + lane), first
        while node + 4 <= end:
            a, b, c, d = transposed(load(values, p), load(values, q), load(values, r), load(values, s))
            store(work, to, a)
            store(work, to + NEXT, b)
            store(work, to + NEXT + NEXT, c)
            store(work, to + NEXT + NEXT + NEXT, d)
            p, q, r, s, to, node = p + FOUR, q + FOUR, r + FOUR, s + FOUR, to + FOUR * NEXT, node + 4
        while node < end:
            work[to], work[to + ONE] = values[i, node], values[j, node]
            work[to + TWO], work[to + TWO + ONE] = values[k, node], values[l, node]
            to, node = to + NEXT, node + 1


@njit(**FAST)
def _turn_back(work, o, values, low, high, first, end):
    """One kind of numbers of such rows back."""
    row = values.shape[1]
    for lane in range(0, high - low, 4):
        at, node, i = np.uint64(o + lane), first, low + lane
        p, step = np.uint64(i * row + first), np.uint64(row)
        while i + 4 <= high and node + 4 <= end:
            a, b, c, d = transposed(
                load(work, at), load(work, at + NEXT), load(work, at + NEXT + NEXT), load(work, at + NEXT + NEXT + NEXT)
            )
            store(values, p, a)
            store(values, p + step, b)
            store(values, p + step + step, c)
            store(values, p + step + step + step, d)
            p, at, node = p + FOUR, at + FOUR * NEXT, node + 4
        while node < end:
            for k in range(min(4, high - i)):
                values[i + k, node] = work[at + np.uint64(k)]
            at, node = at + NEXT, node + 1


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
        a, b = filled(kept1, k, 0.0)
        if b > a:
            _bar_row(
                x[0, k, a:b], x[1, k, a:b], x[2, k, a:b], x[0, k + 1, a:b], x[1, k + 1, a:b], x[2, k + 1, a:b],
                kept1[k, a:b], q[0, a:b], q[1, a:b], q[2, a:b],
            )  # fmt: skip
            for c in range(3):
                _add_row(v[c, i, a:b], q[c, a:b], sign, inverse_mass[i, a:b])
    a, b = filled(kept2, i, 0.0)
    b = min(b, m - 1)
    if b > a:
        p, r = a + 1, b + 1
        _bar_row(
            x[0, i, a:b], x[1, i, a:b], x[2, i, a:b], x[0, i, p:r], x[1, i, p:r], x[2, i, p:r], kept2[i, a:b],
            q[0, a:b], q[1, a:b], q[2, a:b],
        )  # fmt: skip
        for c in range(3):
            _add_row(v[c, i, a:b], q[c, a:b], impulse, inverse_mass[i, a:b])
            _add_row(v[c, i, p:r], q[c, a:b], -impulse, inverse_mass[i, p:r])


def tension_energy(x: np.ndarray, bar1: np.ndarray, bar2: np.ndarray, sheet: np.void) -> tuple[float, float]:
    """Energy 1/2 E h a w (ln lambda)^2 of all bars of family 1 and 2 [N mm]; x (3, n, m), bars (n, m)."""
    total = []
    for axis, width, a, eh in ((1, bar1, sheet["a1"], sheet["eh1"]), (2, bar2, sheet["a2"], sheet["eh2"])):
        d = np.diff(x, axis=axis)
        log = 0.5 * np.log((d * d).sum(axis=0) / a**2)
        w = width[:-1, :] if axis == 1 else width[:, :-1]
        total.append(float(0.5 * eh * a * np.sum(w * log * log)))
    return total[0], total[1]
