"""Errors, front and recommendations of the speed-accuracy study, and a whole small one, resumed."""

import csv
import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from ddf.cli import main
from ddf.compare.sites import Site
from ddf.study.accuracy import Cost, Errors, wrinkle_errors
from ddf.study.front import Result, pareto_front, recommended
from ddf.study.rungs import FINEST, Rung

NET = """
model = "kinematic"
[[plies]]
size_mm = [120.0, 120.0]
element_mm = 4.0
[tool]
shape = "hemisphere"
radius_mm = 50.0
"""


def _wrinkle(amplitude):
    return {"amplitude_mm": amplitude}


def test_wrinkles_that_only_one_run_has_count_in_full():
    both = Site("ply-1", _wrinkle(3.0), _wrinkle(5.0), 2.0)
    small = Site("ply-1", _wrinkle(1.0), _wrinkle(1.0), 10.0)
    lost = Site("ply-1", _wrinkle(4.0), None, None)
    position, amplitude = wrinkle_errors([both, small, lost])
    assert position == pytest.approx((2.0 * 4.0 + 10.0 * 1.0) / 5.0)
    assert amplitude == pytest.approx(((4.0 + 0.0 + 16.0) / 3.0) ** 0.5)
    assert wrinkle_errors([])[1] == 0.0


def _result(name, seconds, error, warnings=()):
    errors = Errors(error, 2 * error, 0.0, 0.0, 0, 0, 0.0)
    return Result(Rung(name, {}, {}), "finished", "", Cost(seconds, 1, 10, 1e-5, 100.0), errors, tuple(warnings))


def test_front_has_what_nothing_beats_and_leaves_out_what_is_unsound():
    results = [
        _result(FINEST, 900.0, 0.0), _result("slow", 300.0, 0.1), _result("middle", 50.0, 0.19),
        _result("worse", 60.0, 0.5), _result("fast", 8.0, 1.0), _result("net", 0.1, 6.0),
        _result("restless", 1.0, 0.01, ["kinetic over internal energy"]), _result("heavy", 20.0, 0.6, ["added mass"]),
        Result(Rung("broken", {}, {}), "failed", "it broke"),
    ]  # fmt: skip
    front = pareto_front(results)
    assert [result.rung.name for result in front] == ["net", "fast", "heavy", "middle", "slow"]
    chosen = {use: result.rung.name for use, result in recommended(front).items()}
    assert chosen == {"look": "fast", "design": "middle", "publish": "middle"}  # within twice the least error of all
    assert recommended([]) == {}


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    (folder / "net.toml").write_text(NET)
    command = [
        "study", "speed-accuracy", str(folder / "net.toml"), "--axis", "element", "--rungs", "element=3,1.5,1",
        "--design", "star", "--quiet", "--threads", "1", "-o", str(folder / "out"),
    ]  # fmt: skip
    return folder, command, CliRunner().invoke(main, command)


def test_a_whole_study_of_nets(study):
    folder, _, done = study
    assert done.exit_code == 0, done.output
    out = folder / "out"
    with (out / "study.csv").open(newline="") as stream:
        rows = {row["rung"]: row for row in csv.DictReader(stream)}
    assert set(rows) == {"finest", "12mm", "6mm"}
    assert float(rows["finest"]["outline_mean_mm"]) < 1e-9
    errors = [float(rows[name]["outline_mean_mm"]) for name in ("6mm", "12mm")]
    assert 1e-3 < errors[0] < errors[1]
    assert all(float(row["memory_MiB"]) > 50.0 and float(row["steps_s"]) > 0.0 for row in rows.values())
    found = json.loads((out / "study.json").read_text())
    assert set(found["recommended"]) == {"look", "design", "publish"}
    text = (out / "study.md").read_text()
    assert "--set plies.0.element_mm=" in text
    assert (out / "study.png").stat().st_size > 20_000


def test_it_goes_on_where_it_was(study):
    folder, command, _ = study
    assert CliRunner().invoke(main, command).exit_code == 2  # in use
    kept = (folder / "out/runs/6mm/run.json").stat().st_mtime_ns
    (folder / "out/runs/12mm/run.json").unlink()
    again = CliRunner().invoke(main, [*command, "--resume"])
    assert again.exit_code == 0, again.output
    assert (folder / "out/runs/6mm/run.json").stat().st_mtime_ns == kept
    assert (folder / "out/runs/12mm/run.json").exists()


def test_list_runs_nothing_and_a_rung_that_fails_is_told(tmp_path):
    (tmp_path / "net.toml").write_text(NET)
    command = ["study", "speed-accuracy", str(tmp_path / "net.toml"), "--axis", "element", "--quick", "--list"]
    done = CliRunner().invoke(main, command)
    assert done.exit_code == 0
    assert "element: elements of plies and diaphragms; 2.0, 1.0" in done.output
    assert not Path(tmp_path / "runs").exists()
    one = CliRunner().invoke(main, [*command[:5], "--rungs", "element=1"])
    assert one.exit_code == 2
    assert "nothing to compare" in one.output
