from __future__ import annotations

import numpy as np
import pytest
from tiny_scene import make_scene

from ddf.model import sheet_vectors
from ddf.output.folder import RunFolder


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
    state.clock[:2] = round(own.path.duration / own.model.dt), own.path.duration
    return own


@pytest.fixture
def folder(tmp_path):
    return RunFolder.create(tmp_path / "run")
