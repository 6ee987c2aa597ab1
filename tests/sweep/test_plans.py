"""What sweeps consist of: files with their faults, grids, draws, and the ready-made ones."""

from pathlib import Path

import numpy as np
import pytest

from ddf.case import load_case
from ddf.errors import CaseError, UsageError
from ddf.sweep.file import load_sweep
from ddf.sweep.named import NAMED
from ddf.sweep.plan import Range, grid_points, inline, latin_points
from ddf.sweep.runner import share_out
from ddf.sweep.sweep import make_plan

CASE = "cases/tetrahedron-0-90-coarse.toml"


@pytest.fixture
def sweep_file(tmp_path):
    def write(text):
        path = tmp_path / "sweep.toml"
        path.write_text(text.replace("BASE", str(Path(CASE).resolve())))
        return path

    return write


def test_grid_takes_every_combination(sweep_file):
    plan = load_sweep(sweep_file("""
case = "BASE"
method = "grid"
set.solver.threads = 1
[vary]
friction.ply_diaphragm = [0.1, 0.5]
"plies.0.orientation_deg" = [0, 30, 45]
"""))  # fmt: skip
    assert len(plan.points) == 6
    assert plan.points[1].changes == {"friction.ply_diaphragm": 0.1, "plies.0.orientation_deg": 30}
    case = plan.load(plan.points[5])
    assert (case.friction.ply_diaphragm, case.plies[0].orientation_deg, case.solver.threads) == (0.5, 45.0, 1)
    assert len({point.name.casefold() for point in plan.points}) == 6


def test_latin_hypercube_draws_once_from_each_part(sweep_file):
    ranges = {"a": Range(0.0, 10.0), "b": Range(1.0, 100.0, log=True)}
    points = latin_points(ranges, 10, seed=3)
    a = np.array([point.changes["a"] for point in points])
    b = np.log10([point.changes["b"] for point in points])
    assert sorted(np.floor(a)) == list(range(10))
    assert sorted(np.floor(5 * b)) == list(range(10))
    assert points == latin_points(ranges, 10, seed=3)
    assert points != latin_points(ranges, 10, seed=4)
    text = (
        'case = "BASE"\nmethod = "latin-hypercube"\nsamples = 4\n[vary]\nfriction.ply_ply = {low = 0.0, high = 0.5}\n'
    )
    plan = load_sweep(sweep_file(text))
    assert len(plan.points) == 4
    assert all(0 <= plan.load(point).friction.ply_ply <= 0.5 for point in plan.points)


def test_list_of_points_may_replace_whole_lists(sweep_file):
    plan = load_sweep(sweep_file("""
case = "BASE"
method = "list"
[[points]]
name = "two-plies"
plies = [{size_mm = [200, 200], orientation_deg = 45}, {size_mm = [200, 200]}]
[[points]]
name = "slow"
process.stages = [{name = "a", duration_s = 1.0, cavity_pressure_kPa = 0}]
""".replace("two-plies", "two-plies")))  # fmt: skip
    assert [point.name for point in plan.points] == ["two-plies", "slow"]
    assert [ply.orientation_deg for ply in plan.load(plan.points[0]).plies] == [45.0, 0.0]
    assert plan.load(plan.points[1]).process.duration_s == 1.0


def test_a_base_case_that_can_be_no_file(sweep_file):
    for name in ("a\\u0000b", "x" * 5000, "../nowhere.toml"):
        with pytest.raises(CaseError):
            load_sweep(sweep_file(f'case = "{name}"\nmethod = "grid"\n[vary]\nfriction.ply_ply = [0.1]\n'))


def test_all_faults_of_a_sweep_file_in_one_go(sweep_file):
    with pytest.raises(CaseError) as caught:
        load_sweep(sweep_file('case = "BASE"\nmethod = "gird"\nsample = 3\nworkers = 0\n'))
    text = str(caught.value)
    assert "3 faults in the sweep" in text
    assert "sweep.toml:2: method: 'gird' is not right" in text
    assert "did you mean 'grid'" in text
    assert "sweep.toml:3: sample: unknown key" in text
    assert "did you mean 'samples'" in text
    assert "sweep.toml:4: workers: 0 is not right; allowed: >= 1" in text
    with pytest.raises(CaseError) as caught:
        load_sweep(sweep_file("""case = "BASE"
method = "latin-hypercube"
[vary]
friction.ply_ply = {low = 0.5, high = 0.1}
friction.diaphragm_tool = 3
"""))  # fmt: skip
    text = str(caught.value)
    assert "samples: needed by" in text
    assert "sweep.toml:4: vary.friction.ply_ply: 0.5 is not below 0.1" in text
    assert "sweep.toml:5: vary.friction.diaphragm_tool: 3 is not a range" in text


