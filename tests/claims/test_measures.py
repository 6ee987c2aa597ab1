"""Measures of wrinkles, and what chance gives."""

import numpy as np
import pytest
from stars import formed, square, star, wrinkle

from ddf.claims.measures import (
    RADIAL_CHANCE_DEG,
    angle_to_fibres,
    any_fibre_angle,
    below_chance,
    directions_with_wrinkles,
    radial_angle,
    same_site,
    severity,
    share_by_chance,
    share_found,
    turned_row,
)

AXIS = (0.0, 0.0)


@pytest.mark.parametrize("count", [2, 5, 20])
def test_random_directions_rarely_count_as_radial(count):
    random = np.random.default_rng(1)
    passed = 0
    for _ in range(400):
        lengths = random.uniform(20, 150, count)
        rows = [wrinkle(0, turn_deg=random.uniform(-90, 90), radii=(20, 20 + length)) for length in lengths]
        passed += radial_angle(rows) < below_chance(rows, RADIAL_CHANCE_DEG)
    assert passed <= 0.065 * 400  # 5 % and what 400 draws scatter by


@pytest.mark.parametrize("spacing", [3.0, 6.0])
def test_outlines_shear_and_fibres_do_not_depend_on_the_grid(spacing):
    ply = star(45, (), surface=square(45, spacing, inward=lambda x, y: 0.1 + 0 * x, shear=np.radians(20)))
    assert ply.outline_change_mm == pytest.approx(
        star(45, (), surface=square(45, 1.5, inward=lambda x, y: 0.1, shear=np.radians(20))).outline_change_mm, rel=2e-3
    )
    assert ply.fibre_directions_deg == pytest.approx((45.0, 135.0))
    # family 2 leans by x0 tan(20) over 0.9 x0 towards family 1
    lean = np.degrees(np.arctan(np.tan(np.radians(20)) / 0.9))
    assert ply.shear_rms_deg == pytest.approx(lean, rel=1e-6)
    assert angle_to_fibres(wrinkle(45), ply) == pytest.approx(0.0, abs=1e-6)
    assert angle_to_fibres(wrinkle(135 - lean), ply) == pytest.approx(0.0, abs=1e-6)
    assert angle_to_fibres(wrinkle(135), ply) == pytest.approx(lean, rel=1e-6)


def test_form_of_an_outline_is_free_of_size_and_place():
    shrunk = star(0, (), surface=square(0, inward=lambda x, y: 0.1))
    assert shrunk.outline_change_mm == pytest.approx(15.0, rel=0.02)
    assert shrunk.outline_form_change_mm == pytest.approx(0.0, abs=1e-6)


def test_severity_of_a_star():
    found = severity([star(0, (0, 90), amplitude=5, percent=8), star(45, (45,), amplitude=9, percent=4)])
    assert found.ridge_mm2 == pytest.approx(0.7 * 80 * (5 + 5 + 9))
    assert (found.largest_mm, found.area_percent) == (9, 6)


def test_nearest_fibres_of_a_stack():
    stack = [star(45, (0, 45)), star(0, (45, 90))]
    assert any_fibre_angle(stack) == pytest.approx(0.0, abs=1e-6)
    assert any_fibre_angle([star(45, (22.5,)), star(0, (22.5,))]) == pytest.approx(22.5, abs=1e-6)
    assert directions_with_wrinkles(formed(*stack)) == (3, 4)


def test_sites():
    assert same_site(wrinkle(0), wrinkle(5))
    assert same_site(wrinkle(0), wrinkle(0, radii=(60, 90)))  # a part of it
    assert not same_site(wrinkle(0), wrinkle(30))
    assert not same_site(wrinkle(0), wrinkle(180))
    assert not same_site(wrinkle(0), wrinkle(0, radii=(75, 85), turn_deg=90))  # across it
    turned = turned_row(wrinkle(10), 35, AXIS)
    assert (turned["start_x_mm"], turned["end_y_mm"]) == pytest.approx(
        (wrinkle(45)["start_x_mm"], wrinkle(45)["end_y_mm"])
    )


def test_chance_of_common_sites():
    rows = [wrinkle(azimuth) for azimuth in (0, 90, 180, 270)]
    assert share_found(rows, [rows]) == 1.0
    assert share_found(rows, [rows, rows[:2]]) == 0.75
    chance = share_by_chance(rows, [rows], AXIS)
    # a wrinkle 80 mm out meets another within asin(15/80) either way: one in eight, so of four seldom more than half
    assert chance in (0.25, 0.5, 0.75)
    crowd = [wrinkle(azimuth) for azimuth in range(0, 360, 10)]
    assert share_by_chance(rows, [crowd], AXIS) == 1.0  # where wrinkles are everywhere a common site says nothing
    assert share_by_chance(rows, [[]], AXIS) == 0.0
