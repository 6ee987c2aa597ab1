"""`ddf verify paper`: what it runs, takes over, refuses and leaves. Nets stand in for formings (no wrinkles)."""

import csv
import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from ddf.case import load_case, resolved_toml
from ddf.claims import cases
from ddf.claims.cases import FORMINGS, UNKNOWNS, make_plan, wanted
from ddf.claims.claims import CLAIMS
from ddf.claims.verdict import REPRODUCED
from ddf.cli import main
from ddf.output.checkpoint import case_differences, case_hash
from ddf.run import run_case

NET = ("model=kinematic", "output.pictures=false", "kinematic.foot_radius_mm=20")
SETTINGS = [word for change in NET for word in ("--set", change)]


def paper(*words):
    return CliRunner().invoke(main, ["verify", "paper", "--quiet", "--coarse", *words])


def test_the_first_runs_are_the_shipped_cases():
    fine = {
        point.name: make_plan(wanted(1, False), False).load(point)
        for point in make_plan(wanted(1, False), False).points
    }
    for name, shipped in (("0-90", "0-90"), ("45", "45"), ("double", "double")):
        assert case_hash(fine[name]) == case_hash(load_case(Path(f"tetrahedron-{shipped}")))
    coarse = make_plan(wanted(3, True), True)
    made = {point.name: coarse.load(point) for point in coarse.points}
    assert len(made) == len(FORMINGS) * (3 + len(UNKNOWNS))
    assert len({case_hash(case) for case in made.values()}) == len(made)
    assert case_hash(made["0-90"]) == case_hash(load_case(Path("tetrahedron-0-90-coarse")))
    assert case_hash(made["double"]) == case_hash(load_case(Path("tetrahedron-double-coarse")))
    double = resolved_toml(made["double"])
    assert case_differences(double, resolved_toml(made["double-no-friction"])) == [
        "friction.ply_ply: 0.28 then, 0.0 now"
    ]
    assert case_differences(double, resolved_toml(made["double-repeat-2"])) == [
        "plies.0.element_mm: 4.0 then, 3.84 now", "plies.1.element_mm: 4.0 then, 3.84 now",
        "solver.tool_contact_stiffness_N_mm3: 75.0 then, 60.0 now", "output.pictures: True then, False now",
    ]  # fmt: skip
    assert made["gap-double-double"].diaphragms.gap_mm == 2.4
    order = [stage.name for stage in made["double-vacuum-first"].process.stages]
    assert order.index("evacuate-box") < order.index("lift")


def test_runs_take_over_and_results(tmp_path, monkeypatch):
    monkeypatch.setattr(cases, "FORMINGS", (cases.SINGLE, cases.TURNED))  # two processes are enough
    folder = tmp_path / "paper"
    plan = make_plan(wanted(1, False), True, NET)
    run_case(plan.load(plan.points[0]), folder / "runs/0-90")  # as `ddf run -o` leaves it
    before = (folder / "runs/0-90/run.json").stat().st_mtime_ns
    done = paper("--repeats", "1", "-o", str(folder), *SETTINGS)
    assert done.exit_code == 4, done.output  # a net says nothing of wrinkles
    assert "0 of 5 claims reproduced" in done.output
    assert "its wrinkles were not measured" in done.output
    assert "double: not run" in done.output
    assert (folder / "runs/0-90/run.json").stat().st_mtime_ns == before
    runs = {path: path.stat().st_mtime_ns for path in folder.glob("runs/*/run.json")}
    assert len(runs) == 2
    assert paper("--repeats", "1", "-o", str(folder), *SETTINGS).exit_code == 4
    assert {path: path.stat().st_mtime_ns for path in runs} == runs
    found = json.loads((folder / "claims.json").read_text())
    assert [claim["verdict"] for claim in found["claims"]] == ["no evidence"] * len(CLAIMS)
    assert not found["reproduced"]
    with (folder / "claims.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert {row["claim"] for row in rows} == {"1", "2", "3", "4", "5"}
    page, text = (folder / "claims.html").read_text(), (folder / "claims.md").read_text()
    assert "Claim 4" in page
    assert "## Claim 4" in text
    other = paper("--repeats", "1", "-o", str(folder), *SETTINGS, "--set", "kinematic.offset_mm=1")
    assert other.exit_code == 2
    assert "holds runs of other cases: 0-90, 45\n" in other.output


@pytest.mark.parametrize(
    ("words", "said"),
    [(["paper", "--quick"], "--quick means nothing for 'paper'"), (["tension", "--coarse"], "--coarse means nothing"),
     (["paper", "tension"], "goes by itself"), (["paper", "--list"], "by this name only")],
)  # fmt: skip
def test_what_goes_with_what(words, said):
    assert said in CliRunner().invoke(main, ["verify", *words]).output


@pytest.mark.slow
def test_the_claims_on_coarse_formings(tmp_path):
    """The whole command, without repeats: half an hour. What it finds is in docs/paper-claims.md."""
    done = paper("--repeats", "1", "-o", str(tmp_path / "paper"))
    found = json.loads((tmp_path / "paper/claims.json").read_text())
    verdicts = [claim["verdict"] for claim in found["claims"]]
    assert done.exit_code == (0 if set(verdicts) == {REPRODUCED} else 4), done.output
    assert verdicts[0] == REPRODUCED
    for claim in CLAIMS:
        assert (tmp_path / f"paper/pictures/claim-{claim.number}.png").stat().st_size > 50_000
