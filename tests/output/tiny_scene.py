"""A scene of two small plies over a hemisphere."""

from __future__ import annotations

from ddf.build import build_scene
from ddf.case import case_from_dict

CASE = {
    "title": "Tiny",
    "frame": {"length_mm": 260.0, "width_mm": 240.0},
    "diaphragms": {"element_mm": 20.0, "element_max_mm": 30.0},
    "plies": [
        {"size_mm": [100.0, 100.0], "orientation_deg": 0.0, "element_mm": 10.0},
        {"size_mm": [100.0, 100.0], "orientation_deg": 45.0, "element_mm": 10.0},
    ],
    "tool": {"shape": "hemisphere", "radius_mm": 20.0},
    "process": {
        "stages": [
            {"name": "evacuate", "duration_s": 0.01, "cavity_pressure_kPa": 0.0},
            {"name": "lift", "duration_s": 0.02, "tool_lift_mm": 20.0},
        ]
    },
}


def make_scene(**changes):
    return build_scene(case_from_dict(CASE | changes))
