"""Rigid motions cause no forces; a free patch has no zero-energy modes but its mechanisms."""

import numpy as np
import patches as p
import pytest


def _ply_forces(patch, x, table):
    return p.ply_shear(patch, x, table) + p.ply_bending(patch, x) + p.ply_tension(patch, x)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_forces_of_a_ply_turn_with_it(seed):
    rng = np.random.default_rng(seed)
    patch, table = p.ply_patch(fractions=p.cut_fractions(rng), bend_in_plane=0.02), p.table_of("monotone")
    x = p.wavy(patch.rest, rng)
    rotation, shift = p.random_rotation(rng), rng.normal(size=(3, 1, 1)) * 20.0
    y = p.turned(rotation, x) + shift
    kinds = (
        lambda q: p.ply_shear(patch, q, table),
        lambda q: p.ply_bending(patch, q),
        lambda q: p.ply_tension(patch, q),
    )
    for force in kinds:
        assert p.relative(force(y), p.turned(rotation, force(x))) < 1e-9


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_forces_of_a_diaphragm_turn_with_it(seed):
    rng = np.random.default_rng(seed)
    patch = p.rubber_patch(rng)
    x = p.wavy(patch.rest * 1.2, rng)
    rotation, shift = p.random_rotation(rng), rng.normal(size=(3, 1, 1)) * 20.0
    y = p.turned(rotation, x) + shift
    for force in (lambda q: p.rubber(patch, q, 0.1), lambda q: p.plate(patch, q)):
        assert p.relative(force(y), p.turned(rotation, force(x))) < 1e-9


def test_a_sheet_at_rest_moved_rigidly_has_no_forces():
    rng = np.random.default_rng(4)
    ply, skin, table = p.ply_patch(), p.rubber_patch(rng), p.table_of("published")
    rotation = p.random_rotation(rng)
    x, y = p.turned(rotation, ply.rest) + 5.0, p.turned(rotation, skin.rest) - 3.0
    # against the forces of a displacement of 1e-3 mm: 10 N for fibres, 1e-3 N for the rubber
    assert np.abs(_ply_forces(ply, x, table)).max() < 1e-8
    assert np.abs(p.rubber(skin, y) + p.plate(skin, y)).max() < 1e-11


@pytest.mark.parametrize("seed", [1, 2])
def test_internal_forces_have_no_resultant_and_no_moment(seed):
    rng = np.random.default_rng(seed)
    ply, skin = p.ply_patch(fractions=p.cut_fractions(rng)), p.rubber_patch(rng)
    x, y = p.wavy(ply.rest, rng), p.wavy(skin.rest, rng)
    for at, f in ((x, _ply_forces(ply, x, p.table_of("monotone"))), (y, p.rubber(skin, y) + p.plate(skin, y))):
        scale = np.abs(f).sum()
        moment = np.cross(at.reshape(3, -1).T, f.reshape(3, -1).T).sum(axis=0)
        assert np.abs(f.sum(axis=(1, 2))).max() < 1e-12 * scale
        assert np.abs(moment).max() < 1e-11 * scale * np.abs(at).max()


def _stiffness(force, x, step):
    size = x.size
    k = np.zeros((size, size))
    for a in range(size):
        y = x.ravel().copy()
        y[a] += step
        up = force(y.reshape(x.shape)).ravel()
        y[a] -= 2.0 * step
        k[:, a] = -(up - force(y.reshape(x.shape)).ravel()) / (2.0 * step)
    assert np.abs(k - k.T).max() < 1e-4 * np.abs(k).max()
    return 0.5 * (k + k.T)


def _rigid_modes(x):
    u, v, w = x - x.mean(axis=(1, 2), keepdims=True)
    zero, one = np.zeros_like(u), np.ones_like(u)
    modes = [
        (one, zero, zero), (zero, one, zero), (zero, zero, one), (-v, u, zero), (w, zero, -u), (zero, -w, v),
    ]  # fmt: skip
    return np.array([np.ravel(m) for m in modes])


def _zero_modes(k, modes, next_least):
    """The space of the softest len(modes) eigenvectors is that of `modes`; the next is stiff."""
    values, vectors = np.linalg.eigh(k)
    count = len(modes)
    assert np.abs(values[:count]).max() < 1e-2 * next_least
    assert values[count] > next_least
    basis = np.linalg.qr(np.asarray(modes).T)[0]
    left = vectors[:, :count] - basis @ (basis.T @ vectors[:, :count])
    assert np.abs(left).max() < 1e-3


def test_free_ply_has_rigid_modes_and_the_twist_only():
    patch = p.ply_patch(6, 6, eh1=2000.0, eh2=2000.0, a2=2.0, bend2=0.34)
    table = p.table_of("monotone")
    k = _stiffness(lambda x: _ply_forces(patch, x, table), patch.rest, 1e-5)
    u, v, _ = patch.rest - patch.rest.mean(axis=(1, 2), keepdims=True)
    twist = np.array([0 * u, 0 * u, u * v]).ravel()
    # softest real mode: bending of a free strip 10 mm long, D (4.73/L)^4 a^2 = 0.068 N/mm
    _zero_modes(k, [*_rigid_modes(patch.rest), twist], 0.02)


def test_free_diaphragm_has_rigid_modes_only():
    rng = np.random.default_rng(3)
    patch = p.rubber_patch(rng, 6, 6, hourglass=4.0 * 0.9643 * 1.5)
    k = _stiffness(lambda x: p.rubber(patch, x) + p.plate(patch, x), patch.rest, 1e-5)
    # softest real mode: the twist, D (1 - nu) 2 w_xy^2 over 100 mm2
    _zero_modes(k, _rigid_modes(patch.rest), 0.02)
