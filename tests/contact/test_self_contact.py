"""Contact of a folded sheet with itself: what is searched and found, gradient, momenta, friction."""

import folding
import numpy as np
import pytest
import touching as t
from differences import gradient

from ddf.verify.folded import hairpin

ELEMENT, RADIUS, FLANK = 1.25, 2.0, 20.0
LAW = {"offset": 4.05, "radius": 1.8}  # flanks are 4 mm apart


def _folded(rng=None, noise=0.03, **law):
    x = hairpin(37, 8, ELEMENT, FLANK, RADIUS)
    if rng is not None:
        x = x + rng.normal(size=x.shape) * noise
        q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        x = np.tensordot(q * np.sign(np.linalg.det(q)), x, 1)
    return x, folding.Fold(x.shape[1:], ELEMENT, **(LAW | law))


def test_nothing_is_found_where_nothing_folds():
    for x in (hairpin(37, 8, ELEMENT, 1e3, RADIUS), folding.dome(60, 1.0, 60.0)):
        sheet = folding.Fold(x.shape[1:], ELEMENT, **LAW)
        assert sheet.find(x) == (False, False)


@pytest.mark.parametrize("down", [False, True])
def test_flanks_of_a_fold_find_each_other(down):
    x, fold = _folded()
    if down:
        x[2] *= -1.0  # the other face lies inside
    assert fold.find(x) == (not down, down)
    place, rest = fold.sides[int(down)]
    s, length = np.arange(38) * ELEMENT, 2.0 * FLANK + np.pi * RADIUS
    on_flank = np.ix_((s < FLANK - 2.0) & (length - s < 37 * ELEMENT), np.arange(8))  # not on the very edge
    assert (rest[on_flank] == 0).all()
    fold.settle(x)
    assert fold.touching()[int(down)][on_flank].all()
    u, v, gap = (part[on_flank] for part in place[:3])
    assert np.abs(u - (length - s[on_flank[0]]) / ELEMENT).max() < 1e-6
    assert np.abs(v - np.arange(8)).max() < 1e-6
    assert np.abs(gap + 0.05).max() < 1e-9
    # in the bend no node touches one nearer than half a turn
    i = np.nonzero(fold.touching()[int(down)])[0]
    u = place[0][fold.touching()[int(down)]]
    assert (np.abs(u - i) * ELEMENT).min() > np.pi * LAW["radius"]


def test_a_place_pressed_through_keeps_its_side():
    x, fold = _folded()
    fold.find(x)
    fold.settle(x)
    touched = fold.touching()[0].sum()
    upper = np.arange(38)[:, None] * ELEMENT > FLANK + 0.5 * np.pi * RADIUS
    y = x - np.array([0.0, 0.0, 7.0])[:, None, None] * upper  # the upper flank now lies 3 mm below the lower one
    fold.forces(y)
    fold.find(y)
    assert (fold.sides[1][1][fold.touching()[0]] < 0).all()
    assert fold.touching()[0].sum() > 0.6 * touched
    assert (fold.forces(y)[2][:12] <= 0.0).all()  # still pushed apart the way they came


def test_force_is_the_gradient_of_the_spring_energy():
    x, fold = _folded(np.random.default_rng(1))
    fold.find(x)
    fold.settle(x)
    places = [place.copy() for place, _ in fold.sides]

    def energy(y):
        for (place, _), kept in zip(fold.sides, places, strict=True):
            place[:] = kept
        return fold.settle(y, 6).out[0]

    f = fold.forces(x)
    assert (np.abs(f).max(axis=0) > 0.0).sum() > 200
    part = np.s_[:, 4:9, 2:6]
    y = x.copy()

    def energy_of_part(values):
        y[part] = values
        return energy(y)

    assert np.abs(f[part] + gradient(energy_of_part, x[part].copy(), 1e-5)).max() < 1e-5 * np.abs(f).max()


@pytest.mark.parametrize("seed", range(10))
def test_momenta_are_conserved_whatever_happens(seed):
    rng = np.random.default_rng(seed)
    x, fold = _folded(rng, 0.1, friction=0.5, damping=1e-4)
    fold.find(x)
    fold.settle(x, 4)
    for (place, _), slip in zip(fold.sides, fold.slips, strict=True):
        place[:2] += rng.normal(size=place[:2].shape) * 0.15  # far from converged
        slip += rng.normal(size=slip.shape) * 0.02
    x = x + rng.normal(size=x.shape) * 0.05
    f = fold.forces(x, rng.normal(size=x.shape) * 1e3, 1e-5)
    assert (np.abs(f).max(axis=0) > 0).sum() > 50
    assert fold.out[2] > 0.0
    force, moment, scale, couple = t.resultants((x, f))
    assert np.abs(force).max() < 1e-12 * scale
    assert np.abs(moment).max() < 1e-12 * couple


@pytest.mark.parametrize("seed", range(3))
def test_friction_in_a_fold_never_gives_energy(seed):
    rng = np.random.default_rng(seed)
    x, fold = _folded(rng, 0.02, friction=0.4, damping=2e-5)
    rest, speed, lost, dt = x.copy(), np.zeros_like(x), 0.0, 1e-5
    fold.find(x)
    for step in range(300):
        speed = 0.9 * speed + rng.normal(size=(3, 1, 1)) * 50.0 + rng.normal(size=x.shape) * 50.0 - 2e3 * (x - rest)
        x = x + dt * speed
        if step % 10 == 0:
            fold.find(x)
        fold.forces(x, speed, dt)
        assert fold.out[2] >= -1e-15
        lost += fold.out[2]
    assert lost > 1e-3


def test_flank_that_slides_meets_coulomb_friction():
    x, fold = _folded(friction=0.3)
    fold.find(x)
    fold.settle(x)
    v, dt, lost = np.zeros_like(x), 1e-6, []
    v[0, 19:] = 1e3  # the upper flank
    for _ in range(400):
        x = x + dt * v
        f = fold.forces(x, v, dt)
        lost.append(fold.out[2])
    pressed = f[2, 19:].sum()
    assert pressed > 10.0
    assert f[0, 19:].sum() == pytest.approx(-0.3 * pressed, rel=0.02)
    assert lost[-1] == pytest.approx(-(f * v).sum() * dt, rel=0.02)
