"""The audit against states made by hand."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ddf.model import sheet_vectors
from ddf.monitors.audit import REMEDIES, history_checks, ply_inside_tool, self_contact
from ddf.monitors.energy import energies
from ddf.simulate import Simulation


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


@pytest.mark.parametrize(("spread", "seen"), [(0.0, False), (0.5, True)])
def test_a_fibre_solver_that_makes_energy_is_found_out(make_scene, spread, seen):
    """Wrong masses in the fibres' implicit step: the balance cannot see it, what fibres take and give back does."""
    scene = make_scene(
        "hemisphere", "plies.0.size_mm=[100,100]", "plies.0.element_mm=6", "frame.length_mm=200", "frame.width_mm=200",
        "diaphragms.element_mm=7", "tool.radius_mm=30", "process.stages.1.tool_lift_mm=30", "solver.symmetry=off",
    )  # fmt: skip
    wrong = np.exp(spread * np.random.default_rng(0).normal(size=scene.model.line_mass.size))
    scene = replace(scene, model=scene.model._replace(line_mass=scene.model.line_mass * wrong))
    sim, rows = Simulation(scene), []
    for _ in range(0, scene.steps, 50):
        sim.advance(50)
        now = energies(scene.model, scene.state)
        parts = {f"dissipated_{name}_mJ": value for name, value in now.dissipated.items()}
        rows.append(parts | {f"work_{name}_mJ": value for name, value in now.work.items()})
    sim.close()
    assert abs(now.error_share) < 0.005
    checks = {check["name"]: check for check in history_checks({key: [row[key] for row in rows] for key in rows[0]})}
    assert checks["taken by waves of the fibres"]["ok"] is not seen
    assert checks["energy given back by what only takes"]["ok"] is not seen


def test_an_empty_history_has_no_checks():
    assert history_checks({"time_s": np.zeros(0)}) == []


def test_what_to_do_names_keys_that_there_are():
    """Every key that a remedy names is one of a case's."""
    documented = Path("docs/case.md").read_text()
    keys = {
        key
        for text in REMEDIES.values()
        for key in re.findall(r"\b(?:solver|diaphragms|plies|process|target)\.[\w.]+\w", text)
    }
    assert len(keys) > 6
    for key in keys:
        assert f"`{key.split('.')[-1]}`" in documented, key
