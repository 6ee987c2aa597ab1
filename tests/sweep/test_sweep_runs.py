"""Whole sweeps: a failed case beside others, resumption, and a sweep that is killed."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from ddf.cli import main

NET = """
model = "kinematic"
output.pictures = false
[[plies]]
size_mm = [120.0, 120.0]
element_mm = 6.0
[tool]
shape = "hemisphere"
radius_mm = 60.0
"""

FORMING = {
    "plies.0.element_mm": 12.5, "diaphragms.element_mm": 14, "tool.fillet_mm": 15, "process.stages.0.duration_s": 0.004,
    "process.stages.1.duration_s": 0.02, "process.stages.2.duration_s": 0.004, "process.stages.3.duration_s": 0.002,
    "output.frames_per_stage": 2, "solver.energy_error_limit_percent": 100, "output.checkpoint_interval_s": 0.001,
    "output.pictures": "false",
}  # fmt: skip


def rows_of(file):
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def nets(tmp_path_factory):
    """A sweep of nets, one of which cannot close."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "net.toml").write_text(NET)
    (folder / "sizes.toml").write_text("""
title = "size"
case = "net.toml"
method = "list"
workers = 2
[[points]]
name = "small"
kinematic.offset_mm = 0.0
[[points]]
name = "cannot"
kinematic.offset_mm = 0.0
plies.0.size_mm = [300.0, 300.0]
plies.0.element_mm = 4.0
kinematic.foot_radius_mm = 0
[[points]]
name = "over"
kinematic.offset_mm = 5.0
""")
    done = CliRunner().invoke(main, ["sweep", str(folder / "sizes.toml"), "-o", str(folder / "out"), "--quiet"])
    return folder, done


def test_a_failed_case_is_recorded_and_the_rest_goes_on(nets):
    folder, done = nets
    assert done.exit_code == 5, done.output
    assert "3 cases: 2 computed, 0 reused, 1 failed" in done.output
    assert "failed: cannot: ply-1: the net cannot be laid beyond node" in done.output
    lines = [line.split() for line in done.output.splitlines() if line.startswith(("case ", "small ", "over "))]
    assert lines[0][:2] == ["case", "ply"]
    assert "locked" in lines[0]
    assert [line[:2] for line in lines[1:]] == [["small", "ply-1"], ["over", "ply-1"]]
    rows = {row["case"]: row for row in rows_of(folder / "out" / "table.csv")}
    assert "wrinkle_count" not in rows["small"]  # a net has none
    assert [rows[name]["state"] for name in ("small", "cannot", "over")] == ["finished", "failed", "finished"]
    assert "cannot be laid" in rows["cannot"]["reason"]
    assert float(rows["over"]["kinematic.offset_mm"]) == 5.0
    assert float(rows["over"]["shear_max_deg"]) < float(rows["small"]["shear_max_deg"])  # a rounder tool
    assert rows["cannot"]["shear_max_deg"] == ""
    for name in ("formed", "curves", "outlines"):
        assert (folder / "out" / "pictures" / f"{name}.png").stat().st_size > 10_000


def test_only_what_failed_runs_again(nets):
    folder, _ = nets
    out = folder / "out"
    before = {name: (out / "runs" / name / "run.json").stat().st_mtime_ns for name in ("small", "cannot", "over")}
    args = ["sweep", str(folder / "sizes.toml"), "-o", str(out), "--quiet"]
    assert CliRunner().invoke(main, args).exit_code == 2  # in use
    again = CliRunner().invoke(main, [*args, "--resume"])
    assert "0 computed, 2 reused, 1 failed" in again.output
    after = {name: (out / "runs" / name / "run.json").stat().st_mtime_ns for name in before}
    assert {name for name in before if after[name] != before[name]} == {"cannot"}
    other = CliRunner().invoke(main, [*args, "--resume", "--set", "kinematic.locking_deg=40"])
    assert other.exit_code == 2
    assert "holds another sweep" in other.output


def test_a_killed_sweep_goes_on_where_it_was(tmp_path):
    lines = "\n".join(f"{key} = {value}" for key, value in FORMING.items())
    base = Path("cases/tetrahedron-0-90-coarse.toml").resolve()
    file = tmp_path / "damping.toml"
    file.write_text(f"""
case = "{base}"
method = "grid"
workers = 1
threads = 1
[set]
{lines}
[vary]
solver.mass_damping_1_s = [30, 60]
""")
    out = tmp_path / "out"
    command = [sys.executable, "-c", "from ddf.cli import main; main()", "sweep", str(file), "-o", str(out)]
    started = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    first, second = (out / "runs" / name for name in ("1-mass_damping_1_s-30", "2-mass_damping_1_s-60"))
    began = time.monotonic()
    while not (second / "checkpoint.npz").exists():
        assert started.poll() is None, "ended before it was killed"
        assert time.monotonic() - began < 500
        time.sleep(0.005)
    assert json.loads((out / "manifest.json").read_text())["cases"][1]["name"] == second.name
    os.kill(started.pid, signal.SIGKILL)
    started.wait()
    time.sleep(1.0)  # the case's own process notices
    kept = (second / "history.csv").read_text().splitlines()[:2]
    size = (second / "history.csv").stat().st_size
    time.sleep(1.0)
    assert (second / "history.csv").stat().st_size == size, "the case's process lives on"
    assert not (second / "metrics.json").exists(), "the case had finished: nothing was in progress"
    finished = (first / "run.json").stat().st_mtime_ns

    done = subprocess.run([*command, "--resume"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "2 cases: 1 computed, 1 reused, 0 failed" in done.stdout
    assert (first / "run.json").stat().st_mtime_ns == finished
    assert (second / "history.csv").read_text().splitlines()[:2] == kept  # wall times too: it did not start again
    table = rows_of(out / "table.csv")
    assert [row["solver.mass_damping_1_s"] for row in table] == ["30", "60"]
    assert all(row["state"] == "finished" for row in table)
