"""The audit against states made by hand."""

import pytest

from ddf.model import sheet_vectors
from ddf.monitors.audit import ply_inside_tool


def test_a_ply_below_the_top_of_the_tool_is_found(make_scene):
    scene = make_scene("hemisphere", "plies.0.element_mm=5", "diaphragms.element_mm=10")
    end = scene.path.duration
    ply = sheet_vectors(scene.model, scene.state.x, scene.ply_sheets[0])
    ply[2] = scene.tool_z(end) + 61.0
    assert ply_inside_tool(scene, end) == 0.0
    ply[2] = scene.tool_z(end) + 50.0
    assert ply_inside_tool(scene, end) == pytest.approx(10.0, abs=0.05)  # a node on the axis of the 60 mm sphere