def test_faults_of_the_cases_stand_at_the_line_that_makes_them(sweep_file):
    with pytest.raises(CaseError) as caught:
        load_sweep(sweep_file("""case = "BASE"
method = "grid"
[set]
solver.step_safty = 0.5
[vary]
friction.ply_ply = [0.1, -1.0]
plies.0.element_mm = [4, "fine"]
"""))  # fmt: skip
    text = str(caught.value)
    assert "sweep.toml:4: solver.step_safty: unknown key" in text
    assert "did you mean 'step_safety'" in text
    assert "sweep.toml:6: friction.ply_ply: -1.0 is out of range" in text
    assert "sweep.toml:7: plies.0.element_mm: 'fine' is not the right type" in text
    assert text.startswith("3 faults")


@pytest.mark.parametrize("name", NAMED)
def test_ready_made_sweeps_make_valid_cases(name):
    plan = make_plan(name)
    cases = [plan.load(point) for point in plan.points]
    assert len(cases) >= 3
    assert len({case.model_dump_json() for case in cases}) == len(cases)


def test_ready_made_sweeps_change_what_they_say():
    cases = {name: [make_plan(name).load(p) for p in make_plan(name).points] for name in NAMED}
    assert [case.friction.ply_ply for case in cases["friction"]] == [0.0, 0.14, 0.28, 0.42]
    assert all([p.orientation_deg for p in case.plies] == [45.0, 0.0] for case in cases["friction"])
    assert all([p.orientation_deg for p in case.plies] == [45.0, 0.0] for case in cases["loading"])
    lift_first, together, box_first = (case.process.stages for case in cases["loading"])
    assert [s.name for s in lift_first] == ["evacuate-cavity", "lift", "draw-down", "evacuate-box", "hold"]
    assert [s.name for s in box_first] == ["evacuate-cavity", "draw-down", "evacuate-box", "lift", "hold"]
    assert [s.duration_s for s in lift_first] == pytest.approx([0.02, 0.07, 0.1, 0.03, 0.02])
    assert [s.duration_s for s in box_first] == pytest.approx([0.02, 0.2, 0.03, 0.07, 0.02])  # hung free: more time
    assert [s.mass_damping_1_s for s in lift_first] == [None, None, 100.0, 100.0, 300.0]
    assert [s.mass_damping_1_s for s in box_first] == [None, 100.0, 100.0, 100.0, 300.0]
    assert [case.diaphragms.element_max_mm for case in cases["loading"]] == pytest.approx([30.0, 30.0, 82.0 / 5.0])
    assert len(together) == 4
    assert [s.tool_lift_mm for s in together[1:3]] == pytest.approx([82.0 * 10 / 13, 82.0])
    assert [s.box_pressure_kPa for s in together[1:3]] == [94.0, 0.0]
    assert [[p.orientation_deg for p in case.plies] for case in cases["layup"]] == [[0], [45], [45, 0], [0, 45]]
    assert [case.plies[0].element_mm for case in cases["mesh"]] == [8.0, 6.0, 4.0, 3.0]
    assert {case.tool.shape for case in cases["tool"]} == {"cube-corner-tetrahedron", "regular-tetrahedron"}


def test_sweeps_that_make_no_sense_are_refused():
    with pytest.raises(UsageError, match="did you mean 'friction'"):
        make_plan("frction")
    with pytest.raises(UsageError, match="lifts the tool"):
        make_plan("loading", Path("cases/flat-stack.toml"))
    with pytest.raises(UsageError, match="fillets"):
        make_plan("tool", Path("cases/hemisphere.toml"))


def test_values_survive_the_way_through_toml():
    import tomllib

    value = [{"name": 'a "b"', "n": 1, "x": 1e-07, "on": True, "list": [1.5, [2]], "odd key": {"y": -3}}]
    assert tomllib.loads(f"v = {inline(value)}")["v"] == value
    case = load_case(CASE, [f"plies.0.size_mm={inline((200.0, 150.0))}"])
    assert case.plies[0].size_mm == (200.0, 150.0)
    assert grid_points({"a": [1]})[0].name == "1-a-1"


def test_threads_are_shared_out():
    assert share_out(8, None, None, 4) == (4, 1)
    assert share_out(2, None, None, 8) == (2, 4)
    assert share_out(8, None, 2, 8) == (4, 2)
    assert share_out(8, 3, None, 8) == (3, 2)
    assert share_out(1, None, None, 8) == (1, 8)
    assert share_out(2, None, None, 64) == (2, 8)
    assert share_out(100, None, None, 64) == (64, 1)
