"""Distances, fits, sites and fields of comparisons against answers known by hand."""

import numpy as np
import pytest

from ddf.compare.fields import shear_difference
from ddf.compare.outlines import fit_points, outline_distances, point_distances, read_points
from ddf.compare.sites import apart, match_wrinkles
from ddf.errors import UsageError
from ddf.metrics import PlySurface


def circle(radius, centre=(0.0, 0.0), points=720):
    t = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return np.stack([radius * np.cos(t), radius * np.sin(t)], axis=1) + centre


def wrinkle(number, start, end, amplitude=1.0):
    return {
        "number": number, "ply": "ply-1", "amplitude_mm": amplitude,
        "length_mm": float(np.hypot(*np.subtract(end, start))),
        "direction_deg": 0.0, "start_x_mm": start[0], "start_y_mm": start[1], "end_x_mm": end[0], "end_y_mm": end[1],
    }  # fmt: skip


def sheared(cells, size, slope_deg_mm):
    """A ply whose family 2 leans more and more along x: shear angle g = slope * x."""
    a = size / cells
    x0 = np.stack(np.meshgrid(np.arange(cells + 1) * a, np.arange(cells + 1) * a, [0.0], indexing="ij"))[..., 0]
    x = x0.copy()
    g = np.radians(slope_deg_mm * x0[0])
    x[0], x[1] = x0[0] + 1e-3 * x0[1] * np.sin(g), 1e-3 * x0[1] * np.cos(g)
    return PlySurface("p", x, x0, (a, a), np.ones(x0.shape[1:], bool), np.ones((cells, cells)))


def test_concentric_circles_are_their_radii_apart():
    d = outline_distances([circle(50.0)], [circle(53.0)])
    assert d.mean_mm == pytest.approx(3.0, abs=0.01)
    assert d.largest_mm == pytest.approx(3.0, abs=0.01)


def test_largest_distance_sees_a_bump_of_either_outline():
    bumped = circle(50.0)
    bumped[90] *= 1.2  # 10 mm out, at 45 deg
    for pair in ((circle(50.0), bumped), (bumped, circle(50.0))):
        d = outline_distances([pair[0]], [pair[1]])
        assert d.largest_mm == pytest.approx(10.0, abs=0.6)  # sampled every mm
        assert d.mean_mm < 0.2
        assert d.largest_at == pytest.approx((42.4, 42.4), abs=0.6)


def test_rigid_fit_finds_the_motion():
    t = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    shape = np.stack([80 * np.cos(t) + 6 * np.cos(3 * t), 50 * np.sin(t) + 9 * np.sin(2 * t)], axis=1)
    angle = np.radians(70.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    measured = (shape[::3] - [30.0, -12.0]) @ turn  # so shape = R(70) measured + (30, -12)
    fit = fit_points(measured, [shape])
    assert fit.turn_deg == pytest.approx(70.0, abs=0.02)
    assert fit.shift_mm == pytest.approx((30.0, -12.0), abs=0.02)
    assert point_distances(measured, [shape]).mean_mm > 10.0
    assert point_distances(fit.apply(measured), [shape]).largest_mm < 0.05


def test_wrinkles_are_matched_by_place_not_by_number():
    first = [wrinkle(1, (0, 0), (50, 0)), wrinkle(2, (0, 100), (50, 100)), wrinkle(3, (0, 300), (9, 300))]
    second = [wrinkle(1, (10, 104), (30, 104)), wrinkle(2, (0, 3), (50, 3)), wrinkle(3, (200, 0), (220, 0))]
    sites = match_wrinkles("ply-1", first, second)
    pairs = {(s.first and s.first["number"], s.second and s.second["number"]): s.distance_mm for s in sites}
    assert pairs == {(1, 2): pytest.approx(3.0), (2, 1): pytest.approx(4.0), (3, None): None, (None, 3): None}


def test_matching_prefers_the_least_sum():
    first = [wrinkle(1, (0, 0), (10, 0)), wrinkle(2, (0, 10), (10, 10))]
    second = [wrinkle(1, (0, 9), (10, 9)), wrinkle(2, (0, 20), (10, 20))]
    sites = match_wrinkles("ply-1", first, second)
    assert sorted(s.distance_mm for s in sites) == pytest.approx([9.0, 10.0])
    assert apart(first[0], wrinkle(9, (2, 0), (4, 0))) == pytest.approx(0.0)
    assert match_wrinkles("ply-1", [], second)[0].first is None


def test_shear_is_compared_at_material_points():
    coarse, fine = sheared(20, 100.0, 0.3), sheared(50, 100.0, 0.3)
    same = shear_difference(coarse, fine)
    assert same.signed
    assert same.rms_deg < 0.01
    steeper = shear_difference(coarse, sheared(50, 100.0, 0.5))
    assert steeper.rms_deg == pytest.approx(0.2 * 100.0 / np.sqrt(3.0), rel=0.01)
    assert steeper.largest_deg == pytest.approx(20.0, rel=0.05)


def test_measured_points_are_read_or_refused(tmp_path):
    file = tmp_path / "m.csv"
    file.write_text("point,Y_mm,x_mm\n1,2.0,1.0\n2,4,3\n3,6,5\n")
    assert read_points(file).tolist() == [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
    file.write_text("1,2\n3,4\n5,6\n")
    assert read_points(file).tolist() == [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
    for text, match in (("x,y\n1,2\n3,nan\n5,6\n", "row 3"), ("a,b\n1,2\n", "no columns"), ("1,2\n", "1 points")):
        file.write_text(text)
        with pytest.raises(UsageError, match=match):
            read_points(file)
