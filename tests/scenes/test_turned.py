"""Turning tool and ply about the vertical changes outline and wrinkles by under 1 % before anything buckles.

The diaphragms' grid and the square frame are not turned: what they add is in the difference. After buckling single
wrinkles grow from rounding, so only numbers over several turns can be held against their own scatter.
"""

import math

import numpy as np
import pytest

from ddf.build import build_scene
from ddf.case import case_from_dict
from ddf.postprocess import measure
from ddf.simulate import Simulation

TURN_DEG = 37.0
SIDE, RADIUS, LIFT = 100.0, 30.0, 14.0  # mm; the sheets hang over the crown, and nothing has buckled


def formed(turn_deg):
    """A square ply over the crown of a hemisphere, both turned: its outline turned back (k, 3), its metrics."""
    turn = math.radians(turn_deg)
    to_frame = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    corners = 0.5 * SIDE * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) @ to_frame.T
    case = case_from_dict({
        "frame": {"length_mm": 280.0, "width_mm": 280.0},
        "diaphragms": {"element_mm": 6.5, "element_max_mm": 14.0},
        "plies": [{"polygon_mm": corners.tolist(), "orientation_deg": turn_deg, "element_mm": 6.25}],
        "tool": {"shape": "hemisphere", "radius_mm": RADIUS, "turn_deg": turn_deg},
        "process": {"stages": [
            {"name": "evacuate-cavity", "duration_s": 0.006, "cavity_pressure_kPa": 0.0},
            {"name": "lift", "duration_s": 0.02, "tool_lift_mm": LIFT},
            {"name": "hold", "duration_s": 0.008, "mass_damping_1_s": 300.0},
        ]},
    })  # fmt: skip
    scene = build_scene(case)
    sim = Simulation(scene)
    try:
        sim.advance(scene.steps)
    finally:
        sim.close()
    surfaces, _, tables = measure(scene)
    mesh = scene.sheets[1].mesh
    (outline,) = mesh.outline_points(np.asarray(surfaces[0].x))
    return np.column_stack([outline[:, :2] @ to_frame, outline[:, 2]]), tables[0]


@pytest.fixture(scope="module")
def both():
    return formed(0.0), formed(TURN_DEG)


def test_outline_turns_with_the_scene(both):
    """In plan; the heights of the corners hang on where they point in the square frame."""
    (straight, _), (turned, _) = both
    apart = np.linalg.norm((turned - straight)[:, :2], axis=1)
    assert np.ptp(straight[:, 2]) > 5.0
    assert apart.max() < 0.01 * 0.5 * SIDE


def test_metrics_turn_with_the_scene(both):
    (_, straight), (_, turned) = both
    for name in ("outline_area_mm2", "outline_length_mm"):
        assert turned[name] == pytest.approx(straight[name], rel=0.01)
    assert straight["wrinkle_count"] == turned["wrinkle_count"] == 0
