import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from ddf.errors import MeshError
from ddf.mesh.grid import recover_order
from ddf.mesh.outline import cell_fractions, signed_area
from ddf.mesh.ply import mesh_ply

SQUARE = np.array([[-50.0, -50.0], [50.0, -50.0], [50.0, 50.0], [-50.0, 50.0]])
L_SHAPE = np.array([[0.0, 0.0], [90.0, 0.0], [90.0, 31.0], [37.0, 31.0], [37.0, 70.0], [0.0, 70.0]])


def test_aligned_square_is_fitted_exactly():
    ply = mesh_ply(SQUARE, [], [], 0.0, 3.0)
    assert ply.x.shape == (3, 34, 34)
    assert ply.spacing == pytest.approx((100 / 33, 100 / 33))
    assert (ply.cell_fraction == 1.0).all()
    assert ply.active.all()
    assert ply.area_mm2 == pytest.approx(1e4, rel=1e-12)


def test_rectangle_along_turned_fibres_is_fitted():
    turn = np.deg2rad(30.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    ply = mesh_ply(SQUARE * [1.0, 0.5] @ rotation.T, [], [], 30.0, 2.0)
    assert ply.x.shape == (3, 51, 26)
    assert (ply.cell_fraction == 1.0).all()


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0, 90.0, -60.0, 135.0])
def test_lattice_runs_along_the_fibres(angle):
    ply = mesh_ply(SQUARE, [], [], angle, 4.0, offset=(7.0, -3.0))
    t = np.deg2rad(angle)
    for axis, direction in ((1, (np.cos(t), np.sin(t), 0.0)), (2, (-np.sin(t), np.cos(t), 0.0))):
        steps = np.diff(ply.x, axis=axis)
        expected = ply.spacing[axis - 1] * np.array(direction)
        np.testing.assert_allclose(steps, np.broadcast_to(expected[:, None, None], steps.shape), atol=1e-9)
    corners = ply.x[:2].reshape(2, -1)
    assert np.allclose(0.5 * (corners.min(axis=1) + corners.max(axis=1)), (7.0, -3.0))


@pytest.mark.parametrize("angle", [0.0, 17.0, 45.0])
@pytest.mark.parametrize("polygon", [SQUARE, L_SHAPE, SQUARE[::-1]])
def test_area_of_cut_cells(polygon, angle):
    ply = mesh_ply(polygon, [], [], angle, 2.0)
    assert ply.outline_area_mm2 == pytest.approx(abs(signed_area(polygon)), rel=1e-12)
    assert 0.0 <= ply.outline_area_mm2 - ply.area_mm2 < 0.02 * 4.0 * 2 * 400 / 2.0
    assert ply.outline_area_mm2 - ply.area_mm2 < 2e-3 * ply.area_mm2
    assert ply.cell_fraction.max() == 1.0
    assert ply.cell_fraction[ply.cell_fraction > 0].min() >= 0.02


def test_hole_is_cut_and_has_its_loop():
    angle = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    hole = 20.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ply = mesh_ply(SQUARE, [hole], [], 30.0, 2.0)
    assert ply.area_mm2 == pytest.approx(1e4 - signed_area(hole), rel=1e-3)
    assert [len(c) for c in ply.corners] == [4, 0]
    assert signed_area(ply.outline[0]) > 0 > signed_area(ply.outline[1])
    radius = np.linalg.norm(ply.outline_points()[1][:, :2], axis=1)
    assert (np.abs(radius - 20.0) < 0.03).all()
    middle = np.linalg.norm(ply.x[:2], axis=0) < 16.0
    assert not ply.active[middle].any()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(4, 12))  # fewer need not go round the centre
def test_fractions_add_up_to_the_area(seed, corners):
    rng = np.random.default_rng(seed)
    angle = (np.arange(corners) + rng.uniform(0.05, 0.95, corners)) * 2 * np.pi / corners
    star = 10.0 + rng.uniform(0.5, 9.9, corners)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    fraction = cell_fractions([star], (20, 20))
    assert fraction.sum() == pytest.approx(signed_area(star), rel=1e-9)
    assert fraction.min() >= 0.0
    assert fraction.max() <= 1.0


def test_fraction_of_one_known_cell():
    triangle = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(cell_fractions([triangle], (2, 1)), [[0.75], [0.25]], atol=1e-14)


