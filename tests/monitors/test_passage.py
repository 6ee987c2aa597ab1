"""Sheets that have passed through the tool or through one another are found, with the node that shows it."""

import numpy as np
import pytest

from ddf.model import sheet_vectors
from ddf.monitors.passage import check_passage, lost_nodes
from ddf.simulate import Simulation

COARSE = ("plies.0.element_mm=12.5", "diaphragms.element_mm=14")


@pytest.fixture
def scene(make_scene):
    return make_scene("hemisphere", *COARSE)


def _crown(scene, k):
    """Node of sheet k nearest to the tool's axis."""
    x = sheet_vectors(scene.model, scene.state.x, k)
    active = np.where(np.isfinite(x[0]), x[0] ** 2 + x[1] ** 2, np.inf)
    return tuple(int(i) for i in np.unravel_index(np.argmin(active), active.shape))


def test_a_scene_at_its_start_raises_no_alarm(scene):
    assert check_passage(scene, 0.0) is None


@pytest.mark.parametrize(("k", "allowed"), [(0, 0.0), (1, 1.0)])
def test_a_sheet_inside_the_tool_is_found(scene, k, allowed):
    i, j = _crown(scene, k)
    x = sheet_vectors(scene.model, scene.state.x, k)
    top = scene.tool_z(0.0) + scene.tool_mesh.top_mm
    x[2, i, j] = top - allowed + 0.2
    assert check_passage(scene, 0.0) is None
    x[2, i, j] = top - allowed - 0.4
    alarm = check_passage(scene, 0.0)
    assert (alarm.sheet, alarm.node) == (scene.sheets[k].name, (i, j))
    assert "inside the tool" in alarm.problem


def test_plies_that_just_touch_are_not_lost(make_scene):
    """Two plies start at the distance at which they touch, with a gap of 0."""
    scene = make_scene("tetrahedron-double", *COARSE, "plies.1.element_mm=12.5")
    sim = Simulation(scene)
    try:
        for _ in range(4):
            sim.advance(20)
            assert check_passage(scene, sim.time) is None
    finally:
        sim.close()


def test_a_ply_thrown_through_the_diaphragm_has_lost_its_place(scene):
    sim = Simulation(scene)
    try:
        sim.advance(60)
        assert check_passage(scene, sim.time) is None
        x = sheet_vectors(scene.model, scene.state.x, 1)
        number = next(k for k, p in enumerate(scene.model.pairs) if (p["slave"], p["master"]) == (1, 0))
        middle = np.abs(x[0] - 80.0) + np.abs(x[1] - 80.0) < 40.0  # beside the tool
        x[2, middle] -= 6.0  # deeper than three times the distance at which sheets touch
        sheet_vectors(scene.model, scene.state.v, 1)[:] = 0.0
        sim.advance(1)
        lost, held = lost_nodes(scene.model, scene.state, number)
        assert len(lost) > 0.8 * np.count_nonzero(middle)
        alarm = check_passage(scene, sim.time)
        assert alarm.sheet == "ply-1"
        assert "bottom-diaphragm" in alarm.problem
    finally:
        sim.close()
