"""In-plane forces of the pressure through a sheet's thickness."""

import numpy as np
import pytest
from differences import gradient

from ddf.elements.squeeze import SCRATCH, squeeze_forces

SPACING, THICKNESS = (2.0, 1.5), 0.8


def _sheet(rng, shape=(6, 5)):
    u, v = np.meshgrid(*(np.arange(n) * a for n, a in zip(shape, SPACING, strict=True)), indexing="ij")
    return np.array([u, v, 0.05 * u * v]) + rng.normal(size=(3, *shape)) * 0.1


def _cells(shape):
    cell = np.zeros(shape)
    cell[:-1, :-1] = SPACING[0] * SPACING[1]
    return cell


def _inverse_area(cell):
    """One over the area of each node: a quarter of the cells around it."""
    p = np.pad(cell[:-1, :-1], 1)
    area = 0.25 * (p[1:, 1:] + p[:-1, 1:] + p[1:, :-1] + p[:-1, :-1])
    return np.where(area > 0.0, 1.0 / np.where(area > 0.0, area, 1.0), 0.0)


def _forces(x, v, press, seam=None, cell=None):
    n, m = x.shape[1:]
    f, power = np.zeros_like(x), 0.0
    cell = _cells((n, m)) if cell is None else cell
    for low, high in ((0, n),) if seam is None else ((0, seam), (seam, n)):
        power += squeeze_forces(
            x, v, f, cell, SPACING[0] * SPACING[1], press, _inverse_area(cell), THICKNESS, low, high, np.zeros(SCRATCH)
        )
    return f, power


def _areas(x):
    d1, d2 = x[:, 1:, 1:] - x[:, :-1, :-1], x[:, :-1, 1:] - x[:, 1:, :-1]
    return 0.5 * np.sqrt((np.cross(d1, d2, axis=0) ** 2).sum(axis=0))


def test_force_is_the_gradient_of_pressure_on_the_volume_of_the_layer():
    """P fixed on each cell: dU = -P t0 A0 / (2 A^2) dA, so U = P t0 A0 / (2 A)."""
    rng = np.random.default_rng(0)
    x, press = _sheet(rng), rng.uniform(0.0, 2.0, (6, 5))
    on_area = press * _inverse_area(_cells(press.shape))
    load = 0.25 * SPACING[0] * SPACING[1] * (on_area[1:, 1:] + on_area[:-1, 1:] + on_area[1:, :-1] + on_area[:-1, :-1])
    assert load.sum() == pytest.approx(press.sum(), rel=1e-12)  # all of the contact force arrives

    def energy(y):
        return float(np.sum(load * THICKNESS * SPACING[0] * SPACING[1] / (2.0 * _areas(y))))

    f, _ = _forces(x, np.zeros_like(x), press)
    expected = -gradient(energy, x)
    assert np.abs(f - expected).max() < 1e-7 * np.abs(expected).max()


def test_forces_and_moments_balance_and_blocks_agree():
    rng = np.random.default_rng(1)
    x, v, press = _sheet(rng), rng.normal(size=(3, 6, 5)), rng.uniform(0.0, 2.0, (6, 5))
    f, power = _forces(x, v, press)
    scale = np.abs(f).sum()
    assert np.abs(f.sum(axis=(1, 2))).max() < 1e-13 * scale
    moment = np.cross(x.reshape(3, -1).T, f.reshape(3, -1).T).sum(axis=0)
    assert np.abs(moment).max() < 1e-13 * scale * np.abs(x).max()
    assert power == pytest.approx((f * v).sum(), rel=1e-12)
    split, again = _forces(x, v, press, seam=3)
    assert np.abs(split - f).max() < 1e-14 * np.abs(f).max()
    assert again == pytest.approx(power, rel=1e-12)


def test_a_stretched_sheet_holds_the_pressure_times_its_thickness():
    """Uniform pressure p on both faces of a flat sheet stretched to areas 1.3: edges feel N = -p t0 / 1.3."""
    p, stretch = 0.1, 1.3
    x = _sheet(np.random.default_rng(2), (9, 8))
    x[2] = 0.0
    u, v = np.meshgrid(np.arange(9) * SPACING[0], np.arange(8) * SPACING[1], indexing="ij")
    x[0], x[1] = u * stretch, v
    press = 2.0 * p * stretch / _inverse_area(_cells((9, 8)))  # two contacts
    f, _ = _forces(x, np.zeros_like(x), press)
    width = SPACING[1]
    assert f[0, -1, 3] == pytest.approx(p * THICKNESS / stretch * width, rel=1e-12)  # pushes outwards
    assert np.abs(f[:, 1:-1, 1:-1]).max() < 1e-15


@pytest.mark.parametrize("share", [1.0, 0.5, 0.1])
def test_cells_that_an_outline_cuts_hold_the_pressure_on_their_cloth(share):
    """Pressure p on a flat sheet whose last row of cells has so much cloth: that row holds share p t0/2 a width."""
    p, x = 0.1, _sheet(np.random.default_rng(2), (9, 8))
    u, v = np.meshgrid(np.arange(9) * SPACING[0], np.arange(8) * SPACING[1], indexing="ij")
    x[0], x[1], x[2] = u, v, 0.0
    cell = _cells((9, 8))
    cell[7] *= share
    f, _ = _forces(x, np.zeros_like(x), p / _inverse_area(cell), cell=cell)
    line = 0.5 * p * THICKNESS * SPACING[1]
    assert f[0, 8, 1:-1] == pytest.approx(share * line, rel=1e-12)
    assert f[0, 7, 1:-1] == pytest.approx((1.0 - share) * line, rel=1e-12, abs=1e-15)
    assert f[0, 0, 1:-1] == pytest.approx(-line, rel=1e-12)


def test_two_layers_on_a_drum_hand_on_the_pressure_and_not_more():
    """Outer sheet R + t, inner R, t apart: p on the outer one is p on the drum, to the second order in t / R.

    Without the in-plane part it would be p (1 + t / R).
    """
    p, radius, t, n, m = 0.1, 12.0, 1.5, 41, 6
    angle = np.linspace(-0.6, 0.6, n)

    def sheet(r):
        across, along = np.ones(m), np.outer(np.ones(n), np.arange(m))
        return np.array([np.outer(r * np.sin(angle), across), along, np.outer(r * np.cos(angle), across)])

    def outwards(r, force):
        """Radial force of the in-plane pressure on a node amid a sheet pressed with `force` a node; cells at rest."""
        x = sheet(r)
        cell = np.zeros((n, m))
        cell[:-1, :-1] = 2.0 * r * np.sin(0.5 * (angle[1] - angle[0]))
        f = np.zeros_like(x)
        spread = np.full((n, m), 1.0 / cell[0, 0])
        squeeze_forces(x, np.zeros_like(x), f, cell, 0.0, np.full((n, m), force), spread, t, 0, n, np.zeros(SCRATCH))
        return f[2, n // 2, 2]

    step = angle[1] - angle[0]
    load = p * (radius + t) * step  # on a node of the outer sheet
    contact = load - outwards(radius + t, load)
    drum = contact - outwards(radius, contact)
    assert load / (radius * step) == pytest.approx(p * (1.0 + t / radius), rel=1e-9)
    assert drum / (radius * step) == pytest.approx(p, rel=1.5 * (t / radius) ** 2)
