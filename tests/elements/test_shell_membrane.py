"""Shell-membrane cells: the rate law against the published equations, invariance, work, patches, modes, step."""

import numpy as np
import patches as p
import pytest
import shells
from scipy.linalg import polar

from ddf.dynamics.timestep import shell_gyration, shell_membrane_omega2
from ddf.elements.shell_membrane import history as h
from ddf.elements.shell_membrane.rotations import normals
from ddf.materials.shear_law import largest_tangent, shear_samples

EH, THICKNESS = (20_000.0, 15_000.0), 0.5


def _placed(patch, f, turn):
    """Places and directors of a flat patch under a plane deformation f (2, 2), turned in space by turn (3, 3)."""
    x = np.concatenate([np.tensordot(f, patch.rest[:2], 1), np.zeros_like(patch.rest[:1])])
    d = np.zeros_like(x)
    d[2] = 1.0
    return p.turned(turn, x), p.turned(turn, d)


def _published(path, fibre, tangent):
    """Stress resultants (2, 2) in space at the end of a path of F (2, 2): the published equations, word by word."""
    frames = np.array([[np.cos(fibre), -np.sin(fibre)], [np.sin(fibre), np.cos(fibre)]])  # columns: the families
    stress, strain = [np.zeros((2, 2)), np.zeros((2, 2))], [0.0, 0.0]
    gradients = list(path)
    for before, after in zip(gradients[:-1], gradients[1:], strict=True):
        _, u0 = polar(before)
        _, u1 = polar(after)
        middle = 0.5 * (u0 + u1)
        rate = (u1 - u0) @ np.linalg.inv(middle)
        de = 0.5 * (rate + rate.T)  # in the Green-Naghdi frame
        turns, parts = [], []
        for a in (0, 1):
            g = frames[:, a]
            f = middle @ g / np.linalg.norm(middle @ g)
            sine, cosine = g[0] * f[1] - g[1] * f[0], g @ f  # (5), (6)
            turn = np.array([[cosine, -sine], [sine, cosine]]) @ frames  # (4), from the fibres' reference frame
            turns.append(turn)
            parts.append(turn.T @ de @ turn)  # (7)
        steps = [parts[0][0, 1], parts[1][0, 1]]
        angle = sum(strain) + 0.5 * sum(steps)  # (11)
        for a in (0, 1):
            grown = np.zeros((2, 2))
            grown[a, a] = EH[a] * parts[a][a, a]  # (8)
            grown[0, 1] = grown[1, 0] = tangent(abs(angle)) * steps[a]
            stress[a] = stress[a] + grown  # (9)
            strain[a] += steps[a]
    rotation, u = polar(gradients[-1])
    total = np.zeros((2, 2))
    for a in (0, 1):
        f = u @ frames[:, a] / np.linalg.norm(u @ frames[:, a])
        g = frames[:, a]
        turn = np.array([[g @ f, -(g[0] * f[1] - g[1] * f[0])], [g[0] * f[1] - g[1] * f[0], g @ f]]) @ frames
        total += turn @ stress[a] @ turn.T  # (10)
    return rotation @ total @ rotation.T, sum(strain)


@pytest.mark.parametrize("fibre", [0.0, 0.6, np.pi / 4])
def test_the_rate_law_is_the_published_one(fibre):
    """A path of stretch, simple shear and turning: nodal forces against the stress that equations 1 to 11 give."""
    patch = shells.shell_patch(2, 2, fibre=fibre, bend1=0.0, bend2=0.0, glass=0.0, transverse=0.0)
    turn, steps = p.random_rotation(np.random.default_rng(1)), 400

    def gradient(t):
        c, s = np.cos(1.3 * t), np.sin(1.3 * t)
        return np.array([[c, -s], [s, c]]) @ np.array([[1.0 + 0.02 * t, 0.7 * t**2], [0.1 * t, 1.0 - 0.01 * t]])

    path = [gradient(t) for t in np.linspace(0.0, 1.0, steps + 1)]
    for f in path[1:]:
        x, d = _placed(patch, f, turn)
        force, _, _ = patch.forces(x, d)
    table = shells.tangents_of("monotone")
    stress, angle = _published(path, fibre, lambda g: table[int(g / np.deg2rad(80.0) * table.size)])
    assert patch.past[h.M_E1, 0, 0] + patch.past[h.M_E2, 0, 0] == pytest.approx(angle, rel=1e-5)
    piola = np.linalg.det(path[-1]) * stress @ np.linalg.inv(path[-1]).T
    # constant stress: the node at (a1, a2) gets -(P1 a2 + P2 a1)/2
    plane = -0.5 * (piola[:, 0] * 1.7 + piola[:, 1] * 2.0)
    expected = turn @ np.array([*plane, 0.0])
    assert force[:, 1, 1] == pytest.approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max())


