"""What must not depend on how long a run lasts, nor on the machine's clock."""

import csv
import time
from pathlib import Path

import numpy as np
import pytest

import ddf.run.loop
from ddf.case import load_case
from ddf.output.results import open_run
from ddf.run import run_case

SMALL = (
    "frame.length_mm=220", "frame.width_mm=180", "plies.0.size_mm=[100,100]", "plies.0.element_mm=10",
    "diaphragms.element_mm=10", "output.pictures=false", "output.history_interval_steps=50",
    "output.frames_per_stage=40", "output.checkpoint_interval_s=0.05", "process.settled_percent=0",
)  # fmt: skip
PAGE_BYTES = 4096


def _memory_mib():
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE_BYTES / 2**20


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs /proc")
def test_memory_does_not_grow_and_what_is_written_stays_consistent(request, tmp_path, monkeypatch):
    monkeypatch.setattr(ddf.run.loop, "REPORT_EVERY_S", 0.0)
    case = load_case(request.config.rootpath / "cases/flat-stack.toml", SMALL)
    memory, told = [], []
    result = run_case(
        case, tmp_path / "run", threads=1, report=lambda p: (memory.append(_memory_mib()), told.append(p))
    )
    assert result.stop_reason == "finished"
    assert len(memory) > 20
    half = len(memory) // 2
    assert max(memory[half:]) - max(memory[:half]) < 10.0  # a state of this run takes 0.4 MiB
    # progress is true: steps rise to the end, what is left falls to nothing
    steps = [progress.step for progress in told]
    assert steps == sorted(steps)
    assert steps[-1] == told[-1].steps == result.step
    assert told[-1].remaining_s < 1e-6 * told[-1].elapsed_s + 1e-9
    run = open_run(tmp_path / "run")
    with open(tmp_path / "run/history.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert np.all(np.diff([int(row["step"]) for row in rows]) > 0)
    times = [time for time, _ in run.frames("ply-1")]
    assert len(told) / 2 < len(times) <= 1 + 40 * len(case.process.stages)  # no more than looks at the state
    assert np.all(np.diff(times) > 0)
    assert times == [time for time, _ in run.frames("bottom-diaphragm")]


def test_a_clock_that_jumps_changes_nothing(request, tmp_path, monkeypatch):
    case = load_case(request.config.rootpath / "cases/flat-stack.toml", (*SMALL, "output.frames_per_stage=2"))
    run_case(case, tmp_path / "steady", threads=1)
    real, calls = time.time, []

    def jumping():
        calls.append(1)
        return real() + (-1) ** len(calls) * 86400.0

    monkeypatch.setattr(time, "time", jumping)
    run_case(case, tmp_path / "jumping", threads=1)
    steady, jumping_run = (np.load(tmp_path / name / "checkpoint.npz") for name in ("steady", "jumping"))
    for key in steady.files:
        if key.startswith("state_"):
            assert np.array_equal(steady[key], jumping_run[key], equal_nan=True), key
    info = open_run(tmp_path / "jumping").info
    assert all(0.0 <= seconds < 3600.0 for seconds in info["wall_s"].values())
