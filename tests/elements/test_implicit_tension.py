"""The implicit step of fibre tension against a dense solution of its equations."""

import numpy as np
import patches as p
import pytest


def _bars(patch, family):
    """(nodes of a bar, width) of all bars of a family, numbered row by row."""
    n, m = patch.shape
    number = np.arange(n * m).reshape(n, m)
    if family == 1:
        return number[:-1].ravel(), number[1:].ravel(), patch.bar1[:-1].ravel()
    return number[:, :-1].ravel(), number[:, 1:].ravel(), patch.bar2[:, :-1].ravel()


def _dense_parts(patch, x, family):
    """Contraction directions (bars, 3 N), stiffness k and tension T of every bar, linearised at x."""
    s = patch.sheet
    a, eh = float(s[f"a{family}"]), float(s[f"eh{family}"])
    start, end, width = _bars(patch, family)
    flat = x.reshape(3, -1)
    d = flat[:, end] - flat[:, start]
    size = np.sqrt((d * d).sum(axis=0))
    e, stretch = d / size, size / a
    g = np.zeros((start.size, 3, flat.shape[1]))
    bar = np.arange(start.size)
    for c in range(3):
        g[bar, c, start], g[bar, c, end] = -e[c], e[c]
    return g.reshape(start.size, -1), eh * width / a, eh * width * np.log(stretch) / stretch


def _dense_step(patch, x, v, inverse_mass, dt, family):
    g, k, tension = _dense_parts(patch, x, family)
    w = np.tile(inverse_mass.ravel(), 3)
    matrix = np.eye(w.size) + dt * dt * w[:, None] * (g.T @ (k[:, None] * g))
    return np.linalg.solve(matrix, v.ravel() - dt * w * (g.T @ tension)).reshape(v.shape)


@pytest.mark.parametrize("family", [1, 2])
@pytest.mark.parametrize("bundle", [16, 4, 1])
def test_step_solves_its_equations(family, bundle):
    rng = np.random.default_rng(family)
    patch = p.ply_patch(fractions=p.cut_fractions(rng))
    x = p.turned(p.random_rotation(rng), patch.rest)
    x += rng.normal(size=x.shape) * 0.005
    v = rng.normal(size=x.shape) * 100.0
    inverse = 1.0 / rng.uniform(1e-9, 4e-9, patch.shape)
    inverse[2, 3] = inverse[0, 5] = 0.0  # held nodes
    for dt in (1e-7, 1e-5, 1e-3):  # 1/100 .. 100 times the fibres' own limit
        expected = _dense_step(patch, x, v, inverse, dt, family)
        got = p.pull(patch, x, v, inverse, dt, family, bundle)
        assert p.relative(got - v, expected - v) < 1e-8
        assert np.array_equal(got[:, inverse == 0.0], v[:, inverse == 0.0])


@pytest.mark.parametrize("family", [1, 2])
def test_bundles_do_not_change_a_bit(family):
    rng = np.random.default_rng(9)
    patch = p.ply_patch(20, 35)
    x = patch.rest + rng.normal(size=patch.rest.shape) * 0.005
    v, inverse = rng.normal(size=x.shape), np.full(patch.shape, 1e9)
    one = p.pull(patch, x, v, inverse, 1e-5, family, 16)
    assert p.relative(p.pull(patch, x, v, inverse, 1e-5, family, 5), one) < 1e-13


def test_step_conserves_momentum_and_loses_energy():
    rng = np.random.default_rng(11)
    patch = p.ply_patch(fractions=p.cut_fractions(rng))
    x = patch.rest + rng.normal(size=patch.rest.shape) * 0.005
    mass = rng.uniform(1e-9, 4e-9, patch.shape)
    v = rng.normal(size=x.shape) * 100.0
    new = v
    for family in (1, 2):
        new = p.pull(patch, x, new, 1.0 / mass, 1e-5, family)

    def momenta(u):
        q = (mass * u).reshape(3, -1).T
        return np.concatenate([q.sum(axis=0), np.cross(x.reshape(3, -1).T, q).sum(axis=0)])

    scale = np.abs(mass * v).sum() * np.abs(x).max()
    assert np.abs(momenta(new) - momenta(v)).max() < 1e-12 * scale
    rest = p.pull(patch, patch.rest, v, 1.0 / mass, 1e-5, 1)  # unstretched: nothing to gain from
    assert (mass * rest**2).sum() < 0.9 * (mass * v**2).sum()