@pytest.mark.parametrize("fibre", [0.0, np.pi / 4])
def test_shear_accumulates_to_the_true_angle_and_tension_to_the_logarithm(fibre):
    patch = shells.shell_patch(2, 2, fibre=fibre, bend1=0.0, bend2=0.0)
    c, s = np.cos(fibre), np.sin(fibre)
    frame = np.array([[c, -s], [s, c]])
    for g in np.linspace(0.0, np.deg2rad(60.0), 601)[1:]:
        trellis = np.array([[np.cos(g / 2), np.sin(g / 2)], [np.sin(g / 2), np.cos(g / 2)]])
        x, d = _placed(patch, frame @ trellis @ np.diag([np.exp(0.01 * g), 1.0]) @ frame.T, np.eye(3))
        patch.forces(x, d)
    assert np.rad2deg(patch.past[h.M_E1, 0, 0] + patch.past[h.M_E2, 0, 0]) == pytest.approx(60.0, abs=1e-3)
    assert patch.past[h.M_TENSION1, 0, 0] == pytest.approx(EH[0] * 0.01 * np.deg2rad(60.0), rel=1e-5)
    assert abs(patch.past[h.M_TENSION2, 0, 0]) < 1e-6 * EH[1]
    # as in a picture frame, where each family has half of it
    angle, force = shear_samples("monotone", 0.5, 0.002, p.PUBLISHED, None)
    both = patch.past[h.M_SHEAR1, 0, 0] + patch.past[h.M_SHEAR2, 0, 0]
    assert both == pytest.approx(np.interp(np.deg2rad(60.0), angle, force), rel=1e-3)


def test_the_rate_law_has_no_energy():
    """Stretch a fibre, shear, let go, shear back: tension acts on a current width, cos g of the first one."""
    patch, work, strain, g = shells.shell_patch(2, 2, bend1=0.0, bend2=0.0), 0.0, 0.01, np.deg2rad(40.0)

    def go(path):
        nonlocal work
        for stretch, angle in path:
            f = np.array([[np.cos(angle / 2), np.sin(angle / 2)], [np.sin(angle / 2), np.cos(angle / 2)]])
            work += patch.forces(*_placed(patch, f @ np.diag([np.exp(stretch), 1.0]), np.eye(3)))[2]

    part = np.linspace(0.0, 1.0, 401)[1:]
    go([(strain * t, 0.0) for t in part])
    go([(strain, g * t) for t in part])
    go([(strain * (1.0 - t), g) for t in part])
    go([(0.0, g * (1.0 - t)) for t in part])
    area = 2.0 * 1.7
    assert work == pytest.approx(0.5 * EH[0] * strain**2 * area * (1.0 - np.cos(g)), rel=0.01)


@pytest.fixture(params=[1, 2])
def moved(request):
    """A cut patch with fibres askew, its remembered state a rumpled one."""
    rng = np.random.default_rng(request.param)
    patch = shells.shell_patch(fractions=p.cut_fractions(rng), fibre=0.3)
    x, d = shells.rumpled(patch, rng)
    patch.forces(x, d)
    return patch, x, d, rng


def test_forces_have_no_resultant_and_no_moment_and_row_blocks_do_not_matter(moved):
    patch, x, d, _ = moved
    f, pull, _ = patch.forces(x, d, keep=False)
    moment = np.cross(x, f, axis=0) + np.cross(d, pull, axis=0)
    assert np.abs(f.sum(axis=(1, 2))).max() < 1e-12 * np.abs(f).sum()
    assert np.abs(moment.sum(axis=(1, 2))).max() < 1e-12 * np.abs(moment).sum()
    for seam in (1, 3, 6):
        g, other, _ = patch.forces(x, d, seam, keep=False)
        assert p.relative(g, f) < 1e-14
        assert p.relative(other, pull) < 1e-14


