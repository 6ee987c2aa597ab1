"""Shear laws of woven plies: published values, the monotone law, tables, and what the kernel makes of them."""

import numpy as np
import pytest

from ddf.elements.shear import SCRATCH, shear_forces
from ddf.materials.shear_law import (
    LARGEST_SINE,
    largest_tangent,
    monotone,
    polynomial_law,
    shear_samples,
    shear_table,
    table_law,
)

POLYNOMIAL = [0.4576, -7.394, 36.36, -59.31, 32.37]
ANGLES = np.arange(5.0, 61.0, 5.0)
FORCES = [0.00950, 0.00949, 0.01110, 0.01909, 0.03379, 0.05308, 0.07436, 0.09648, 0.12176, 0.15791, 0.22002, 0.33253]
FLOOR = 0.002


def _law(name, floor=FLOOR):
    return shear_samples(name, 0.5, floor, POLYNOMIAL, None)


def test_published_values():
    assert polynomial_law(POLYNOMIAL, 0.5, np.deg2rad(ANGLES)) == pytest.approx(FORCES, abs=6e-6)
    angle, force = _law("published")
    assert np.interp(np.deg2rad(ANGLES), angle, force) == pytest.approx(FORCES, abs=1e-5)


def test_published_law_softens_where_it_is_known_to():
    angle, force = _law("published")
    slope = np.gradient(force, angle) / 0.5
    falling = np.rad2deg(angle[slope < 0.0])
    assert falling.min() == pytest.approx(6.77, abs=0.03)
    assert falling.max() == pytest.approx(10.84, abs=0.03)
    assert slope.min() == pytest.approx(-0.0172, abs=1e-4)
    assert np.rad2deg(angle[slope.argmin()]) == pytest.approx(8.70, abs=0.05)


@pytest.mark.parametrize("floor", [0.0, FLOOR, 0.01])
def test_monotone_law_keeps_its_floor(floor):
    angle, force = _law("monotone", floor)
    assert np.diff(force).min() >= 0.5 * floor * angle[1] * (1.0 - 1e-9) - 1e-15


@pytest.mark.parametrize("forces", [[0.0, 0.02, 0.1, 0.33], [0.0, 0.2, 0.21, 0.21], [0.0, 0.3, 0.2, 0.1]])
def test_a_monotone_table_goes_on_without_a_drop(forces):
    """Tables that flatten are raised up to 75 degrees, where N_s cos g has to rise; they do not fall back there."""
    angle, force = shear_samples("monotone", 0.5, FLOOR, None, ([0.0, 20.0, 40.0, 60.0], forces))
    assert np.diff(force).min() >= 0.0
    raw = shear_samples("published", 0.5, FLOOR, None, ([0.0, 20.0, 40.0, 60.0], forces))[1]
    beyond = angle > np.deg2rad(75.5)
    assert np.diff(force[beyond]) == pytest.approx(np.maximum(np.diff(raw[beyond]), 0.0), abs=1e-12)


def test_monotone_law_is_close_to_the_published_one():
    angle, changed = _law("monotone")
    published = _law("published")[1]
    inside = angle <= np.deg2rad(60.0)
    off = np.abs(changed - published)
    assert off[inside].max() < 6e-4
    assert off[inside].max() > 1e-4  # it does change something
    assert off[angle > np.deg2rad(20.0)].max() < 1e-12


def test_monotone_is_the_closest_such_law():
    angle = np.linspace(0.0, 1.0, 201)
    force = np.sin(8.0 * angle) + angle
    best = monotone(angle, force, 0.3)
    rng = np.random.default_rng(0)
    for _ in range(50):
        other = best + 0.3 * np.cumsum(rng.uniform(0.0, 0.01, angle.size)) - rng.uniform(0.0, 0.3)
        assert ((best - force) ** 2).sum() < ((other - force) ** 2).sum()


def test_table_law_goes_through_its_points_and_on_linearly():
    points, values = [0.0, 20.0, 40.0, 60.0], [0.0, 0.02, 0.1, 0.33]
    assert table_law(points, values, np.deg2rad(points)) == pytest.approx(values, abs=1e-15)
    fine = table_law(points, values, np.deg2rad(np.linspace(0.0, 80.0, 400)))
    assert (np.diff(fine) >= 0.0).all()
    beyond = table_law(points, values, np.deg2rad([60.0, 65.0, 70.0]))
    assert np.diff(beyond)[0] == pytest.approx(np.diff(beyond)[1], rel=1e-12)
    assert np.diff(beyond)[0] > 0.0


def test_a_law_needs_data():
    with pytest.raises(ValueError, match="coefficients or a table"):
        shear_samples("monotone", 0.5, FLOOR, None, None)


def test_table_of_cubics_is_smooth_and_integrates_itself():
    table = shear_table(*_law("monotone"))
    ends = table[:-1, :4].sum(axis=1)
    assert ends[:-1] == pytest.approx(table[1:-1, 0], abs=1e-12)
    width = table[-1, 0]
    assert width * (table.shape[0] - 1) == pytest.approx(LARGEST_SINE)
    steps = width * (table[:-1, :4] @ [1.0, 1 / 2, 1 / 3, 1 / 4])
    assert np.diff(table[:-1, 4]) == pytest.approx(steps[:-1], rel=1e-11, abs=1e-15)


def test_largest_tangent():
    angle = np.linspace(0.0, 1.2, 2001)
    assert largest_tangent(angle, 3.0 * angle) == pytest.approx(3.0)
    assert largest_tangent(*_law("published")) == pytest.approx(
        0.5 * np.polynomial.polynomial.polyval(np.pi / 3, POLYNOMIAL), rel=1e-2
    )


def _frame_force(angle, table, side=10.0, cells=5):
    """Crosshead force [N] of a picture frame: the power of the nodal forces in pure trellis shear."""
    a = side / cells
    line = np.arange(cells + 1) * a
    u, v = np.meshgrid(line, line, indexing="ij")
    half = 0.5 * (0.5 * np.pi - angle)  # the diagonal along x; the fibres at +- half

    def frame(h):
        return np.array([(u + v) * np.cos(h), (u - v) * np.sin(h), 0.0 * u])

    cell = np.zeros(u.shape)
    cell[:-1, :-1] = a * a
    f = np.zeros((3, *u.shape))
    x = frame(half)
    shear_forces(x, f, cell, table, 0, cells + 1, np.zeros(SCRATCH))
    motion = (frame(half + 1e-6) - frame(half - 1e-6)) / 2e-6
    crosshead = -2.0 * side * np.sin(half)  # of the diagonal 2 L cos(half), per change of half
    return -np.sum(f * motion) / crosshead


@pytest.mark.parametrize("law", ["published", "monotone"])
def test_picture_frame_traces_the_law(law):
    angle, force = _law(law)
    table, side = shear_table(angle, force), 10.0
    for degrees in ANGLES:
        g = np.deg2rad(degrees)
        measured = _frame_force(g, table, side) / (2.0 * np.cos(0.5 * (0.5 * np.pi - g)) * side)
        assert measured == pytest.approx(np.interp(g, angle, force), rel=2e-3)
