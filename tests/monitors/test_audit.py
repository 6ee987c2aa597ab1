"""The audit against states made by hand."""

import pytest

from ddf.model import sheet_vectors
from ddf.monitors.audit import ply_inside_tool, self_contact


def test_a_ply_below_the_top_of_the_tool_is_found(make_scene):
    scene = make_scene("hemisphere", "plies.0.element_mm=5", "diaphragms.element_mm=10")
    end = scene.path.duration
    ply = sheet_vectors(scene.model, scene.state.x, scene.ply_sheets[0])
    ply[2] = scene.tool_z(end) + 61.0
    assert ply_inside_tool(scene, end) == 0.0
    ply[2] = scene.tool_z(end) + 50.0
    assert ply_inside_tool(scene, end) == pytest.approx(10.0, abs=0.05)  # a node on the axis of the 60 mm sphere


def test_a_node_that_touches_its_own_sheet_is_counted(make_scene):
    scene = make_scene("hemisphere", "plies.0.element_mm=5", "diaphragms.element_mm=10")
    assert self_contact(scene) == (0, 0.0)
    pair = scene.model.pairs[scene.model.pairs["slave"] == scene.model.pairs["master"]][0]
    rows, cols = (int(scene.model.sheets[pair["slave"]][key]) for key in ("rows", "cols"))
    place = scene.state.place[5 * int(pair["first"]) :][: 5 * rows * cols].reshape(5, rows, cols)
    x = sheet_vectors(scene.model, scene.state.x, int(pair["slave"]))
    # a node that has come over a flat part of its sheet, at four fifths of the distance; its springs know less of it
    x[:, 2, 2] = x[:, 9, 9] + [0.0, 0.0, 0.8 * float(pair["sign"]) * float(pair["offset"])]
    place[:3, 2, 2] = 9.0, 9.0, -0.01
    assert self_contact(scene) == (1, pytest.approx(0.2))