def test_a_rigid_motion_turns_the_forces_and_does_no_work(moved):
    patch, x, d, rng = moved
    f, pull, _ = patch.forces(x, d, keep=False)
    turn = p.random_rotation(rng)
    g, other, work = patch.forces(p.turned(turn, x) + 5.0, p.turned(turn, d), keep=False)
    assert p.relative(g, p.turned(turn, f)) < 1e-11
    assert p.relative(other, p.turned(turn, pull)) < 1e-11
    assert abs(work) < 1e-9


def test_work_of_the_forces_is_stress_work_and_elastic_energy(moved):
    patch, x, d, rng = moved
    before = patch.forces(x, d, keep=False)
    dx, dd = rng.normal(size=x.shape) * 1e-5, np.cross(rng.normal(size=x.shape) * 1e-3, d, axis=0)
    dd = (d + dd) / np.sqrt(((d + dd) ** 2).sum(axis=0)) - d
    after = patch.forces(x + dx, d + dd, keep=False)
    spent = -sum(np.sum(0.5 * (a + b) * step) for a, b, step in zip(before[:2], after[:2], (dx, dd), strict=True))
    elastic = patch.elastic(x + dx, d + dd) - patch.elastic(x, d)
    assert abs(elastic) > 0.01 * abs(spent)
    assert spent == pytest.approx(after[2] + elastic, rel=1e-6)


@pytest.mark.parametrize("fibre", [0.0, 0.6])
def test_even_deformations_have_no_force_inside(fibre):
    patch = shells.shell_patch(fibre=fibre)
    turn = p.random_rotation(np.random.default_rng(2))
    x, d = _placed(patch, np.array([[1.004, 0.3], [0.1, 1.002]]), turn)
    f, pull, _ = patch.forces(x, d)
    assert np.abs(f[:, 1:-1, 1:-1]).max() < 1e-11 * np.abs(f).max()
    assert np.abs(pull).max() < 1e-11 * np.abs(f).max()
    assert patch.elastic(x, d) < 1e-20


@pytest.mark.parametrize("fibre", [0.0, np.pi / 4])
def test_even_curvature(fibre):
    """Rolled on a cylinder: D k^2/2 an area along a family; at 45 degrees each has k/2, a quarter of both."""
    patch = shells.shell_patch(9, 5, fibre=fibre, bend2=0.34, transverse=20.0)
    radius = 200.0
    angle = patch.rest[0] / radius
    x = np.array([radius * np.sin(angle), patch.rest[1], radius * (1.0 - np.cos(angle))])
    d = np.array([-np.sin(angle), np.zeros_like(angle), np.cos(angle)])
    _, pull, _ = patch.forces(x, d)
    expected = 0.5 * 0.34 / radius**2 * patch.ply.cell.sum() * (1.0 if fibre == 0.0 else 0.5)
    assert patch.stored()["bending"] == pytest.approx(expected, rel=1e-3)
    assert patch.elastic(x, d) < 1e-4 * expected
    turning = np.cross(d, pull, axis=0)
    assert np.abs(turning[:, 1:-1, 1:-1]).max() < 1e-3 * np.abs(turning).max()


