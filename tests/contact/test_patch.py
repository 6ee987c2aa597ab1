"""The smooth surface of a sheet: biquadratic B-splines over its grid."""

import numpy as np
from numba import njit

from ddf.contact.patch import interpolate, patch_centres, weights
from ddf.quad import store


@njit
def _quads(y, k, stride, s, t, out):
    parts = interpolate(y, np.uint64(k), np.uint64(stride), s, t)
    store(out, np.uint64(0), parts[0])
    store(out, np.uint64(4), parts[1])
    store(out, np.uint64(8), parts[2])
    store(out, np.uint64(12), parts[3])
    store(out, np.uint64(16), parts[4])


def _at(y, i, j, s, t, parts=3):
    """Value and derivatives (along u, v, uu, vv) of one component y (N, M) in the patch of node (i, j)."""
    nodes, out = np.zeros((*y.shape, 4)), np.zeros(20)
    nodes[..., 1] = y
    _quads(nodes.reshape(-1), 4 * ((i - 1) * y.shape[1] + j - 1), 4 * y.shape[1], s, t, out)
    return tuple(out.reshape(5, 4)[:parts, 1])


def test_weights_sum_to_one_and_join_smoothly():
    for s in np.linspace(-0.5, 0.5, 11):
        w = weights(s)
        assert abs(sum(w[:3]) - 1.0) < 1e-15
        assert abs(sum(w[3:])) < 1e-15
        assert abs(w[2] - w[0] - s) < 1e-15
    left, right = weights(0.5), weights(-0.5)
    assert np.allclose([left[1], left[2], left[4], left[5]], [right[0], right[1], right[3], right[4]])


def test_surface_and_slopes():
    rng = np.random.default_rng(0)
    y = rng.normal(size=(5, 6))
    h = 1e-6
    for s, t in rng.uniform(-0.4, 0.4, (5, 2)):
        _, du, dv = _at(y, 2, 3, s, t)
        assert abs((_at(y, 2, 3, s + h, t)[0] - _at(y, 2, 3, s - h, t)[0]) / (2 * h) - du) < 1e-8
        assert abs((_at(y, 2, 3, s, t + h)[0] - _at(y, 2, 3, s, t - h)[0]) / (2 * h) - dv) < 1e-8
        suu, svv = _at(y, 2, 3, s, t, 5)[3:]
        assert abs((_at(y, 2, 3, s + h, t)[1] - _at(y, 2, 3, s - h, t)[1]) / (2 * h) - suu) < 1e-7
        assert abs((_at(y, 2, 3, s, t + h)[2] - _at(y, 2, 3, s, t - h)[2]) / (2 * h) - svv) < 1e-7
    # value and slopes are continuous from one patch to the next
    assert np.allclose(_at(y, 2, 3, 0.5, 0.1), _at(y, 3, 3, -0.5, 0.1), atol=1e-14)
    assert np.allclose(_at(y, 2, 3, 0.2, 0.5), _at(y, 2, 4, 0.2, -0.5), atol=1e-14)


def test_plane_is_reproduced():
    i, j = np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij")
    value, du, dv = _at(2.0 * i - 3.0 * j + 1.0, 2, 2, 0.3, -0.45)
    assert np.allclose((value, du, dv), (2.0 * 2.3 - 3.0 * 1.55 + 1.0, 2.0, -3.0))


def test_patch_centres_are_whole_and_near():
    exists = np.ones((8, 9), bool)
    exists[:3, :3] = False
    exists[6, 7] = False
    centres = patch_centres(exists)
    for i, j in np.ndindex(exists.shape):
        a, b = centres[i, j]
        if a < 0:
            near = [(k, l) for k in range(i - 2, i + 3) for l in range(j - 2, j + 3)]
            assert not any(_whole(exists, k, l) for k, l in near)
        else:
            assert _whole(exists, a, b)
            assert max(abs(a - i), abs(b - j)) <= 2
            if _whole(exists, i, j):
                assert (a, b) == (i, j)
    assert (patch_centres(np.ones((2, 9), bool)) == -1).all()


def _whole(exists, i, j):
    n, m = exists.shape
    return 1 <= i < n - 1 and 1 <= j < m - 1 and exists[i - 1 : i + 2, j - 1 : j + 2].all()
