"""Struts that keep sheets from folding tighter than what lies on them allows.

In a fold of the whole stack the outer diaphragm lies on the plies and on the other diaphragm. When its mid-surface
has the radius r = t + h (thickness of a diaphragm, of all plies) that of the other one is folded flat. A grid of
cells of size a would let it fold tighter: a line of nodes is a hinge. And where the surface that others touch (the
spline of `contact.patch`) has a radius below the distance at which they touch, the closest point has no meaning,
places jump and energy comes from nowhere (measured: a third of the work in a coarse formed part). So over two cells,
s = 2 a together, the chord c of the outer nodes is bounded: that spline has the least radius (c^2/4)/sqrt(s^2 - c^2),
which is r at

    c0^2 = 8 r^2 (sqrt(1 + (s/(2 r))^2) - 1)

(58 degrees of turn at a = 1.25 r, 85 at a = 2.5 r). c0 comes near s for a << r, and c is shorter than it not only
where the sheet turns: rubber pressed flat in its plane meets the struts too, at 5 % with a = r/2, at 20 % with
a = 1.25 r, and is up to twice as stiff from there on. When c < c0 the two outer nodes push each other apart:

    U = 1/2 N w c0 (1 - c/c0)^2,   w the width of the line, N = 4 mu t of a diaphragm

(its membrane modulus). A ply's least radius is t/2 + h/2 of its own: what is left to it between the diaphragms.
Central forces: momenta are kept. Their energy is booked as `folding`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.elements.cells import filled
from ddf.jit import FAST, INLINE


@njit(**INLINE)
def least_chord(s, radius):
    """Least distance of the outer nodes of two cells, s long together, at a fold's least radius [mm]."""
    q = 0.5 * s / radius
    return radius * np.sqrt(8.0 * (np.sqrt(1.0 + q * q) - 1.0))


@njit(**FAST)
def _any_short(xa, ya, za, xb, yb, zb, chord):
    """Whether any two nodes of two rows, pair by pair, are nearer than their least chord."""
    short = 0.0  # a sum, for compilers vectorise no least of all
    for j in range(xa.shape[0]):
        dx, dy, dz = xb[j] - xa[j], yb[j] - ya[j], zb[j] - za[j]
        short += max(0.0, chord[j] * chord[j] - (dx * dx + dy * dy + dz * dz))
    return short > 0.0


@njit(**FAST)
def _push(xa, ya, za, xb, yb, zb, fx, fy, fz, modulus, width, chord):
    """Forces of struts on their ends a; modulus [N/mm], widths and least chords [mm] a strut."""
    for j in range(xa.shape[0]):
        dx, dy, dz = xb[j] - xa[j], yb[j] - ya[j], zb[j] - za[j]
        c = np.sqrt(dx * dx + dy * dy + dz * dz) + 1e-30
        g = max(0.0, modulus * width[j] * (1.0 / c - 1.0 / chord[j]))
        fx[j] -= g * dx
        fy[j] -= g * dy
        fz[j] -= g * dz


@njit(**FAST)
def fold_forces(x, f, dx, dy, modulus, radius, low, high, scratch):
    """Add the struts' forces to rows low..high-1; x, f (3, n, m); dx, dy cell sizes [mm]; scratch (2, m)."""
    n, m = x.shape[1], x.shape[2]
    width, chord = scratch[0], scratch[1]
    for j in range(m):
        width[j] = 0.5 * ((dy[j - 1] if j > 0 else 0.0) + (dy[j] if j < m - 1 else 0.0))
    for i in range(low, high):
        for k in (i - 2, i + 2):
            if k < 0 or k >= n:
                continue
            first = min(i, k)
            c = least_chord(dx[first] + dx[first + 1], radius)
            chord[:m] = c
            if _any_short(x[0, i], x[1, i], x[2, i], x[0, k], x[1, k], x[2, k], chord):
                _push(
                    x[0, i], x[1, i], x[2, i], x[0, k], x[1, k], x[2, k], f[0, i], f[1, i], f[2, i],
                    modulus, width, chord,
                )  # fmt: skip
    for j in range(m - 2):
        chord[j] = least_chord(dy[j] + dy[j + 1], radius)
    for i in range(low, high):
        a, b = x[:, i, : m - 2], x[:, i, 2:]
        if _any_short(a[0], a[1], a[2], b[0], b[1], b[2], chord):
            w = 0.5 * ((dx[i - 1] if i > 0 else 0.0) + (dx[i] if i < n - 1 else 0.0))
            width[: m - 2] = w
            p, q = f[:, i, : m - 2], f[:, i, 2:]
            _push(a[0], a[1], a[2], b[0], b[1], b[2], p[0], p[1], p[2], modulus, width, chord)
            _push(b[0], b[1], b[2], a[0], a[1], a[2], q[0], q[1], q[2], modulus, width, chord)


