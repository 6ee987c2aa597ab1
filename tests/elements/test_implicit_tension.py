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
        # from tensions that are already in v: the same end, and they end as those of the solution
        g, k, tension = _dense_parts(patch, x, family)
        start, _, width = _bars(patch, family)
        kept = np.zeros(patch.rest[0].size)
        kept[start] = rng.normal(size=start.size) * (width > 0.0)
        before = v - dt * np.tile(inverse.ravel(), 3).reshape(v.shape) * (g.T @ kept[start]).reshape(v.shape)
        kept = kept.reshape(patch.shape)
        again = p.pull(patch, x, before, inverse, dt, family, bundle, kept)
        assert p.relative(again - v, expected - v) < 1e-7
        assert p.relative(kept.ravel()[start], tension + dt * k * (g @ expected.ravel())) < 1e-6


@pytest.mark.parametrize("family", [1, 2])
def test_string_resists_across_itself(family):
    rng = np.random.default_rng(20 + family)
    patch = p.ply_patch(fractions=p.cut_fractions(rng))
    x = patch.rest * 1.002 + rng.normal(size=patch.rest.shape) * 0.002  # most bars pulled, some pressed
    v, inverse, dt = rng.normal(size=x.shape) * 100.0, 1.0 / rng.uniform(1e-9, 4e-9, patch.shape), 3e-5
    kept = np.zeros(patch.shape)
    axial = p.pull(patch, x, v, inverse, dt, family, kept=kept)
    got = p.pull(patch, x, v, inverse, dt, family, string=True)
    start, end, _ = _bars(patch, family)
    s = dt * dt * np.maximum(kept.ravel()[start], 0.0) / float(patch.sheet[f"a{family}"])
    assert (s > 0).sum() > 20
    matrix = np.eye(patch.rest[0].size)
    w = inverse.ravel()
    for a, b, stiff in zip(start, end, s, strict=True):
        for i, j in ((a, b), (b, a)):
            matrix[i, i] += w[i] * stiff
            matrix[i, j] -= w[i] * stiff
    expected = np.linalg.solve(matrix, axial.reshape(3, -1).T).T.reshape(v.shape)
    assert p.relative(got - axial, expected - axial) < 1e-9
    change = ((got - axial) / inverse).reshape(3, -1).sum(axis=1)
    assert np.abs(change).max() < 1e-12 * np.abs(axial / inverse).sum()


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


def _propagator(patch, rest, w, dt, first):
    """Linear map of (x, v, tensions of family 1, 2) over one step about an unstretched lattice, strings apart."""
    parts = [_dense_parts(patch, rest, family) for family in (1, 2)]
    size, bars = rest.size, [parts[0][1].size, parts[1][1].size]
    whole = np.eye(2 * size + sum(bars))
    x, v = whole[:size], whole[size : 2 * size]
    kept = [whole[2 * size : 2 * size + bars[0]], whole[2 * size + bars[0] :]]
    v = v - dt * w[:, None] * sum(g.T @ t for (g, _, _), t in zip(parts, kept, strict=True))
    for turn in range(4):
        f = first - 1 if turn % 2 == 0 else 2 - first
        g, k, _ = parts[f]
        v = v + dt * w[:, None] * (g.T @ kept[f])
        v = np.linalg.solve(
            np.eye(size) + dt * dt * w[:, None] * (g.T @ (k[:, None] * g)),
            v - dt * w[:, None] * (g.T @ (k[:, None] * (g @ x))),
        )
        kept[f] = k[:, None] * (g @ (x + dt * v))
    return np.vstack([x + dt * v, v, *kept])


@pytest.mark.parametrize("seed", range(16))
def test_steps_are_stable_at_any_stiffness_and_angle(seed):
    rng = np.random.default_rng(seed)
    patch = p.ply_patch(
        4, 5, fractions=rng.uniform(0.1, 1.0, (3, 4)), eh1=10 ** rng.uniform(2, 5), eh2=10 ** rng.uniform(2, 5)
    )
    angle = np.deg2rad(rng.uniform(20.0, 160.0))
    u, v, _ = patch.rest
    rest = np.array([u + v * np.cos(angle), v * np.sin(angle), 0.0 * u])
    w = 1.0 / np.tile(rng.uniform(0.5e-9, 4e-9, patch.shape).ravel(), 3)
    dt = 10 ** rng.uniform(-7, -3)
    one, two = (_propagator(patch, rest, w, dt, first) for first in (1, 2))
    stiff = max(np.max(_dense_parts(patch, rest, f)[1]) for f in (1, 2))
    scale = np.concatenate(
        [np.full(rest.size, dt), np.ones(rest.size), np.full(one.shape[0] - 2 * rest.size, stiff * dt)]
    )
    _assert_stable(two @ one, scale, rest.size)


