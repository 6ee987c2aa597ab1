"""Whole runs through the API and the command line: interruption, resumption, exit codes."""

import csv
import itertools
import json
import os
import re
import shutil
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import ddf.run.loop
from ddf.case import load_case
from ddf.cli import main
from ddf.errors import UsageError
from ddf.output.results import open_run
from ddf.postprocess import rebuild_report
from ddf.run import run_case

SMALL = [
    "plies.0.element_mm=12.5",
    "diaphragms.element_mm=14",
    "tool.fillet_mm=15",
    "process.stages.0.duration_s=0.004",
    "process.stages.1.duration_s=0.012",
    "process.stages.2.duration_s=0.004",
    "process.stages.3.duration_s=0.004",
    "process.settled_percent=0",
    "output.frames_per_stage=2",
    "solver.energy_error_limit_percent=100",
]


@pytest.fixture(scope="module")
def case():
    return load_case("cases/tetrahedron-0-90-coarse.toml", SMALL)


@pytest.fixture(scope="module")
def whole(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "run"
    return run_case(case, folder, threads=2)


def _rows(folder):
    with open(folder / "history.csv", newline="") as stream:
        return [{k: v for k, v in row.items() if k != "wall_s"} for row in csv.DictReader(stream)]


def test_run_leaves_all_that_is_promised(whole):
    assert whole.stop_reason == "finished"
    for name in (
        "case.toml", "case.resolved.toml", "log.txt", "run.json", "history.csv", "profiles/ply-1.csv", "wrinkles.csv",
        "metrics.json", "checkpoint.npz", "report.html", "ply-1.pvd", "tool.pvd", "pictures/formed-ply-1.png",
        "pictures/shear-ply-1.png", "pictures/distance-ply-1.png", "pictures/outline-ply-1.png",
        "pictures/energies.png",
    ):  # fmt: skip
        assert (whole.folder / name).stat().st_size > 0, name
    assert not list(whole.folder.rglob("*.tmp*"))
    info = json.loads((whole.folder / "run.json").read_text())
    assert info["stop_reason"] == "finished"
    assert {check["name"] for check in info["audit"]} >= {"energy balance error", "deepest penetration of the tool"}


def test_finished_run_opens_as_arrays(whole, case):
    run = open_run(whole.folder)
    assert run.history()["time_s"][-1] == pytest.approx(case.process.duration_s, rel=0.01)
    frames = run.frames("ply-1")
    assert len(frames) == 1 + 2 * len(case.process.stages)
    last = run.read_frame("ply-1")
    assert np.isfinite(last["shear_angle_deg"]).all()
    profile = run.profile("ply-1")
    assert np.hypot(profile["x0_mm"], profile["y0_mm"]).max() == pytest.approx(175 * 2**0.5)


def test_a_report_made_again_says_what_it_measured(whole, tmp_path):
    again = tmp_path / "again"
    shutil.copytree(whole.folder, again)
    info = json.loads((again / "run.json").read_text())
    info["audit"] = [info["audit"][0] | {"value": 123.0, "ok": False}]
    (again / "run.json").write_text(json.dumps(info))
    rebuild_report(again)
    audit, metrics = (json.loads((again / name).read_text()) for name in ("run.json", "metrics.json"))
    assert audit["audit"] == metrics["audit"] == json.loads((whole.folder / "metrics.json").read_text())["audit"]
    assert "what it says, or what to do" in (again / "report.html").read_text()


def test_interrupted_and_resumed_is_the_same_run(whole, case, tmp_path, monkeypatch):
    monkeypatch.setattr(ddf.run.loop, "REPORT_EVERY_S", 0.0)

    def stop_at(share, number):
        def stop(progress):
            if progress.step >= progress.steps * share:
                os.kill(os.getpid(), number)

        return stop

    first = run_case(case, tmp_path / "run", threads=1, report=stop_at(0.3, signal.SIGTERM))
    second = run_case(case, tmp_path / "run", threads=1, report=stop_at(0.6, signal.SIGINT), resume=True)
    assert (first.stop_reason, second.stop_reason) == ("interrupted", "interrupted")
    assert 0 < first.step < second.step < whole.step
    third = run_case(case, tmp_path / "run", threads=1, resume=True)
    assert third.stop_reason == "finished"
    log = (tmp_path / "run" / "log.txt").read_text()
    assert re.search(r"T\d\d:.*started(?s:.*)interrupted(?s:.*)resumed(?s:.*)finished", log)
    with np.load(whole.folder / "checkpoint.npz") as a, np.load(tmp_path / "run" / "checkpoint.npz") as b:
        for name in a.files:
            if name.startswith("state_"):
                assert np.array_equal(a[name], b[name]), name
    assert _rows(whole.folder) == _rows(tmp_path / "run")
    assert len(open_run(tmp_path / "run").frames("ply-1")) == 1 + 2 * len(case.process.stages)


def test_a_clock_that_jumps_changes_nothing(whole, case, tmp_path, monkeypatch):
    """The time of day goes back a day at each look: durations come from the monotonic clock."""
    now = itertools.count(2e9, -86400.0)
    monkeypatch.setattr(time, "time", lambda: next(now))
    monkeypatch.setattr(time, "time_ns", lambda: int(1e9 * next(now)))
    monkeypatch.setattr(ddf.run.loop, "REPORT_EVERY_S", 0.0)
    told = []
    result = run_case(case, tmp_path / "run", threads=1, report=told.append)
    monkeypatch.undo()
    wall = open_run(result.folder).history()["wall_s"]
    assert (np.diff(wall) >= 0).all()
    assert 0 <= wall[0] <= wall[-1] < 600
    assert all(0 <= seconds < 600 for seconds in result.wall_s.values())
    assert all(0 <= p.elapsed_s < 600 and 0 <= p.remaining_s < 600 for p in told)
    assert _rows(whole.folder) == _rows(result.folder)


def test_progress_is_true_and_memory_does_not_grow(case, tmp_path, monkeypatch):
    """Frames and checkpoints all the time: the resident set stays, progress, history and frames say the same."""
    often = case.output.model_copy(update={"frames_per_stage": 12, "history_interval_steps": 1, "pictures": False,
                                           "checkpoint_interval_s": 0.1})  # fmt: skip
    solver = case.solver.model_copy(update={"check_interval_steps": 5})
    monkeypatch.setattr(ddf.run.loop, "REPORT_EVERY_S", 0.0)
    told, resident = [], []

    def note(progress):
        told.append(progress)
        resident.append(int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 2**20)

    small = case.model_copy(update={"output": often, "solver": solver})
    run = open_run(run_case(small, tmp_path / "run", threads=1, report=note).folder)
    steps = np.array([p.step for p in told])
    assert (np.diff(steps) > 0).all()
    assert steps[-1] == told[-1].steps == run.info["step"]
    assert told[-1].remaining_s == 0
    for p in told:
        assert p.time_s == pytest.approx(p.step * p.step_s, rel=1e-9)
        assert p.remaining_s == pytest.approx(p.elapsed_s * (p.steps - p.step) / p.step, rel=1e-9)
    history = run.history()
    assert list(history["step"][1:]) == list(steps)
    times = [time_s for time_s, _ in run.frames("ply-1")]
    assert len(times) == 1 + 12 * len(case.process.stages)
    apart = np.abs(np.subtract.outer(times, history["time_s"])).min(axis=1)
    assert apart.max() < 1e-6 * told[0].step_s * told[-1].steps  # every frame is of a step that history has too
    assert np.median(resident[-50:]) - np.median(resident[len(resident) // 4 :][:50]) < 8.0  # MiB


def test_frames_due_between_two_looks_at_the_state_are_one(case, tmp_path):
    often = case.output.model_copy(update={"frames_per_stage": 40, "pictures": False})
    run = open_run(run_case(case.model_copy(update={"output": often}), tmp_path / "run", threads=1).folder)
    times = np.array([time_s for time_s, _ in run.frames("ply-1")])
    assert list(times) == [time_s for time_s, _ in run.frames("bottom-diaphragm")]
    assert (np.diff(times) > 0).all()
    look = case.solver.check_interval_steps * run.history()["step_s"][-1]
    assert len(times) == pytest.approx(1 + times[-1] / look, abs=1)
    edges = np.cumsum([0.0, *[stage.duration_s for stage in case.process.stages]])
    due = np.interp(np.arange(1, 40 * (len(edges) - 1)) / 40, np.arange(len(edges)), edges)
    late = times[np.searchsorted(times, due - 1e-9)] - due  # of the frame that shows what was due then
    assert late.max() < look


def test_a_folder_in_use_is_refused(whole, case):
    with pytest.raises(UsageError, match="not empty"):
        run_case(case, whole.folder)


def test_commands_and_exit_codes(tmp_path):
    runner = CliRunner()
    assert runner.invoke(main, ["--help"]).exit_code == 0
    new = tmp_path / "new.toml"
    assert runner.invoke(main, ["init", str(new)]).exit_code == 0
    assert runner.invoke(main, ["init", str(new)]).exit_code == 2
    checked = runner.invoke(
        main, ["check", str(new), "--set", "plies.0.element_mm=10", "--set", "diaphragms.element_mm=12"]
    )
    assert checked.exit_code == 0
    assert "cube-corner-tetrahedron" in checked.output
    assert "monotone shear law" in checked.output
    assert "solver" in runner.invoke(main, ["schema"]).output
    new.write_text(new.read_text().replace("thickness_mm", "thicknes_mm", 1) + "\n[unknown]\na = 1\n")
    bad = runner.invoke(main, ["run", str(new)])
    assert bad.exit_code == 2
    assert "thickness_mm" in bad.output
    assert "unknown" in bad.output
    assert runner.invoke(main, ["run", str(tmp_path / "missing.toml")]).exit_code == 2


def test_a_last_stage_that_holds_ends_when_settled(case, tmp_path):
    """A flat stack that lies still: one frame at the end in place of those left out; resumed, it is at its end."""
    stages = case.process.stages
    held = stages[0].model_copy(update={"name": "hold", "duration_s": 0.05, "cavity_pressure_kPa": 0.0,
                                        "mass_damping_1_s": 300.0})  # fmt: skip
    process = case.process.model_copy(update={"stages": (stages[0], held), "settled_percent": 1.0})
    flat = case.model_copy(update={"process": process})
    result = run_case(flat, tmp_path / "run", threads=1)
    run = open_run(result.folder)
    assert result.stop_reason == run.info["stop_reason"] == "finished"
    assert 0.004 < result.time_s < 0.045
    assert run.info["step"] == run.info["steps"] == result.step
    history = run.history()
    assert history["kinetic_over_internal_percent"][-1] < 1.0 <= history["kinetic_over_internal_percent"][-2]
    times = [time for time, _ in run.frames("ply-1")]
    assert times[-1] == pytest.approx(result.time_s, rel=1e-6)
    assert len(set(times)) == len(times)
    again = run_case(flat, tmp_path / "run", threads=1, resume=True)
    assert (again.stop_reason, again.step) == ("finished", result.step)
    whole = flat.model_copy(update={"process": process.model_copy(update={"settled_percent": 0.0})})
    assert run_case(whole, tmp_path / "whole", threads=1).time_s == pytest.approx(0.054, rel=0.01)