@pytest.mark.parametrize("angle", [0.0, 25.0])
def test_outline_is_resampled_and_placed(angle):
    ply = mesh_ply(SQUARE, [], [], angle, 4.0, offset=(5.0, 0.0))
    (points,) = ply.outline_points()
    steps = np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1)
    assert steps.max() <= 0.5 * min(ply.spacing) + 1e-9
    assert np.allclose(np.abs(points[:, :2] - [5.0, 0.0]).max(axis=1), 50.0)
    assert np.allclose(points[ply.corners[0], :2], SQUARE + np.array([5.0, 0.0]))
    live = ply.outline_cells[0]
    assert (ply.cell_fraction[live[:, 0], live[:, 1]] > 0.0).all()
    assert ply.active[live[:, 0], live[:, 1]].all()


@pytest.mark.parametrize("slit", [[[-60.0, 1.0], [60.0, 1.0]], [[-60.0, 0.0], [60.0, 0.0]], [[-60, -60], [60, 60]]])
@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_slit_across_separates_the_ply(slit, angle):
    ply = mesh_ply(SQUARE, [], [slit], angle, 2.5)
    _, parts = label(ply.cell_fraction > 0.0, structure=np.ones((3, 3)))
    assert parts == 2
    assert 0.0 < ply.outline_area_mm2 - ply.area_mm2 < 3.0 * 2.5 * 145.0


def test_slit_inside_takes_one_row_of_cells():
    ply = mesh_ply(SQUARE, [], [[[-19.0, 1.0], [19.0, 1.0]]], 0.0, 2.0)
    i, j = np.nonzero(ply.cell_fraction == 0.0)
    assert (j == 25).all()
    assert (i == np.arange(15, 35)).all()


@pytest.mark.parametrize(
    ("polygon", "holes", "element", "match"),
    [
        ([[0, 0], [10, 10], [10, 0], [0, 10]], [], 1.0, "crosses itself|no area"),
        ([[0, 0], [10, 0], [20, 0]], [], 1.0, "no area"),
        (SQUARE, [SQUARE * 2], 1.0, "not inside"),
        (SQUARE, [SQUARE / 2, SQUARE / 4], 1.0, "overlap"),
        (SQUARE, [], 80.0, "under two elements"),
        (SQUARE, [], -1.0, "positive"),
    ],
)
def test_impossible_outlines(polygon, holes, element, match):
    with pytest.raises(MeshError, match=match):
        mesh_ply(polygon, holes, [], 0.0, element)


def test_mesh_is_frozen_and_flat():
    ply = mesh_ply(SQUARE, [], [], 10.0, 10.0, name="ply-7")
    assert ply.name == "ply-7"
    assert (ply.x[2] == 0.0).all()
    with pytest.raises(dataclasses.FrozenInstanceError):
        ply.name = "other"


def _small_grid():
    i, j = np.meshgrid(np.arange(3), np.arange(4), indexing="ij")
    points = np.stack([i, j], axis=-1).reshape(-1, 2).astype(float)
    cell = (np.arange(2)[:, None] * 4 + np.arange(3)).reshape(-1)
    return points, np.stack([cell, cell + 4, cell + 5, cell + 1], axis=1)


def test_grid_order_is_recovered_from_shuffled_nodes():
    points, quads = _small_grid()
    shuffle = np.random.default_rng(3).permutation(12)
    place = np.argsort(shuffle)
    order = recover_order(points[shuffle], place[quads], (3, 4))
    assert (shuffle[order] == np.arange(12).reshape(3, 4)).all()


def test_what_is_no_grid_is_refused():
    points, quads = _small_grid()
    with pytest.raises(MeshError, match="do not make"):
        recover_order(points, quads[1:], (3, 4))
    with pytest.raises(MeshError, match="unit squares"):
        recover_order(points, quads[[0, 0, 2, 3, 4, 5]], (3, 4))
    wrong = quads.copy()
    wrong[0, 2] = 11
    with pytest.raises(MeshError, match="unit squares"):
        recover_order(points, wrong, (3, 4))
    bent = points + 0.1 * np.random.default_rng(0).random(points.shape)
    with pytest.raises(MeshError, match="straight grid lines"):
        recover_order(bent, quads, (3, 4))
