"""Wrinkles against sheets whose wrinkles are known."""

import numpy as np
import pytest
from formed_sheets import (
    FWHM,
    bend,
    cone_distance,
    corner_distance,
    edge_distance,
    folded,
    grid,
    omega,
    on_cone,
    plane_distance,
    ridge,
    sheet,
    taper,
)

from ddf.metrics import find_bridging, find_wrinkles

SLOPE = np.radians(54.7)


def crest_length(amplitude, length, ends, threshold=0.4):
    """Arc length of a tapered crest on a plane above the threshold, and the ends' place along it."""
    s = np.linspace(-0.5 * length, 0.5 * length, 20001)
    h = amplitude * taper(s, length, ends)
    keep = h > threshold
    return np.hypot(np.diff(s[keep]), np.diff(h[keep])).sum(), s[keep][-1]


def line_angle(degrees, expected):
    """Difference of two undirected directions."""
    return abs((degrees - expected + 90) % 180 - 90)


@pytest.mark.parametrize("spacing", [1.0, 2.0])
@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0])
@pytest.mark.parametrize(("amplitude", "sigma"), [(1.0, 4.0), (5.0, 4.0), (10.0, 3.0), (2.0, 8.0)])
def test_tapered_ridge_on_a_plane(spacing, angle, amplitude, sigma):
    u, v = grid(160, spacing)
    h = ridge(u, v, amplitude=amplitude, sigma=sigma, angle_deg=angle, length=100, ends=25, centre=(3, 5))
    result = find_wrinkles(sheet(np.stack([u, v, h]), plane_distance, spacing))
    assert result.count == 1
    wrinkle = result.wrinkles[0]
    length, end = crest_length(amplitude, 100, 25)
    assert wrinkle.length_mm == pytest.approx(length, rel=0.02)
    assert wrinkle.amplitude_mm == pytest.approx(amplitude, rel=0.01)
    assert wrinkle.width_mm == pytest.approx(FWHM * sigma, rel=0.02)
    assert line_angle(wrinkle.direction_deg, angle) < 1.0
    ends = np.array([3, 5]) + np.outer([-end, end], [np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    found = np.array([wrinkle.start[:2], wrinkle.end[:2]])
    found = found[np.argsort(found @ (ends[1] - ends[0]))]
    assert np.abs(found - ends).max() < 1.0
    assert wrinkle.section_area_mm2 / wrinkle.mean_amplitude_mm == pytest.approx(np.sqrt(2 * np.pi) * sigma, rel=0.04)
    if amplitude == 1:  # nearly unstretched: the angles to the fibres are the line's
        assert wrinkle.angle_to_family_1_deg == pytest.approx(angle, abs=1)
        assert wrinkle.angle_to_family_2_deg == pytest.approx(90 - angle, abs=1)


def test_wave_counts_every_crest_and_measures_from_trough_to_crest():
    u, v = grid(180, 2)
    result = find_wrinkles(sheet(np.stack([u, v, 2 * (1 + np.cos(2 * np.pi * u / 36))]), plane_distance))
    assert result.count == 5  # crests at 0, +-36, +-72
    for wrinkle in result.wrinkles:
        assert wrinkle.amplitude_mm == pytest.approx(4, rel=0.02)
        assert wrinkle.width_mm == pytest.approx(18, rel=0.02)
        assert wrinkle.length_mm == pytest.approx(180, rel=0.01)
        assert wrinkle.angle_to_family_2_deg < 1


def test_two_neighbours_are_two():
    u, v = grid(160, 2)
    h = sum(ridge(u, v, amplitude=a, sigma=3, length=80, ends=15, centre=(0, y)) for a, y in ((5, -9), (3, 9)))
    result = find_wrinkles(sheet(np.stack([u, v, h]), plane_distance))
    assert [w.amplitude_mm for w in result.wrinkles] == pytest.approx([5, 3], rel=0.03)
    assert [w.start[1] for w in result.wrinkles] == pytest.approx([-9, 9], abs=0.5)


def test_radial_ridges_on_a_cone():
    u, v = grid(200, 2)
    r, around = np.hypot(u, v) * np.cos(SLOPE), np.arctan2(v, u)
    directions = np.array([0.0, 45.0, 120.0, 225.0])
    h = np.zeros_like(u)
    for angle in np.radians(directions):
        section = np.exp(-0.5 * (r * np.sin(around - angle) / 2.5) ** 2) * (np.cos(around - angle) > 0)
        h += 5 * section * taper(r / np.cos(SLOPE) - 65, 60, 15)
    result = find_wrinkles(
        sheet(on_cone(r * np.cos(around), r * np.sin(around), h, 80, SLOPE), cone_distance(80, SLOPE))
    )
    assert result.count == 4
    length, end = crest_length(5, 60, 15)
    # the flanks stand off the cone: lines on it 1 apart at radius r are 1 + h sin(slope)/r apart at height h
    width = FWHM * 2.5 * (1 + 2.5 * np.sin(SLOPE) / (65 * np.cos(SLOPE)))
    for wrinkle in result.wrinkles:
        assert np.abs(line_angle(wrinkle.direction_deg, directions)).min() < 1
        assert wrinkle.angle_to_radial_deg < 1
        assert wrinkle.length_mm == pytest.approx(length, rel=0.03)
        assert wrinkle.amplitude_mm == pytest.approx(5, rel=0.02)
        assert wrinkle.width_mm == pytest.approx(width, rel=0.05)
        inner = (65 - end) * np.cos(SLOPE) + 0.4 * np.sin(SLOPE)
        assert wrinkle.start_radius_mm == pytest.approx(inner, abs=1.0)


@pytest.mark.parametrize("angle", [0.0, 30.0])
@pytest.mark.parametrize(("lean", "amplitude"), [(0.0, 10.0), (0.4, 6.0), (0.7, 10.0), (0.7, 15.0)])
def test_overhanging_fold(angle, lean, amplitude):
    u, v = grid(160, 2)
    profile = omega(amplitude, lean)
    result = find_wrinkles(sheet(folded(u, v, profile, angle), plane_distance))
    assert result.count == 1
    wrinkle = result.wrinkles[0]
    arc, y, z = profile
    high = z > 0.5 * z.max()
    assert wrinkle.amplitude_mm == pytest.approx(amplitude, rel=0.02)
    assert wrinkle.length_mm == pytest.approx(160 / np.cos(np.radians(angle)), rel=0.01)
    assert wrinkle.width_mm == pytest.approx(y[high][-1] - y[high][0], rel=0.05)
    assert wrinkle.arc_mm == pytest.approx(arc[high][-1] - arc[high][0], rel=0.05)
    assert wrinkle.elements_across == pytest.approx(wrinkle.arc_mm / 2)
    assert wrinkle.angle_to_family_1_deg == pytest.approx(angle, abs=1.5)


SMOOTH = {
    "plane": lambda u, v, n: sheet(np.stack([u, v, n]), plane_distance),
    "plane without distance": lambda u, v, n: sheet(np.stack([u, v, n])),
    "cone": lambda u, v, n: sheet(on_cone(u, v, n, 80, SLOPE), cone_distance(80, SLOPE)),
    "paraboloid without distance": lambda u, v, n: sheet(np.stack([u, v, n - (u**2 + v**2) / 400])),
    # the tool's edge has a radius of 5 mm, 2 mm inside the sheet: its distance is the sheet's and 2 mm
    "rounded edge": lambda u, v, n: sheet(
        bend(u, v, n, -1.2, 7.0), lambda p: edge_distance(-1.2, 7.0)(p) + 2, offset_mm=2.0
    ),
    "hollow corner": lambda u, v, n: sheet(bend(u, v, n, SLOPE, 40.0), corner_distance(SLOPE, 40.0)),
    "sharply spanned corner": lambda u, v, n: sheet(bend(u, v, n, SLOPE, 20.0), corner_distance(SLOPE, 20.0)),
}


@pytest.mark.parametrize("noise_mm", [0.0, 0.05])
@pytest.mark.parametrize("shape", SMOOTH)
def test_smooth_sheet_has_no_wrinkle(shape, noise_mm):
    u, v = grid(160, 2)
    surface = SMOOTH[shape](u, v, noise_mm * np.random.default_rng(1).standard_normal(u.shape))
    result = find_wrinkles(surface)
    assert result.count == 0
    assert not result.mask.any()
    assert result.area_percent == 0


def test_noise_hardly_changes_a_wrinkle():
    u, v = grid(160, 2)
    h = ridge(u, v, amplitude=4, sigma=4, angle_deg=30, length=100, ends=25)
    h += 0.05 * np.random.default_rng(2).standard_normal(h.shape)
    result = find_wrinkles(sheet(np.stack([u, v, h]), plane_distance))
    assert result.count == 1
    assert result.wrinkles[0].amplitude_mm == pytest.approx(4, rel=0.06)
    assert result.wrinkles[0].length_mm == pytest.approx(crest_length(4, 100, 25)[0], rel=0.04)
    assert result.wrinkles[0].width_mm == pytest.approx(FWHM * 4, rel=0.04)


def test_ridge_next_to_bridging_gives_both():
    u, v = grid(160, 2)
    h = ridge(u, v, amplitude=5, sigma=3, angle_deg=90, length=80, ends=15, centre=(-40, 0))
    surface = sheet(bend(u, v, h, SLOPE, 40.0, flat_to=-20 * SLOPE), corner_distance(SLOPE, 40.0, -20 * SLOPE))
    result = find_wrinkles(surface)
    bridging = find_bridging(surface, result.mask)
    assert result.count == 1
    assert result.wrinkles[0].amplitude_mm == pytest.approx(5, rel=0.02)
    assert result.wrinkles[0].start[0] == pytest.approx(-40, abs=0.5)
    assert bridging.largest_mm == pytest.approx(40 * (1 - np.cos(0.5 * SLOPE)), rel=0.02)


def test_ridge_across_bridging_is_measured_from_the_spanning_sheet():
    u, v = grid(160, 2)
    h = ridge(u, v, amplitude=5, sigma=3, length=110, ends=15)
    surface = sheet(bend(u, v, h, SLOPE, 40.0, flat_to=-19.0), corner_distance(SLOPE, 40.0, -19.0))
    result = find_wrinkles(surface)
    assert result.count == 1
    assert result.wrinkles[0].amplitude_mm == pytest.approx(5, rel=0.02)
    assert result.wrinkles[0].angle_to_family_1_deg < 1
    assert find_bridging(surface, result.mask).largest_mm == pytest.approx(40 * (1 - np.cos(0.5 * SLOPE)), rel=0.05)


@pytest.mark.parametrize("angle", [30.0, 50.0])
def test_ridge_oblique_to_bridging_is_neither_led_astray_nor_heightened(angle):
    u, v = grid(160, 2)
    h = ridge(u, v, amplitude=3, sigma=3, angle_deg=angle, length=110, ends=15)
    surface = sheet(bend(u, v, h, SLOPE, 25.0, flat_to=-12.0), corner_distance(SLOPE, 25.0, -12.0))
    result = find_wrinkles(surface)
    assert result.count == 1
    assert result.wrinkles[0].amplitude_mm == pytest.approx(3, rel=0.05)
    assert result.wrinkles[0].length_mm == pytest.approx(crest_length(3, 110, 15)[0], rel=0.05)
    assert result.wrinkles[0].width_mm == pytest.approx(FWHM * 3, rel=0.05)


def test_fold_along_a_convex_edge_is_a_wrinkle():
    u, v = grid(160, 2)
    h = ridge(u, v, amplitude=6, sigma=3, angle_deg=90, length=80, ends=15, centre=(3.5, 0))
    surface = sheet(bend(u, v, h, -1.0, 7.0), edge_distance(-1.0, 7.0))
    result = find_wrinkles(surface)
    assert result.count == 1
    assert result.wrinkles[0].amplitude_mm == pytest.approx(6, rel=0.02)
    assert result.wrinkles[0].length_mm == pytest.approx(crest_length(6, 80, 15)[0], rel=0.03)


@pytest.mark.parametrize("amplitude", [3.0, 8.0])
def test_without_a_distance_the_base_is_fitted(amplitude):
    u, v = grid(160, 2)
    h = ridge(u, v, amplitude=amplitude, sigma=3, angle_deg=30, length=100, ends=25)
    result = find_wrinkles(sheet(np.stack([u, v, h + u * v / 400])))
    assert result.count == 1
    assert result.wrinkles[0].amplitude_mm == pytest.approx(amplitude, rel=0.05)
    assert result.wrinkles[0].length_mm == pytest.approx(crest_length(amplitude, 100, 25)[0], rel=0.05)


def test_ply_cut_askew_ends_its_wrinkles_at_the_outline():
    u, v = grid(160, 2)
    n = len(u)
    inside = np.abs(u) + np.abs(v) <= 79
    x = np.where(inside, np.stack([u, v, ridge(u, v, amplitude=4, sigma=3)]), np.nan)
    half = 0.5 * (n - 1)
    outline = half + np.array([[39, 0], [0, 39], [-39, 0], [0, -39]])
    cells = inside[1:, 1:] & inside[1:, :-1] & inside[:-1, 1:] & inside[:-1, :-1]
    fraction = np.where(cells, 1.0, 0.5 * (inside[1:, 1:] | inside[1:, :-1] | inside[:-1, 1:] | inside[:-1, :-1]))
    surface = sheet(x, plane_distance, active=inside, cell_fraction=fraction, outline=[outline], corners=[np.arange(4)])
    result = find_wrinkles(surface)
    assert result.count == 1
    assert result.wrinkles[0].length_mm == pytest.approx(156, rel=0.03)
    assert result.wrinkles[0].amplitude_mm == pytest.approx(4, rel=0.02)


def test_mask_covers_the_ridge_above_the_threshold():
    u, v = grid(160, 1)
    result = find_wrinkles(sheet(np.stack([u, v, ridge(u, v, amplitude=4, sigma=4)]), plane_distance, 1.0))
    width = 2 * 4 * np.sqrt(2 * np.log(10))
    assert result.area_percent == pytest.approx(100 * width / 160, rel=0.08)
    assert result.height.max() == pytest.approx(4, rel=0.01)


def test_thresholds_are_kept():
    u, v = grid(120, 2)
    surface = sheet(np.stack([u, v, ridge(u, v, amplitude=1, sigma=3, length=40, ends=10)]), plane_distance)
    assert find_wrinkles(surface).count == 1
    assert find_wrinkles(surface, threshold_mm=1.1).count == 0
    assert find_wrinkles(surface, min_length_mm=45).count == 0


@pytest.mark.parametrize(("spacing", "sigma"), [(1.0, 2.0), (1.0, 3.0), (1.0, 4.0), (2.0, 3.0), (2.0, 4.0)])
@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_two_crests_side_by_side_are_one_fold_or_two_and_never_none(spacing, angle, sigma):
    """Equal ridges that come apart: one fold as high as it is, then two, each over the dip between them."""
    u, v = grid(120, spacing)
    counts = []
    for gap in sigma * np.array([1.5, 2.0, 2.25, 2.5, 2.75, 3.5, 4.0, 4.5]):
        shift = 0.5 * gap * np.array([-np.sin(np.radians(angle)), np.cos(np.radians(angle))])
        pair = [ridge(u, v, amplitude=4.0, sigma=sigma, angle_deg=angle, centre=tuple(s * shift)) for s in (-1, 1)]
        result = find_wrinkles(sheet(np.stack([u, v, sum(pair)]), plane_distance, spacing))
        counts.append(result.count)
        dip = 8.0 * np.exp(-0.5 * (0.5 * gap / sigma) ** 2)
        whole = 4.0 * (1.0 + np.exp(-0.5 * (gap / sigma) ** 2)) if gap > 2.0 * sigma else dip
        if result.count == 1:
            assert result.largest_amplitude_mm == pytest.approx(whole, rel=0.06), gap
        else:
            assert result.count == 2, gap
            assert whole - dip < result.largest_amplitude_mm < 1.02 * whole
    assert counts == sorted(counts)
    assert counts[:3] == [1, 1, 1]
    assert counts[-1] == 2


@pytest.mark.parametrize("width", [6.0, 10.0, 16.0, 20.0])
def test_a_fold_that_is_flat_on_top(width):
    u, v = grid(120, 2.0)
    result = find_wrinkles(sheet(np.stack([u, v, 4.0 * np.exp(-np.log(2) * (2.0 * v / width) ** 4)]), plane_distance))
    assert result.count == 1
    assert result.largest_amplitude_mm == pytest.approx(4.0, rel=0.05)
    assert result.wrinkles[0].width_mm == pytest.approx(width, rel=0.05)
