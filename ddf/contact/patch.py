"""The smooth surface of a sheet that other sheets touch: biquadratic B-splines over its grid.

Bilinear cells have kinks: a node that hovers at a kink, a sheet's thickness away, falls from one cell's
projection to the other's and back, step after step, and each fall feeds energy into the stack (a flat
clamped stack never came to rest). The spline's normal is continuous, so the projection is too.

With t = u - i in [-1/2, 1/2] the weights of nodes i-1, i, i+1 are  1/2 (1/2 - t)^2, 3/4 - t^2,
1/2 (1/2 + t)^2. They sum to 1 and reproduce linear functions. The surface lies h^2 k / 8 inside a curve k
of the nodes. Near an edge the last whole patch of 3 x 3 nodes is extended.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

ONE = np.uint64(1)


@njit(inline="always")
def weights(t):
    """The three weights and their derivatives at t."""
    p, q = 0.5 - t, 0.5 + t
    return 0.5 * p * p, 0.75 - t * t, 0.5 * q * q, -p, -2.0 * t, q


@njit(inline="always")
def interpolate(y, i, j, a, b):
    """One component at a place, and its derivatives along u and v; y (N, M), a and b from `weights`.

    i, j unsigned: numba then does without the test for negative indices.
    """
    i0, i2, j0, j2 = i - ONE, i + ONE, j - ONE, j + ONE
    y00, y01, y02 = y[i0, j0], y[i0, j], y[i0, j2]
    y10, y11, y12 = y[i, j0], y[i, j], y[i, j2]
    y20, y21, y22 = y[i2, j0], y[i2, j], y[i2, j2]
    r0 = b[0] * y00 + b[1] * y01 + b[2] * y02
    r1 = b[0] * y10 + b[1] * y11 + b[2] * y12
    r2 = b[0] * y20 + b[1] * y21 + b[2] * y22
    s0 = b[3] * y00 + b[4] * y01 + b[5] * y02
    s1 = b[3] * y10 + b[4] * y11 + b[5] * y12
    s2 = b[3] * y20 + b[4] * y21 + b[5] * y22
    return (
        a[0] * r0 + a[1] * r1 + a[2] * r2,
        a[3] * r0 + a[4] * r1 + a[5] * r2,
        a[0] * s0 + a[1] * s1 + a[2] * s2,
    )


@njit(inline="always")
def spread(buffer, i, j, b, force, couple, w0, w1, w2):
    """Add  -W f + Q c  to nine nodes, one component; row k has W = w_k[0] b + w_k[1] b', Q = w_k[2] b + w_k[3] b'."""
    i0, i2, j0, j2 = i - ONE, i + ONE, j - ONE, j + ONE
    p0, q0 = w0[2] * couple - w0[0] * force, w0[3] * couple - w0[1] * force
    p1, q1 = w1[2] * couple - w1[0] * force, w1[3] * couple - w1[1] * force
    p2, q2 = w2[2] * couple - w2[0] * force, w2[3] * couple - w2[1] * force
    buffer[i0, j0] += p0 * b[0] + q0 * b[3]
    buffer[i0, j] += p0 * b[1] + q0 * b[4]
    buffer[i0, j2] += p0 * b[2] + q0 * b[5]
    buffer[i, j0] += p1 * b[0] + q1 * b[3]
    buffer[i, j] += p1 * b[1] + q1 * b[4]
    buffer[i, j2] += p1 * b[2] + q1 * b[5]
    buffer[i2, j0] += p2 * b[0] + q2 * b[3]
    buffer[i2, j] += p2 * b[1] + q2 * b[4]
    buffer[i2, j2] += p2 * b[2] + q2 * b[5]


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
