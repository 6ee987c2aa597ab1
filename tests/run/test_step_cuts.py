"""A run whose step is too long goes back to where all was well and on with a shorter one."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ddf.run.start
from ddf.case import load_case
from ddf.errors import UnstableError
from ddf.output.results import open_run
from ddf.run import run_case

SMALL = (
    "frame.length_mm=220", "frame.width_mm=180", "plies.0.size_mm=[100,100]", "plies.0.element_mm=5",
    "diaphragms.element_mm=5", "output.pictures=false",
)  # fmt: skip


@pytest.fixture
def too_long(monkeypatch):
    """Scenes are built with 1.6 times the step that is stable."""
    built = ddf.run.start.prepare

    def prepare(*arguments):
        scene = built(*arguments)
        step = 1.6 * scene.step_limit / scene.case.solver.step_safety
        return replace(scene, model=scene.model._replace(dt=step), first_step_s=step)

    monkeypatch.setattr(ddf.run.start, "prepare", prepare)


def _case(shipped, *overrides):
    return load_case(shipped / "flat-stack.toml", [*SMALL, *overrides])


def test_a_run_that_loses_its_hold_goes_back_and_on_with_a_smaller_step(too_long, request, tmp_path):
    case = _case(request.config.rootpath / "cases", "process.stages.0.duration_s=0.04")
    result = run_case(case, tmp_path / "run", threads=1)
    assert result.stop_reason == "finished"
    info = json.loads((tmp_path / "run/run.json").read_text())
    cuts = info["step_cuts"]
    assert cuts
    assert info["step_s"] == pytest.approx(cuts[0]["step_s"] * 0.7 ** (len(cuts) - 1))
    assert any("the step was cut" in note for note in result.notes)
    history = open_run(tmp_path / "run").history()
    assert (np.diff(history["time_s"]) > 0.0).all()  # rows of the steps that were taken back are gone
    assert np.isfinite(history["kinetic_mJ"]).all()
    assert history["time_s"][-1] == pytest.approx(result.time_s)
    assert abs(history["energy_error_percent"][-1]) < 1.0
    again = run_case(case, tmp_path / "run", threads=1, resume=True)  # from a checkpoint with the shorter step
    assert (again.step, again.time_s) == (result.step, result.time_s)


def test_without_cuts_it_stops_with_the_reason(too_long, request, tmp_path):
    with pytest.raises(UnstableError, match="step"):
        run_case(_case(request.config.rootpath / "cases", "solver.step_cuts=0"), tmp_path / "run", threads=1)
    assert json.loads((tmp_path / "run/run.json").read_text())["stop_reason"] == "unstable"
