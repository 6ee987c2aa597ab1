"""A state that cannot be true is found, with its sheet and node; a run that meets one says so and keeps what it has."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import ddf.run.loop
from ddf.build.rim import RINGS
from ddf.cli import main
from ddf.model import sheet_vectors
from ddf.monitors.alarm import Alarm
from ddf.monitors.stability import check_state, fibre_stretch

COARSE = ("plies.0.element_mm=25", "diaphragms.element_mm=30")


@pytest.fixture
def scene(make_scene):
    return make_scene("flat-stack", *COARSE)


def _alarm(scene):
    return check_state(scene.model, scene.state, [sheet.name for sheet in scene.sheets], scene.state.x.copy())


def test_a_state_at_rest_raises_no_alarm(scene):
    assert _alarm(scene) is None


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
@pytest.mark.parametrize("vector", ["x", "v"])
def test_what_is_not_finite_is_found_at_its_node(scene, vector, value):
    start = scene.state.x.copy()
    sheet_vectors(scene.model, getattr(scene.state, vector), 1)[1, 3, 4] = value
    alarm = check_state(scene.model, scene.state, [sheet.name for sheet in scene.sheets], start)
    assert (alarm.sheet, alarm.node) == ("ply-1", (3, 4))
    assert np.isfinite(alarm.place_mm).all()
    assert str(alarm)


def test_speed_of_a_quarter_element_a_step_is_too_much(scene):
    v = sheet_vectors(scene.model, scene.state.v, 2)
    limit = 0.25 * np.diff(np.unique(sheet_vectors(scene.model, scene.state.x, 2)[0])).min() / scene.model.dt
    v[0, 5, 6] = 0.9 * limit
    assert _alarm(scene) is None
    v[0, 5, 6] = 1.1 * limit
    alarm = _alarm(scene)
    assert (alarm.sheet, alarm.node) == ("top-diaphragm", (5, 6))
    assert "solver.step_safety" in str(alarm)


def test_a_torn_fibre_is_found(scene):
    x = sheet_vectors(scene.model, scene.state.x, 1)
    x[0, 3, 4] += 0.5 * float(scene.model.sheets[1]["a1"])
    alarm = _alarm(scene)
    assert alarm.sheet == "ply-1"
    assert "fibre strain" in alarm.problem


@pytest.mark.parametrize(("factor", "said"), [(0.1, "crushed to"), (6.0, "stretched")])
def test_a_cell_of_rubber_that_collapses_or_bursts_is_found(scene, factor, said):
    x = sheet_vectors(scene.model, scene.state.x, 2)
    x[0, 6:] += (factor - 1.0) * (x[0, 6] - x[0, 5])  # all cells between rows 5 and 6
    alarm = _alarm(scene)
    assert alarm.sheet == "top-diaphragm"
    assert alarm.node[0] == 5
    assert said in alarm.problem


def test_what_flies_out_of_a_crushed_cell_is_laid_to_the_cell(scene):
    x, v = (sheet_vectors(scene.model, pool, 2) for pool in (scene.state.x, scene.state.v))
    x[0, 6:] -= 0.6 * (x[0, 6] - x[0, 5])
    assert _alarm(scene) is None
    v[2, 6, 3] = 1e7
    alarm = _alarm(scene)
    assert alarm.node[0] == 5
    assert "crushed to 40 %" in alarm.problem


def test_a_slit_that_opens_is_no_torn_fibre(make_scene):
    scene = make_scene("flat-stack", *COARSE, "plies.0.slits_mm=[[[5.0, -175.0], [5.0, 175.0]]]")
    x = sheet_vectors(scene.model, scene.state.x, 1)
    x[0, x[0] > 5.0] += 20.0
    assert _alarm(scene) is None
    assert max(np.abs(part).max() for part in fibre_stretch(scene.model, x, 1)) < 1e-9
    x[0, -1 - RINGS, 3 + RINGS] += 5.0
    assert "fibre strain" in _alarm(scene).problem


def test_a_run_that_goes_wrong_ends_with_3_and_keeps_its_output(tmp_path, monkeypatch):
    """By a guard that cries at once, and by an energy error beyond the case's limit."""
    settings = [part for item in (*COARSE, "process.stages.1.duration_s=0.001") for part in ("--set", item)]
    command = ["run", "flat-stack", "--quiet", "--threads", "1", *settings]
    tight = CliRunner().invoke(
        main, [*command, "-o", str(tmp_path / "tight"), "--set", "solver.energy_error_limit_percent=0.0001"]
    )
    assert tight.exit_code == 3, tight.output
    assert "energy_error_limit_percent" in tight.output
    alarm = Alarm("ply-1", (1, 2), (0.0, 0.0, 0.0), "fibre strain of 50 %", "a fold", "plies.element_mm")
    monkeypatch.setattr(ddf.run.loop, "check_state", lambda _, state, *__: alarm if state.clock[0] > 300 else None)
    wrong = CliRunner().invoke(main, [*command, "-o", str(tmp_path / "wrong")])
    assert wrong.exit_code == 3
    assert "change plies.element_mm" in wrong.output
    for name in ("tight", "wrong"):
        info = json.loads((tmp_path / name / "run.json").read_text())
        assert info["stop_reason"] == "unstable"
        assert info["message"]
        assert (tmp_path / name / "checkpoint.npz").is_file()
        assert "ERROR" in (tmp_path / name / "log.txt").read_text()
    with np.load(tmp_path / "wrong" / "checkpoint.npz") as kept:
        assert 100 <= kept["step"] <= 300  # the last good state, not the start
