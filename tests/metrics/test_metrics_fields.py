"""Outline, draw-in, shear, fibre strain and bridging against closed forms."""

import json

import numpy as np
import pytest
from formed_sheets import bend, corner_distance, grid, plane_distance, ridge, sheet

from ddf.metrics import (
    boundary_profile,
    draw_in,
    fibre_strain_range,
    find_bridging,
    outline_area,
    outline_length,
    ply_metrics,
    shear_angle,
    shear_statistics,
)
from ddf.metrics.shear import weighted_percentile


def linear(u, v, matrix):
    """A flat sheet mapped by a 2 x 2 matrix."""
    return np.stack([*np.einsum("ab,bij->aij", np.array(matrix), np.stack([u, v])), 0 * u])


def trellis(u, v, shear):
    """Both fibre families turned towards the diagonal by half the shear angle, unstretched."""
    c, s = np.cos(0.5 * shear), np.sin(0.5 * shear)
    return linear(u, v, [[c, s], [s, c]])


def test_uniform_scaling():
    u, v = grid(100, 2)
    surface = sheet(linear(u, v, [[0.9, 0], [0, 0.9]]))
    profile, initial = boundary_profile(surface)
    assert outline_area(profile) == pytest.approx(8100)
    assert outline_area(initial) == pytest.approx(10000)
    assert outline_length(profile) == pytest.approx(360)
    inward = draw_in(surface)
    assert inward["mid_side"] == pytest.approx({"0deg": 5, "90deg": 5, "180deg": 5, "270deg": 5})
    assert inward["corner"] == pytest.approx({f"{a}deg": 5 * np.sqrt(2) for a in (45, 135, 225, 315)})
    assert fibre_strain_range(surface) == pytest.approx((np.log(0.9), np.log(0.9)))


def test_trellis_shear():
    u, v = grid(100, 2)
    g = np.radians(40)
    surface = sheet(trellis(u, v, g))
    assert shear_angle(surface) == pytest.approx(40)
    statistics = shear_statistics(surface)
    assert all(value == pytest.approx(40) for value in statistics.values())
    assert fibre_strain_range(surface) == pytest.approx((0, 0), abs=1e-12)
    assert outline_area(boundary_profile(surface)[0]) == pytest.approx(10000 * np.cos(g))
    inward = draw_in(surface)
    assert inward["mid_side"]["0deg"] == pytest.approx(50 * (1 - np.cos(0.5 * g)))
    half = 50 * np.sqrt(2)
    assert inward["corner"]["135deg"] == pytest.approx(half * (1 - np.cos(0.5 * g) + np.sin(0.5 * g)))
    assert inward["corner"]["45deg"] == pytest.approx(half * (1 - np.cos(0.5 * g) - np.sin(0.5 * g)))


def test_shear_statistics_weight_by_area_and_leave_out_empty_cells():
    u, v = grid(100, 2)
    x = trellis(u, v, np.radians(20))
    x[:, :26] = trellis(u, v, 0)[:, :26]
    fraction = np.ones((50, 50))
    fraction[25:26] = 0  # the row between the two halves
    fraction[26:] = 0.5
    surface = sheet(x, cell_fraction=fraction)
    statistics = shear_statistics(surface)
    assert statistics["shear_mean_deg"] == pytest.approx(20 * 12 / 37)
    assert statistics["shear_rms_deg"] == pytest.approx(20 * np.sqrt(12 / 37))
    assert statistics["shear_max_deg"] == pytest.approx(20)
    assert np.isnan(shear_angle(surface, blank=np.nan)[25]).all()


def test_weighted_percentile():
    values, weights = np.arange(1.0, 101), np.ones(100)
    assert weighted_percentile(values, weights, 95) == 95
    assert weighted_percentile(values, weights, 100) == 100
    assert weighted_percentile(np.array([1.0, 2.0]), np.array([99.0, 1.0]), 95) == 1


def test_outline_with_a_hole_and_points_inside_cells():
    u, v = grid(100, 2)
    outer = np.array([[0, 0], [50, 0], [50, 50], [0, 50], [0, 0]], float)
    hole = np.array([[20.3, 20.3], [29.7, 20.3], [29.7, 29.7], [20.3, 29.7]])
    surface = sheet(linear(u, v, [[1, 0], [0, 1]]), outline=[outer, hole], corners=[np.arange(4), np.arange(4)])
    deformed, _ = boundary_profile(surface)
    assert outline_area(deformed) == pytest.approx(10000 - 18.8**2)
    assert deformed[1][0] == pytest.approx([-9.4, -9.4, 0])


def test_outline_askew_to_the_fibres_and_turned_clockwise():
    u, v = grid(100, 2)
    diamond = 25 + np.array([[24, 0], [0, -24], [-24, 0], [0, 24]], float)
    surface = sheet(linear(u, v, [[0.5, 0], [0, 1]]), outline=[diamond], corners=[np.arange(4)])
    inward = draw_in(surface)
    assert inward["corner"] == pytest.approx({"0deg": 24, "270deg": 0, "180deg": 24, "90deg": 0})
    assert inward["mid_side"] == pytest.approx({f"{a}deg": 12 / np.sqrt(2) for a in (45, 135, 225, 315)})


def test_bridging_over_a_hollow_corner():
    u, v = grid(160, 2)
    slope, radius = np.radians(54.7), 40.0
    surface = sheet(bend(u, v, 0 * u, slope, radius, -20 * slope), corner_distance(slope, radius, -20 * slope))
    bridging = find_bridging(surface)
    assert bridging.largest_mm == pytest.approx(radius * (1 - np.cos(0.5 * slope)), rel=0.005)
    # gap over the arc: R (1 - cos t) up to the middle, twice
    mean = 2 * radius**2 * (0.5 * slope - np.sin(0.5 * slope)) / 160
    assert bridging.mean_mm == pytest.approx(mean, rel=0.02)
    touching = np.arccos(1 - 0.5 / radius)
    assert bridging.area_percent == pytest.approx(100 * radius * (slope - 2 * touching) / 160, abs=2)


def test_bridging_is_unknown_without_a_distance():
    u, v = grid(40, 2)
    assert np.isnan(find_bridging(sheet(np.stack([u, v, 0 * u]))).largest_mm)


def test_summary_is_ready_for_json():
    u, v = grid(120, 2)
    x = np.stack([u, v, ridge(u, v, amplitude=4, sigma=3, length=80, ends=15)])
    table = ply_metrics(sheet(x, plane_distance))
    again = json.loads(json.dumps(table, allow_nan=False))
    assert again == table
    assert table["wrinkle_count"] == 1
    assert table["wrinkle_largest_amplitude_mm"] == pytest.approx(4, rel=0.02)
    assert table["bridging_largest_mm"] < 0.5
    assert table["draw_in_corner_mm"]["45deg"] == pytest.approx(0, abs=1e-9)
    assert len(table["wrinkles"]) == 1
    flat = ply_metrics(sheet(np.stack([u, v, 0 * u])))
    assert flat["wrinkle_count"] == 0
    assert flat["elements_per_wrinkle_smallest"] is None
    assert flat["bridging_mean_mm"] is None
    json.dumps(flat, allow_nan=False)
