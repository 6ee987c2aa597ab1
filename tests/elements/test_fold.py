"""Struts against folds: gradient of their energy, momenta, and the least chord's geometry."""

import numpy as np
import patches as p
import pytest
from differences import gradient

from ddf.elements.fold import fold_energy, fold_forces, fold_lattice_energy, fold_lattice_forces, least_chord


def _folded(rng, n=7, m=8):
    """A sheet folded along oblique lines, tighter than its elements can follow."""
    u, v = np.meshgrid(np.arange(n) * 2.0, np.arange(m) * 2.5, indexing="ij")
    z = 3.0 * (-1.0) ** np.arange(n)[:, None] + 2.0 * (-1.0) ** np.arange(m)[None, :]
    return np.array([0.4 * u, 0.6 * v, z]) + rng.normal(size=(3, n, m)) * 0.1


def test_forces_are_the_gradient_and_keep_momenta():
    rng = np.random.default_rng(0)
    x = _folded(rng)
    dx, dy = rng.uniform(1.5, 2.5, 6), rng.uniform(2.0, 3.0, 7)
    f = np.zeros_like(x)
    for low, high in ((0, 3), (3, 7)):  # blocks of rows do not matter
        fold_forces(x, f, dx, dy, 5.8, 2.0, low, high, np.zeros((2, 10)))
    energy, count = fold_energy(x, dx, dy, 5.8, 2.0)
    assert energy > 1.0
    assert count > 20
    assert np.abs(f + gradient(lambda y: fold_energy(y, dx, dy, 5.8, 2.0)[0], x, 1e-5)).max() < 1e-6 * np.abs(f).max()
    points, force = x.reshape(3, -1).T, f.reshape(3, -1).T
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    assert np.abs(np.cross(points, force).sum(axis=0)).max() < 1e-12 * np.abs(force).sum() * 20.0


def test_lattice_forces_are_the_gradient():
    rng = np.random.default_rng(1)
    patch = p.ply_patch(7, 8, fractions=rng.uniform(0.0, 1.0, (6, 7)))
    x = _folded(rng)
    args = (patch.triple1, patch.triple2)
    f = np.zeros_like(x)
    for low, high in ((0, 2), (2, 7)):
        fold_lattice_forces(x, f, *args, 2.0, 2.5, 5.8, 1.0, low, high, np.zeros((2, 10)))
    energy, count = fold_lattice_energy(x, *args, (2.0, 2.5), 5.8, 1.0)
    assert energy > 0.1
    assert count > 5
    away = gradient(lambda y: fold_lattice_energy(y, *args, (2.0, 2.5), 5.8, 1.0)[0], x, 1e-5)
    assert np.abs(f + away).max() < 1e-6 * np.abs(f).max()


@pytest.mark.parametrize("cell", [1.0, 2.5, 5.0])
def test_least_chord_gives_the_contact_surface_its_least_radius(cell):
    """Curvature of the quadratic B-spline of three nodes in its middle: |x' x x''|/|x'|^3."""
    c, radius = least_chord(2.0 * cell, 2.0), 2.0
    height = np.sqrt(cell**2 - 0.25 * c**2)
    nodes = np.array([[-0.5 * c, 0.0], [0.0, height], [0.5 * c, 0.0]])
    first, second = 0.5 * (nodes[2] - nodes[0]), nodes[0] - 2.0 * nodes[1] + nodes[2]
    curvature = abs(first[0] * second[1] - first[1] * second[0]) / (first @ first) ** 1.5
    assert 1.0 / curvature == pytest.approx(radius, rel=1e-9)
