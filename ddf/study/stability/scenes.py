"""Small cases that the maps of the limits vary: a flat clamped stack, and a ply formed over a hemisphere."""

from __future__ import annotations

from typing import Any

import numpy as np

from ddf.case import Case, case_from_dict
from ddf.scene import Scene

Tables = dict[str, Any]

FLAT: Tables = {
    "frame": {"length_mm": 140.0, "width_mm": 140.0},
    "diaphragms": {"element_mm": 8.0, "element_max_mm": 16.0, "margin_mm": 10.0},
    "plies": [{"size_mm": [64.0, 64.0], "element_mm": 8.0}],
    "process": {
        "stages": [
            {"name": "evacuate-cavity", "duration_s": 0.02, "cavity_pressure_kPa": 0.0},
            {"name": "hold", "duration_s": 0.01, "mass_damping_1_s": 300.0},
        ]
    },
}
HEMISPHERE: Tables = {
    "frame": {"length_mm": 180.0, "width_mm": 180.0},
    "diaphragms": {"element_mm": 10.0, "element_max_mm": 20.0, "margin_mm": 10.0},
    "plies": [{"size_mm": [100.0, 100.0], "element_mm": 10.0}],
    "tool": {"shape": "hemisphere", "radius_mm": 25.0},
    "process": {
        "stages": [
            {"name": "evacuate-cavity", "duration_s": 0.01, "cavity_pressure_kPa": 0.0},
            {"name": "lift", "duration_s": 0.03, "tool_lift_mm": 25.0},
            {"name": "draw-down", "duration_s": 0.03, "box_pressure_kPa": 94.0, "mass_damping_1_s": 100.0},
            {"name": "evacuate-box", "duration_s": 0.02, "box_pressure_kPa": 0.0, "mass_damping_1_s": 100.0},
            {"name": "hold", "duration_s": 0.02, "mass_damping_1_s": 300.0},
        ]
    },
}


def rough(scene: Scene, size_mm: float = 0.01) -> Scene:
    """The scene with its free nodes displaced at random: something for an instability to grow from."""
    free = np.repeat(scene.model.inverse_mass > 0.0, 3)
    scene.state.x[free] += size_mm * np.random.default_rng(0).uniform(-1.0, 1.0, int(free.sum()))
    return scene


def make_case(tables: Tables, **changes: Tables) -> Case:
    """A case with keys laid over some of its tables; `plies` over its first ply."""
    merged = dict(tables)
    for name, table in changes.items():
        if name == "plies":
            merged["plies"] = [merged["plies"][0] | table]
        else:
            merged[name] = merged.get(name, {}) | table
    return case_from_dict(merged)
