"""The command: names, exit codes, what it leaves in its folder."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

from ddf.cli import main
from ddf.errors import DdfError
from ddf.verify import registry
from ddf.verify.problem import Answer, Check, Curve, Figure, Problem, worst


def _answer(got):
    line = np.array([0.0, 1.0])
    figure = Figure("x [mm]", "force [N]", (Curve("known", line, line), Curve("ddf", line, line, points=True)))
    return Answer((Check("force", "N", 1.0, got, 0.01),), figure, {"x_mm": line, "force_N": line}, ("a note",))


def _broken(options):
    raise DdfError("it broke")


PROBLEMS = {
    "near": Problem("near", "Near", "a book", lambda options: _answer(1.001)),
    "far": Problem("far", "Far", "a book", lambda options: _answer(1.1)),
    "broken": Problem("broken", "Broken", "a book", _broken),
}


@pytest.fixture
def run(monkeypatch, tmp_path):
    monkeypatch.setattr(registry, "MODULES", dict.fromkeys(PROBLEMS, ""))
    monkeypatch.setattr(registry, "load_problem", PROBLEMS.__getitem__)
    return lambda *names: CliRunner().invoke(main, ["verify", *names, "-o", str(tmp_path / "out")])


def test_unknown_names_are_usage_errors_with_near_misses(run):
    result = run("naer", "near")
    assert result.exit_code == 2
    assert "did you mean near" in result.output


def test_list_solves_nothing(run, tmp_path):
    result = run("--list")
    assert result.exit_code == 0
    assert [line.split()[0] for line in result.output.splitlines()] == [*PROBLEMS, "paper"]
    assert not (tmp_path / "out").exists()


def test_within_bounds(run, tmp_path):
    result = run("near")
    assert result.exit_code == 0
    assert "pass" in result.output
    assert "a note" in result.output
    assert (tmp_path / "out/near.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "out/near.csv").read_text().splitlines()[0] == "x_mm,force_N"


def test_a_miss_and_an_error_exit_with_4_after_all_others(run, tmp_path):
    result = run("broken", "far", "near")
    assert result.exit_code == 4
    assert "it broke" in result.output
    assert "MISS" in result.output
    found = json.loads((tmp_path / "out/results.json").read_text())
    assert [item["passed"] for item in found["results"]] == [False, False, True]
    assert found["results"][0]["message"] == "it broke"
    assert not found["passed"]
    assert found["packages"]["numpy"]
    with (tmp_path / "out/results.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["problem"] for row in rows] == ["far", "near"]
    worst = (tmp_path / "out/results.md").read_text().splitlines()
    assert worst[2:] == [
        "| far | 1 | force | 10 % | 1 % | MISS |",
        "| near | 1 | force | 0.1 % | 1 % | pass |",
    ]
    assert float(rows[0]["error"]) == pytest.approx(0.1)


@pytest.mark.parametrize(("got", "passed"), [(1.0, True), (1.02, False), (float("nan"), False)])
def test_checks(got, passed):
    assert Check("force", "N", 1.0, got, 0.01).passed is passed
    assert worst("force", "N", ["a", "b"], np.ones(2), np.array([1.0, got]), 0.01).passed is passed


def test_a_problem_of_the_other_formulation_is_a_usage_error(run):
    result = run("near", "--formulation", "shell-membrane")
    assert result.exit_code == 2
    assert "not a problem of the formulation shell-membrane: near" in result.output
