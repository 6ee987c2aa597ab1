from __future__ import annotations

import numpy as np
import pytest

from ddf.build import build_scene
from ddf.case import case_from_dict
from ddf.model import sheet_vectors
from ddf.output.folder import RunFolder

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


@pytest.fixture(scope="session")
def flat_scene():
    """Never changed by a test."""
    return make_scene()


@pytest.fixture
def scene(flat_scene):
    """A scene of its own state, bulged over the tool at the end of the process."""
    state = flat_scene.state._replace(**{k: a.copy() for k, a in flat_scene.state._asdict().items()})
    own = type(flat_scene)(**{**vars(flat_scene), "state": state})
    for k in range(len(own.sheets)):
        x = sheet_vectors(own.model, state.x, k)
        x[2] += 15.0 * np.exp(-(x[0] ** 2 + x[1] ** 2) / 40.0**2)
    state.v[:] = 1.5
    state.clock[:] = round(own.path.duration / own.model.dt), own.path.duration
    return own


@pytest.fixture
def folder(tmp_path):
    return RunFolder.create(tmp_path / "run")
