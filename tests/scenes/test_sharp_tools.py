"""Tools whose edges are far sharper than the elements: ridges, apexes and corners stay below the sheets."""

import pytest
from judge import judged_run
from random_scenes import GENTLE_KPA

ELEMENT = 5.5  # mm
TOOLS = [
    {"shape": "regular-tetrahedron", "height_mm": 30.0, "fillet_mm": 1.0},
    {"shape": "box", "length_mm": 50.0, "width_mm": 36.0, "height_mm": 18.0, "fillet_mm": 0.5},
]


@pytest.mark.parametrize("tool", TOOLS, ids=lambda tool: f"{tool['shape']}-{tool['fillet_mm']:g}")
def test_sheets_settle_over_sharp_edges(tool, tmp_path):
    table = {
        "title": f"sharp {tool['shape']}",
        "frame": {"length_mm": 200.0, "width_mm": 190.0},
        "diaphragms": {"element_mm": ELEMENT, "element_max_mm": 14.0},
        "plies": [{"size_mm": [90.0, 85.0], "orientation_deg": 20.0, "element_mm": 5.0}],
        "tool": tool,
        "process": {"stages": [
            {"name": "cavity", "duration_s": 0.012, "cavity_pressure_kPa": 0.0},
            {"name": "lift", "duration_s": 0.035, "tool_lift_mm": tool["height_mm"]},
            {"name": "draw-down", "duration_s": 0.05, "mass_damping_1_s": 100.0, "box_pressure_kPa": GENTLE_KPA},
            {"name": "box", "duration_s": 0.03, "mass_damping_1_s": 100.0, "box_pressure_kPa": 0.0},
            {"name": "hold", "duration_s": 0.025, "mass_damping_1_s": 300.0},
        ]},
        "output": {"frames_per_stage": 2, "pictures": False},
    }  # fmt: skip
    row = judged_run(table, tmp_path / "run", frames=False)
    assert row["end"] == "settled", row
    assert row["ply_in_tool_mm"] < 0.5
    assert row["strain_percent"] < 0.3
    assert row["penetration_mm"] < 0.25 * ELEMENT  # of the polygon between the points of contact, half an element apart