@pytest.mark.parametrize("angle", [10, 30, 50, 60, 70, 75])
@pytest.mark.parametrize("stiffness", [30.0, 1e3, 1e5])
def test_two_bars_are_stable(angle, stiffness):
    """Two bars on one node at an angle to square, k dt^2/m = stiffness: the families' coupling in its purest form."""
    n = np.array([[1.0, 0.0], [np.sin(np.deg2rad(angle)), np.cos(np.deg2rad(angle))]])

    def step(first):
        whole = np.eye(6)
        x, v, kept = whole[:2], whole[2:4], [whole[4], whole[5]]
        for turn in range(4):
            i = first if turn % 2 == 0 else 1 - first
            without = v - np.outer(n[1 - i], kept[1 - i])
            kept[i] = stiffness * n[i] @ (x + without) / (1.0 + stiffness)
        v = v - sum(np.outer(a, t) for a, t in zip(n, kept, strict=True))
        return np.vstack([x + v, v, *kept])

    assert np.abs(np.linalg.eigvals(step(1) @ step(0))).max() < 1.0


@pytest.mark.parametrize("degrees", [50.0, 30.0])
def test_sheared_ply_at_rest_stays_at_rest(degrees):
    """And its tensions are those of its stretch, also where two that nearly cancel hardly move a node (30 degrees)."""
    rng = np.random.default_rng(4)
    patch = p.ply_patch(8, 8)
    u, v, _ = patch.rest
    angle = np.deg2rad(degrees)
    x = np.array([u + v * np.cos(angle), v * np.sin(angle), 0.02 * u * v])
    mass, dt = np.full(patch.shape, 3e-8), 3e-5
    load = rng.normal(size=x.shape) * 0.02
    speed, kept = np.zeros_like(x), [np.zeros(patch.shape), np.zeros(patch.shape)]
    inverse = 1.0 / mass
    inverse[0], inverse[:, 0] = 0.0, 0.0
    for step in range(4000):
        speed = 0.99 * speed + dt * load * inverse
        speed = p.pull_both(patch, x, speed, inverse, dt, kept, 1 + step % 2)
        x = x + dt * speed
    left = load.copy()
    for family in (1, 2):
        g, _, tension = _dense_parts(patch, x, family)
        held = kept[family - 1].ravel()[_bars(patch, family)[0]]
        assert np.abs(held - tension).max() < 0.02 * np.abs(held).max()
        left -= (g.T @ kept[family - 1].ravel()[_bars(patch, family)[0]]).reshape(x.shape)
    assert np.abs(speed).max() < 0.05  # at 50 degrees 391 with one sweep from nothing
    free = inverse > 0.0
    assert np.abs(left[:, free]).max() < 0.1 * np.abs(load).max()


def _assert_stable(matrix, scale, size):
    """No eigenvalue outside the unit circle, and speeds that stay bounded.

    Free motions drift: they are multiple eigenvalues 1, which come out to the root of the machine's precision.
    """
    matrix = matrix / scale[:, None] * scale[None, :]
    values = np.linalg.eigvals(matrix)
    outside = np.abs(values) > 1.0 + 1e-9
    assert np.abs(values[outside] - 1.0).max(initial=0.0) < 1e-4
    speeds = slice(size, 2 * size)
    first = np.linalg.norm(matrix[speeds, speeds], 2)
    assert np.linalg.norm(np.linalg.matrix_power(matrix, 5000)[speeds, speeds], 2) < 10.0 * first


def test_kernel_has_that_linear_map():
    rng = np.random.default_rng(2)
    patch = p.ply_patch(4, 5)
    rest, dt = patch.rest, 1e-6
    inverse = 1.0 / rng.uniform(0.5e-9, 4e-9, patch.shape)
    expected = _propagator(patch, rest, np.tile(inverse.ravel(), 3), dt, 1)
    dx, v = rng.normal(size=rest.shape) * 1e-9, rng.normal(size=rest.shape) * 1e-3
    kept, flat = [], []
    for family in (1, 2):
        start, _, width = _bars(patch, family)
        t = np.zeros(patch.rest[0].size)
        t[start] = rng.normal(size=start.size) * 1e-6 * (width > 0.0)
        kept.append(t.reshape(patch.shape))
        flat.append(t[start])
    new = p.pull_both(patch, rest + dx, v, inverse, dt, kept, 1)
    linear = expected @ np.concatenate([dx.ravel(), v.ravel(), *flat])
    assert p.relative(new.ravel(), linear[rest.size : 2 * rest.size]) < 1e-5
