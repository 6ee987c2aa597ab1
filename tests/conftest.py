"""Scenes that several tests share."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest

from ddf.build import build_scene
from ddf.case import load_case
from ddf.model import State
from ddf.scene import Scene

CASES = Path(__file__).parent.parent / "cases"

SceneMaker = Callable[..., Scene]


def copied(scene: Scene) -> Scene:
    """The same scene with a state of its own."""
    return dataclasses.replace(scene, state=State(*(copy.deepcopy(a) for a in scene.state)))


@pytest.fixture(autouse=True)
def past_runs(monkeypatch, tmp_path_factory) -> Path:
    """Estimates of time as on a machine where nothing has run yet; the file in which runs of the test are noted."""
    file = tmp_path_factory.mktemp("past") / "past-runs.json"
    monkeypatch.setattr("ddf.past_runs._file", lambda: file)
    return file


@pytest.fixture(scope="session")
def copy_scene() -> Callable[[Scene], Scene]:
    """Makes the same scene with a state of its own."""
    return copied


@pytest.fixture(scope="session")
def make_scene() -> SceneMaker:
    """Scene of a shipped case with overrides; meshed once, a fresh state each time."""
    built: dict[tuple[str, ...], Scene] = {}

    def make(case: str, *overrides: str) -> Scene:
        key = (case, *overrides)
        if key not in built:
            built[key] = build_scene(load_case(CASES / f"{case}.toml", list(overrides)))
        return copied(built[key])

    return make
