"""The walls of the box, at work: a vacuum over a deep box presses the sheets on them and not through them."""

import numpy as np
import pytest

from ddf.build import build_scene
from ddf.case import case_from_dict
from ddf.contact.tool import WALL
from ddf.contact.tool_point import FREE
from ddf.model import sheet_vectors
from ddf.monitors.energy import energies
from ddf.simulate import Simulation

CASE = {
    "frame": {"length_mm": 220.0, "width_mm": 200.0},
    "diaphragms": {"element_mm": 10.0, "element_max_mm": 12.0, "thickness_mm": 0.8},
    "plies": [{"size_mm": [80.0, 80.0], "element_mm": 10.0}],
    "tool": {"shape": "hemisphere", "radius_mm": 55.0},
    "process": {
        "stages": [
            {"name": "cavity", "duration_s": 0.01, "cavity_pressure_kPa": 0.0},
            {"name": "draw-down", "duration_s": 0.05, "mass_damping_1_s": 100.0, "box_pressure_kPa": 94.0},
            {"name": "box", "duration_s": 0.03, "mass_damping_1_s": 100.0, "box_pressure_kPa": 20.0},
            {"name": "hold", "duration_s": 0.02, "mass_damping_1_s": 300.0},
        ]
    },
}


@pytest.fixture(scope="module")
def pressed():
    scene = build_scene(case_from_dict(CASE))
    sim = Simulation(scene)
    try:
        sim.advance(scene.steps)
    finally:
        sim.close()
    return scene


def test_sheets_lie_on_the_walls_and_not_beyond(pressed):
    x = sheet_vectors(pressed.model, pressed.state.x, 0)
    beyond = np.maximum(np.abs(x[0]) - 110.0, np.abs(x[1]) - 100.0)
    assert x[2].min() < -40.0  # drawn deep into the box
    assert 0.0 < beyond.max() < 0.1
    touching = pressed.state.tool_anchor[WALL:, 0] < FREE
    assert touching.any(axis=(1, 2)).all()  # walls of both directions
    assert not touching[:, 0].any()  # held nodes are not asked


def test_walls_do_no_work(pressed):
    energy = energies(pressed.model, pressed.state)
    assert energy.kinetic_share() < 1e-3
    assert abs(energy.error_share) < 0.01
