"""The smooth surface of a sheet that other sheets touch: biquadratic B-splines over its grid.

Bilinear cells have kinks: a node that hovers at a kink, a sheet's thickness away, falls from one cell's
projection to the other's and back, step after step, and each fall feeds energy into the stack (a flat
clamped stack never came to rest). The spline's normal is continuous, so the projection is too.

With t = u - i in [-1/2, 1/2] the weights of nodes i-1, i, i+1 are  1/2 (1/2 - t)^2, 3/4 - t^2,
1/2 (1/2 + t)^2. They sum to 1 and reproduce linear functions. The surface lies h^2 k / 8 inside a curve k
of the nodes. Beyond a ply's edges it goes on over nodes of a rim (`rim.py`); where a patch has not all of its 3 x 3
nodes even so, the next whole one is extended.

Nodes lie as (x, y, z, cover), forces on them as (x, y, z, normal force), so that one packed instruction serves all
components (`quad.py`).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ddf.jit import FAST, INLINE
from ddf.quad import add_scaled, load, scaled, store

FOUR, EIGHT = np.uint64(4), np.uint64(8)


@njit(**INLINE)
def weights(t):
    """The three weights and their derivatives at t."""
    p, q = 0.5 - t, 0.5 + t
    return 0.5 * p * p, 0.75 - t * t, 0.5 * q * q, -p, -2.0 * t, q


@njit(**INLINE)
def _mix(b0, b1, b2, y0, y1, y2):
    """b0 y0 + b1 y1 + b2 y2."""
    return add_scaled(b0, y0, add_scaled(b1, y1, scaled(b2, y2)))


@njit(**INLINE)
def _line(y0, y1, y2, t):
    """Value, twice the slope and second derivative at t:  y_1 + t d/2 + (t^2/2 + 1/8) c,  d + 2 t c  and  c,

    with d = y_2 - y_0,  c = y_0 - 2 y_1 + y_2. The same as with `weights`, in two thirds of the operations.
    """
    d, c = add_scaled(-1.0, y0, y2), add_scaled(-2.0, y1, add_scaled(1.0, y0, y2))
    return add_scaled(0.5 * t * t + 0.125, c, add_scaled(0.5 * t, d, y1)), add_scaled(2.0 * t, c, d), c


@njit(**FAST)
def _along_row(y, k, t):
    """`_line` of one row of a patch along v; k: where its first node begins in y."""
    return _line(load(y, k), load(y, k + FOUR), load(y, k + EIGHT), t)


@njit(**FAST)
def interpolate(y, k, stride, s, t):
    """The place on the surface, S_1, S_2, S_11 and S_22 there, as quads.

    y: the nodes (4 N M,); k: where the patch's first node begins, stride: from row to row; s, t: place from its centre.
    """
    r0, s0, c0 = _along_row(y, k, t)
    r1, s1, c1 = _along_row(y, k + stride, t)
    r2, s2, c2 = _along_row(y, k + stride + stride, t)
    value, twice, second = _line(r0, r1, r2, s)
    a0, a1, a2, _, _, _ = weights(s)
    return (
        value, scaled(0.5, twice), _mix(0.5 * a0, 0.5 * a1, 0.5 * a2, s0, s1, s2), second, _mix(a0, a1, a2, c0, c1, c2)
    )  # fmt: skip


@njit(**FAST)
def first_order(y, k, stride, s, t):
    """Value and first derivatives only, of any nodal quads; arguments as in `interpolate`."""
    r0, s0, _ = _along_row(y, k, t)
    r1, s1, _ = _along_row(y, k + stride, t)
    r2, s2, _ = _along_row(y, k + stride + stride, t)
    value, twice, _ = _line(r0, r1, r2, s)
    a0, a1, a2, _, _, _ = weights(s)
    return value, scaled(0.5, twice), _mix(0.5 * a0, 0.5 * a1, 0.5 * a2, s0, s1, s2)


@njit(**FAST)
def _add_row(buffer, k, b, p, q):
    """Add  b p + b' q  to the three nodes of a row."""
    for j in range(3):
        # the sum apart from what is there, which may have been stored just now
        more = add_scaled(b[j], p, scaled(b[3 + j], q))
        store(buffer, k, add_scaled(1.0, load(buffer, k), more))
        k += FOUR


@njit(**FAST)
def spread(buffer, k, stride, a, b, value, along_u, along_v):
    """Add  a b value + a' b along_u + a b' along_v  to nine nodes; the adjoint of `interpolate`."""
    _add_row(buffer, k, b, add_scaled(a[0], value, scaled(a[3], along_u)), scaled(a[0], along_v))
    k += stride
    _add_row(buffer, k, b, add_scaled(a[1], value, scaled(a[4], along_u)), scaled(a[1], along_v))
    k += stride
    _add_row(buffer, k, b, add_scaled(a[2], value, scaled(a[5], along_u)), scaled(a[2], along_v))


def patch_centres(exists: NDArray[np.bool_]) -> NDArray[np.int32]:
    """For each node the centre (i, j) of the 3 x 3 patch to use around it, (n, m, 2); -1 where there is none.

    The node itself where all nine nodes exist, else the nearest such node at most two away.
    """
    n, m = exists.shape
    p = np.pad(exists, 1)
    whole = np.ones((n, m), bool)
    for a in range(3):
        for b in range(3):
            whole &= p[a : a + n, b : b + m]
    centres = np.full((n, m, 2), -1, np.int32)
    shifts = sorted(((a, b) for a in range(-2, 3) for b in range(-2, 3)), key=lambda s: (s[0] ** 2 + s[1] ** 2, s))
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    for a, b in shifts:
        k, l = i + a, j + b
        inside = (k >= 0) & (l >= 0) & (k < n) & (l < m)
        good = inside & whole[np.clip(k, 0, n - 1), np.clip(l, 0, m - 1)] & (centres[..., 0] < 0)
        centres[good, 0], centres[good, 1] = k[good], l[good]
    return centres