def test_free_patch_has_rigid_modes_and_the_twist_only():
    patch = shells.shell_patch(5, 5, a2=2.0, eh1=2000.0, eh2=2000.0, bend2=0.34)
    n = patch.rest[0].size
    flat, up = patch.rest, np.zeros_like(patch.rest)
    up[2] = 1.0
    # unknowns: displacements, and the directors' parts in the plane times a side, for a common unit
    size, step = 5 * n, 1e-6

    def respond(u):
        d = up.copy()
        d[:2] += u[3 * n :].reshape(2, 5, 5) / 2.0
        f, pull, _ = patch.forces(flat + u[: 3 * n].reshape(3, 5, 5), d, keep=False)
        return np.concatenate([f.ravel(), pull[:2].ravel() / 2.0])

    k = np.array([(respond(-step * e) - respond(step * e)) / (2.0 * step) for e in np.eye(size)])
    assert np.abs(k - k.T).max() < 1e-6 * np.abs(k).max()
    values, vectors = np.linalg.eigh(0.5 * (k + k.T))
    a, b, _ = flat - flat.mean(axis=(1, 2), keepdims=True)
    o, i = np.zeros_like(a), np.ones_like(a)
    # a deflection w turns the directors by -grad w
    modes = [
        (i, o, o, o, o), (o, i, o, o, o), (o, o, i, o, o), (-b, a, o, o, o),
        (o, o, a, -2.0 * i, o), (o, o, b, o, -2.0 * i), (o, o, a * b, -2.0 * b, -2.0 * a),
    ]  # fmt: skip
    assert np.abs(values[:7]).max() < 1e-4 * values[7]
    basis = np.linalg.qr(np.array([np.ravel(m) for m in modes]).T)[0]
    left = vectors[:, :7] - basis @ (basis.T @ vectors[:, :7])
    assert np.abs(left).max() < 1e-3


@pytest.mark.parametrize("fibre", [0.0, np.pi / 4])
@pytest.mark.parametrize("shear", [0.0, 0.5])
def test_the_largest_frequency_is_under_the_bound(fibre, shear):
    """Power iteration on the forces of a free patch with rotations; square cells, at rest and sheared."""
    mass, side = 3.2e-10, 2.0
    stiff = 20_000.0 + 12.0 * 0.34 / 0.25
    gyration = shell_gyration(stiff, 0.34, 20.0, 0.5, (side, side))
    patch = shells.shell_patch(12, 12, a2=side, eh2=20_000.0, bend2=0.34, fibre=fibre, gyration=gyration)
    c, s = np.cos(fibre), np.sin(fibre)
    frame = np.array([[c, -s], [s, c]])
    for t in np.linspace(0.0, 1.0, 101)[1:]:  # in steps: fibres are not stretched
        part = np.array([[1.0, np.sin(t * shear)], [0.0, np.cos(t * shear)]])
        x, d = _placed(patch, frame @ part @ frame.T, np.eye(3))
        patch.forces(x, d)
    node = mass * np.pad(patch.ply.cell, ((1, 0), (1, 0)))
    node = 0.25 * (node[1:, 1:] + node[:-1, 1:] + node[1:, :-1] + node[:-1, :-1])
    v, w = np.random.default_rng(0).normal(size=(2, *x.shape))
    w[2] = 0.0
    for _ in range(150):
        size = np.sqrt(np.sum(v * v) + np.sum(w * w))
        v, w = v / size, w / size
        step = 1e-6
        ahead, back = (patch.forces(x + s * v, d + s * w, keep=False) for s in (step, -step))
        v, w = -(ahead[0] - back[0]) / (2 * step) / node, -(ahead[1] - back[1]) / (2 * step) / node / gyration
        w[2] = 0.0
    found = np.sqrt(np.sum(v * v) + np.sum(w * w))
    tangent = largest_tangent(*shear_samples("monotone", 0.5, 0.002, p.PUBLISHED, None))
    bound = shell_membrane_omega2(stiff, tangent, 20.0, (side, side), 0.0, mass)
    assert found < bound * 1.001
    if fibre == 0.0 and shear == 0.0:
        assert found > 0.9 * bound


def test_hourglass_control_sees_its_pattern_and_leaves_the_twist():
    patch = shells.shell_patch()
    pattern = (-1.0) ** np.add.outer(np.arange(7), np.arange(9))
    for c, free in ((0, False), (1, False), (2, True)):
        x = patch.rest.copy()
        x[c] += 0.01 * pattern
        energy = patch.elastic(x, normals(patch.rest))
        transverse = 0.5 * 20.0 / 3.0 * (0.02**2) * (1 / 2.0**2 + 1 / 1.7**2) * patch.ply.cell.sum()
        if free:  # no hourglass energy: only the edges' shear, for the directors do not follow
            assert energy == pytest.approx(transverse, rel=1e-9)
        else:
            scale = 1 / 2.0**2 + 1 / 1.7**2
            glass = 0.5 * 0.05 * (2.0 / 3.0) * 20_000.0 * scale * 0.01**2 * patch.ply.cell.sum()
            assert energy == pytest.approx(glass, rel=1e-9)
