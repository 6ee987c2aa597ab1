"""Fidelity "auto": the rung that is chosen, why, and what the run says of it."""

import json

import pytest
from click.testing import CliRunner

from ddf.case import load_case
from ddf.cli import main
from ddf.errors import UsageError
from ddf.fidelity import choose
from ddf.output.results import open_run
from ddf.run import run_case


@pytest.fixture
def auto(request):
    """A shipped case with fidelity auto and further overrides."""

    def make(name, *overrides):
        return load_case(request.config.rootpath / f"cases/{name}.toml", ("fidelity=auto", *overrides))

    return make


def test_with_time_enough_the_most_accurate_rung_within_it(auto):
    names = [
        choose(auto("tetrahedron-0-90", f"target.seconds={t}"), 2).chosen.rung.name for t in (1e6, 60.0, 30.0, 2.0)
    ]
    assert names == ["fine-slow", "coarse-slow", "coarse", "net"]  # by half: the scene is its own mirror image


def test_one_thread_affords_less_than_two(auto):
    case = auto("tetrahedron-0-90", "target.seconds=60")
    one, two = choose(case, 1).chosen, choose(case, 2).chosen
    assert one.error_mm > two.error_mm
    assert two.seconds <= 60.0


def test_the_cheapest_rung_that_is_accurate_enough(auto):
    choice = choose(auto("tetrahedron-0-90", "target.accuracy_mm=0.35"), 2)
    assert choice.chosen.rung.name == "coarse"  # the quick one is not near enough, slower ones are dearer
    choice = choose(auto("tetrahedron-0-90", "target.accuracy_mm=1e-6"), 2)
    assert choice.chosen.rung.name == "fine-slow"


def test_rungs_that_the_scene_does_not_bear_are_left_out_and_say_why(auto):
    choice = choose(auto("tetrahedron-double", "target.accuracy_mm=5.0", "tool.fillet_mm=2.0"), 2)
    reasons = {step.rung.name: step.obstacle for step in choice.steps}
    assert "each ply by itself" in reasons["net"]
    assert "fillet_mm: 2 is far below the diaphragm's element of 5" in reasons["coarse"]
    assert choice.chosen.rung.name == "medium-slow"
    text = "\n".join(choice.lines())
    assert "not net: a net drapes each ply by itself" in text
    assert "->  medium-slow" in text


def test_elements_too_large_for_the_tightest_wrinkles_are_left_out(auto):
    choice = choose(auto("tetrahedron-0-90", "target.accuracy_mm=0.35", "diaphragms.thickness_mm=0.9"), 2)
    reasons = {step.rung.name: step.obstacle for step in choice.steps}
    assert "tightest wrinkles" in reasons["coarse"]
    assert choice.chosen.rung.name == "medium-slow"


def test_no_valid_rung_is_an_error_that_lists_all(auto):
    with pytest.raises(UsageError, match="no rung of the ladder is valid") as caught:
        choose(auto("tetrahedron-double", "target.seconds=60", "tool.fillet_mm=0.5"), 2)
    assert "fine-slow: fillet_mm: 0.5 is far below" in str(caught.value)


def test_a_run_says_which_rung_it_stands_on_and_goes_on_with_it(auto, tmp_path):
    case = auto("hemisphere", "target.seconds=0.5", "output.pictures=false")
    said = []
    result = run_case(case, tmp_path / "run", threads=1, warn=said.append)
    assert said[0].startswith("fidelity: net")
    assert result.notes[0].startswith("fidelity: net")
    record = json.loads((tmp_path / "run/run.json").read_text())["fidelity"]
    assert record["rung"] == "net"
    assert len(record["ladder"]) == 6
    resolved = load_case(tmp_path / "run/case.resolved.toml")
    assert (resolved.fidelity, resolved.model) == ("as-given", "kinematic")
    # gone on with, the rung stays, whatever the target would give now
    again = auto("hemisphere", "target.seconds=1e6")
    kept = choose(again.model_copy(update={"output": case.output}), 2, tmp_path / "run")
    assert (kept.chosen.rung.name, kept.why) == ("net", "as the run was begun")


def test_time_asked_for_is_audited(auto, tmp_path, monkeypatch):
    monkeypatch.setattr("ddf.fidelity.choice.NET_SECONDS", 1e9)  # so that elements are chosen
    small = ("plies.0.size_mm=[60.0, 60.0]", "frame.length_mm=200", "frame.width_mm=200", "tool.radius_mm=15.0")
    fast = [f"process.stages.{k}.duration_s=0.003" for k in range(5)]
    fast += ["process.stages.1.tool_lift_mm=2.0", "output.pictures=false", "output.vtu=false"]
    case = auto("hemisphere", "target.seconds=1e-3", *small, *fast)
    result = run_case(case, tmp_path / "run", threads=1)
    (check,) = [check for check in result.checks if check["name"] == "wall time of the steps"]
    assert check["limit"] == 1e-3
    assert check["value"] > 1e-3
    assert not check["ok"]
    assert open_run(tmp_path / "run").info["fidelity"]["why"].startswith("the cheapest: none that is valid")


def test_check_prints_the_ladder(request):
    case = str(request.config.rootpath / "cases/tetrahedron-0-90.toml")
    done = CliRunner().invoke(main, ["check", case, "--set", "fidelity=auto", "--set", "target.seconds=60"])
    assert done.exit_code == 0
    assert "fidelity: " in done.output
    assert "about" in done.output
    assert "plies are lattices" in done.output