def _propagator(patch, rest, w, dt, order):
    """Linear map of (x, v) over one step about an unstretched lattice."""
    size = rest.size
    p_both = np.eye(size)
    pull_back = np.zeros((size, size))
    for family in order:
        g, k, _ = _dense_parts(patch, rest, family)
        stiff = w[:, None] * (g.T @ (k[:, None] * g))
        solve = np.linalg.inv(np.eye(size) + dt * dt * stiff)
        p_both, pull_back = solve @ p_both, solve @ (pull_back - dt * stiff)
    top = np.hstack([np.eye(size) + dt * pull_back, dt * p_both])
    return np.vstack([top, np.hstack([pull_back, p_both])])


@pytest.mark.parametrize("seed", range(8))
def test_linear_steps_are_stable_at_any_stiffness_and_angle(seed):
    rng = np.random.default_rng(seed)
    patch = p.ply_patch(
        4, 5, fractions=rng.uniform(0.1, 1.0, (3, 4)), eh1=10 ** rng.uniform(2, 5), eh2=10 ** rng.uniform(2, 5)
    )
    angle = np.deg2rad(rng.uniform(20.0, 160.0))
    u, v, _ = patch.rest
    rest = np.array([u + v * np.cos(angle), v * np.sin(angle), 0.0 * u])
    w = 1.0 / np.tile(rng.uniform(0.5e-9, 4e-9, patch.shape).ravel(), 3)
    dt = 10 ** rng.uniform(-7, -3)
    one, two = (_propagator(patch, rest, w, dt, order) for order in ((1, 2), (2, 1)))
    for matrix in (one, two):
        _assert_stable(matrix, dt)
    contraction = np.linalg.eigvals(one[rest.size :, rest.size :])
    assert np.abs(contraction.imag).max() < 1e-9
    assert contraction.real.min() > 0.0
    assert contraction.real.max() < 1.0 + 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_alternating_families_are_stable_too(seed):
    rng = np.random.default_rng(100 + seed)
    patch = p.ply_patch(4, 5, eh1=10 ** rng.uniform(2, 5), eh2=10 ** rng.uniform(2, 5))
    angle = np.deg2rad(rng.uniform(20.0, 160.0))
    u, v, _ = patch.rest
    rest = np.array([u + v * np.cos(angle), v * np.sin(angle), 0.0 * u])
    w = 1.0 / np.tile(rng.uniform(0.5e-9, 4e-9, patch.shape).ravel(), 3)
    dt = 10 ** rng.uniform(-7, -3)
    one, two = (_propagator(patch, rest, w, dt, order) for order in ((1, 2), (2, 1)))
    _assert_stable(two @ one, dt)


def _assert_stable(matrix, dt):
    """No eigenvalue outside the unit circle, and speeds that stay bounded.

    Free motions drift: they are multiple eigenvalues 1, which come out to the root of the machine's precision.
    """
    size = matrix.shape[0] // 2
    scale = np.concatenate([np.full(size, dt), np.ones(size)])  # positions in units of dt v
    matrix = matrix / scale[:, None] * scale[None, :]
    values = np.linalg.eigvals(matrix)
    outside = np.abs(values) > 1.0 + 1e-9
    assert np.abs(values[outside] - 1.0).max(initial=0.0) < 1e-4
    first = np.linalg.norm(matrix[size:, size:], 2)
    assert np.linalg.norm(np.linalg.matrix_power(matrix, 5000)[size:, size:], 2) < 10.0 * first


def test_kernel_has_that_linear_map():
    rng = np.random.default_rng(2)
    patch = p.ply_patch(4, 5)
    rest, dt = patch.rest, 1e-6
    inverse = 1.0 / rng.uniform(0.5e-9, 4e-9, patch.shape)
    expected = _propagator(patch, rest, np.tile(inverse.ravel(), 3), dt, (1, 2))
    dx, v = rng.normal(size=rest.shape) * 1e-9, rng.normal(size=rest.shape) * 1e-3
    new = p.pull(patch, rest + dx, v, inverse, dt, 1)
    new = p.pull(patch, rest + dx, new, inverse, dt, 2)
    linear = expected @ np.concatenate([dx.ravel(), v.ravel()])
    assert p.relative(new.ravel(), linear[rest.size :]) < 1e-5