@njit(**FAST)
def fold_lattice_forces(x, f, triple1, triple2, a1, a2, modulus, radius, low, high, scratch):
    """The same for a ply: struts along both families over the bending triples, areas (n, m) [mm2]."""
    n, m = x.shape[1], x.shape[2]
    width, chord = scratch[0], scratch[1]
    chord[:m] = least_chord(2.0 * a1, radius)
    for i in range(low, high):
        for k in (i - 2, i + 2):
            if k < 0 or k >= n:
                continue
            middle = (i + k) // 2
            p, q = filled(triple1, middle, 0.0)
            if q == 0:
                continue
            a, b = x[:, i, p:q], x[:, k, p:q]
            if _any_short(a[0], a[1], a[2], b[0], b[1], b[2], chord):
                for j in range(p, q):
                    width[j - p] = triple1[middle, j] / a1
                g = f[:, i, p:q]
                _push(a[0], a[1], a[2], b[0], b[1], b[2], g[0], g[1], g[2], modulus, width, chord)
    chord[:m] = least_chord(2.0 * a2, radius)
    for i in range(low, high):
        p, q = filled(triple2, i, 0.0)
        if q == 0:
            continue
        p, q = max(p, 1), min(q, m - 1)
        a, b = x[:, i, p - 1 : q - 1], x[:, i, p + 1 : q + 1]
        if _any_short(a[0], a[1], a[2], b[0], b[1], b[2], chord):
            for j in range(p, q):
                width[j - p] = triple2[i, j] / a2
            g, h = f[:, i, p - 1 : q - 1], f[:, i, p + 1 : q + 1]
            _push(a[0], a[1], a[2], b[0], b[1], b[2], g[0], g[1], g[2], modulus, width, chord)
            _push(b[0], b[1], b[2], a[0], a[1], a[2], h[0], h[1], h[2], modulus, width, chord)


def _strut_energy(x: np.ndarray, axis: int, chord: np.ndarray, width: np.ndarray, modulus: float) -> tuple[float, int]:
    """Energy of the struts along an axis [N mm] and how many push; chord, width broadcast to one number a strut."""
    d = x[:, 2:] - x[:, :-2] if axis == 1 else x[:, :, 2:] - x[:, :, :-2]
    short = np.where(width > 0.0, np.maximum(0.0, 1.0 - np.sqrt((d * d).sum(axis=0)) / chord), 0.0)
    return float(0.5 * modulus * np.sum(width * chord * short**2)), int(np.count_nonzero(short))


def fold_energy(x: np.ndarray, dx: np.ndarray, dy: np.ndarray, modulus: float, radius: float) -> tuple[float, int]:
    """Energy of all struts of a diaphragm [N mm], and how many push; x (3, n, m)."""
    if radius <= 0.0:
        return 0.0, 0
    total = [0.0, 0]
    for axis, along, across in ((1, dx, dy), (2, dy, dx)):
        chord = np.array([least_chord.py_func(s, radius) for s in along[:-1] + along[1:]])
        width = 0.5 * (np.pad(across, (1, 0)) + np.pad(across, (0, 1)))
        chord, width = (chord[:, None], width[None, :]) if axis == 1 else (chord[None, :], width[:, None])
        energy, count = _strut_energy(x, axis, chord, width, modulus)
        total = [total[0] + energy, total[1] + count]
    return total[0], int(total[1])


def fold_lattice_energy(
    x: np.ndarray, triple1: np.ndarray, triple2: np.ndarray, spacing: tuple[float, float], modulus: float, radius: float
) -> tuple[float, int]:
    """The same for a ply; triple1, triple2 (n, m) areas of its bending triples [mm2]."""
    if radius <= 0.0:
        return 0.0, 0
    total = [0.0, 0]
    for axis, area, a in ((1, triple1[1:-1], spacing[0]), (2, triple2[:, 1:-1], spacing[1])):
        energy, count = _strut_energy(x, axis, np.array(least_chord.py_func(2.0 * a, radius)), area / a, modulus)
        total = [total[0] + energy, total[1] + count]
    return total[0], int(total[1])
