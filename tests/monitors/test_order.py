"""Guards of geometry: layers in their order, zigzags of the grid, sheets that pass through themselves."""

import numpy as np
import pytest
from crossings import _hits, _triangles, crossings

from ddf.model import sheet_scalars, sheet_vectors
from ddf.monitors.crossings import crossings_of, layer_crossings, self_crossings
from ddf.monitors.layers import depth_in_layers
from ddf.monitors.zigzag import zigzag_share

COARSE = ("plies.0.element_mm=25", "diaphragms.element_mm=30")


@pytest.fixture
def scene(make_scene):
    return make_scene("flat-stack", *COARSE)


def test_a_flat_stack_is_in_order(scene):
    assert depth_in_layers(scene)[0] == 0.0
    assert zigzag_share(scene) == 0.0
    assert self_crossings(scene) == {}
    assert layer_crossings(scene) == {}


@pytest.mark.parametrize("seed", range(3))
def test_layers_that_cut_each_other_are_those_of_an_independent_test(scene, seed):
    """A ply crumpled until it reaches the lower diaphragm: every edge of one through the other, once."""
    rng = np.random.default_rng(seed)
    sheets = [sheet_vectors(scene.model, scene.state.x, k) for k in (0, 1)]
    sheets[1][2] -= np.where(rng.uniform(size=sheets[1][2].shape) < 0.1, 3.0, 0.0)
    points = [x.reshape(3, -1).T for x in sheets]
    faces = []
    for k, x in enumerate(sheets):
        number = np.arange(x[0].size).reshape(x[0].shape)
        quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
        faces.append(_triangles(quads[sheet_scalars(scene.model, scene.model.cell, k)[:-1, :-1] > 0.0]))
    known = sum(
        len(np.unique(_hits(points[a], faces[a], points[b], faces[b], False).edge, axis=0)) for a, b in ((0, 1), (1, 0))
    )
    assert known > 10
    assert layer_crossings(scene) == {("bottom-diaphragm", scene.sheets[1].name): known}


@pytest.mark.parametrize(("lowered", "share"), [(0.4, 0.0), (0.9, 1.0), (2.5, 1.0)])
def test_a_ply_pressed_into_or_through_the_diaphragm_is_deep_in_it(scene, lowered, share):
    bottom, ply = (sheet_vectors(scene.model, scene.state.x, k) for k in (0, 1))
    offset = float(scene.model.pairs["offset"][0])
    ply[2] = bottom[2].mean() + (1.0 - lowered) * offset
    found, deepest = depth_in_layers(scene)
    assert found == pytest.approx(share, abs=0.02)
    assert deepest == pytest.approx(lowered, abs=0.1)


def test_nodes_up_and_down_in_turn_are_a_zigzag_and_a_wave_of_eight_elements_is_none(scene):
    x = sheet_vectors(scene.model, scene.state.x, 1)
    i = np.arange(x.shape[1])[:, None]
    x[2] = 5.0 * np.sin(2.0 * np.pi * i / 8.0)
    assert zigzag_share(scene) == 0.0
    x[2] = 5.0 * (-1.0) ** i
    assert zigzag_share(scene) > 0.5


@pytest.mark.parametrize("turned", [0.5, 0.3])
def test_crossings_are_those_of_an_independent_test(turned):
    """A loop whose flanks cross, against VTK's search and a test of one edge at a time."""
    s, v = np.meshgrid(np.linspace(-1.0, 1.0, 41), np.arange(5.0), indexing="ij")
    x = np.array([10.0 * (s**3 - 0.5 * s), v + turned * s, 10.0 * s**2])
    number = np.arange(s.size).reshape(s.shape)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    known = crossings(x.reshape(3, -1).T, quads)
    found = crossings_of(x, np.ones((40, 4), bool))
    assert len(known) > 0
    assert found > 0
    assert crossings_of(np.array([10.0 * s, v, np.sin(3.0 * s)]), np.ones((40, 4), bool)) == 0
    x[0] = 10.0 * (s**3 - 1.1 * s)  # flanks that do not meet again
    assert (crossings_of(x, np.ones((40, 4), bool)) > 0) == (len(crossings(x.reshape(3, -1).T, quads)) > 0)


def test_cells_in_one_plane_do_not_cross():
    """Long cells of a graded grid on a plane, not flat to the last digit: near each other and never through."""
    rng = np.random.default_rng(5)
    u, v = np.meshgrid(np.linspace(0.0, 300.0, 12), np.linspace(0.0, 60.0, 41), indexing="ij")
    x = np.array([u, v, rng.normal(size=u.shape) * 1e-14])
    assert crossings_of(x, np.ones((11, 40), bool)) == 0


def _crumpled(seed, share):
    """Nodes (3, 9, 9) of a flat grid of 2 mm, each moved at random by a share of that."""
    u, v = np.meshgrid(np.arange(9.0), np.arange(9.0), indexing="ij")
    x = 2.0 * np.array([u, v, np.zeros_like(u)])
    return x + 2.0 * share * np.random.default_rng(seed).normal(size=x.shape)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.8])
@pytest.mark.parametrize("seed", range(4))
def test_kinks_of_neighbouring_cells_cross_where_an_independent_test_says_so(seed, share):
    x = _crumpled(seed, share)
    number = np.arange(81).reshape(9, 9)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    known = crossings(x.reshape(3, -1).T, quads)
    assert (crossings_of(x, np.ones((8, 8), bool)) > 0) == (len(known) > 0)
