"""Every limit: its safe side is right, and what lies beyond is caught by a guard, not returned as a result."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from ddf.cli import main
from ddf.study.stability import registry
from ddf.study.stability.map import CAUGHT, STABLE, WARNED, WRONG, Limit, Map, RuleLine, Spot
from ddf.study.stability.registry import LIMITS, load_limit
from ddf.study.stability.shear_bands import row_angles
from ddf.verify.problem import Options
from ddf.verify.scenes import fabric_of

NO_LIMIT = ("fibre-step", "shear-bands-monotone")  # safe everywhere


@pytest.mark.parametrize("name", LIMITS)
def test_safe_side_is_safe_and_the_other_is_caught(name):
    chart = load_limit(name).chart(True)
    assert chart.failures == []
    safe = [spot for spot in chart.spots if spot.safe]
    beyond = [spot for spot in chart.spots if not spot.safe]
    assert safe
    assert all(spot.verdict == STABLE for spot in safe)
    assert bool(beyond) == (name not in NO_LIMIT)
    assert all(spot.verdict in CAUGHT and spot.guard for spot in beyond)


def test_fibres_that_bend_in_the_plane_give_bands_a_width_of_their_own():
    steepest = {}  # deg/mm
    for rigidity in (0.0, 0.34):
        fabric = fabric_of(Options()).model_copy(update={"shear_law": "published", "in_plane_bending_Nmm": rigidity})
        steepest[rigidity] = [np.abs(np.diff(row_angles(fabric, size, 9.0))).max() / size for size in (2.0, 4.0)]
    fine, coarse = steepest[0.0]
    assert fine == pytest.approx(2.0 * coarse, rel=0.1)  # the same step, from one row to the next
    fine, coarse = steepest[0.34]
    assert fine == pytest.approx(coarse, rel=0.1)
    assert fine < 0.35


def _limit(name, verdict, safe):
    ends = np.array([0.5, 2.0])
    spots = (Spot(1.0, 1.0, True, STABLE, 0.1), Spot(2.0, 1.0, safe, verdict, 3.0, "a guard" * (verdict == WARNED)))
    made = Map("step", "mass", "error [mm]", spots, (RuleLine("rule", np.full(2, 1.5), ends),), notes=("a note",))
    return Limit(name, name, "up to 1.5", lambda quick: made)


@pytest.fixture
def run(monkeypatch, tmp_path):
    limits = {
        "caught": _limit("caught", WARNED, False), "missed": _limit("missed", WRONG, False),
        "cautious": _limit("cautious", WARNED, True),
    }  # fmt: skip
    monkeypatch.setattr(registry, "LIMITS", limits)
    monkeypatch.setattr(registry, "load_limit", limits.__getitem__)
    return lambda *names: CliRunner().invoke(main, ["study", "stability", *names, "-o", str(tmp_path)])


def test_what_is_caught_passes(run, tmp_path):
    done = run("caught")
    assert done.exit_code == 0, done.output
    assert "caught: 1 stable, 1 warned" in done.output
    assert "a note" in done.output
    assert (tmp_path / "caught.png").stat().st_size > 10_000
    assert (tmp_path / "caught.csv").read_text().splitlines()[0] == "x,y,safe,verdict,measure,guard"
    assert "| caught | up to 1.5 | 1 stable | 1 warned | 0 |" in (tmp_path / "stability.md").read_text()


@pytest.mark.parametrize("name", ["missed", "cautious"])
def test_wrong_results_and_warnings_on_the_safe_side_fail(run, tmp_path, name):
    done = run("caught", name)
    assert done.exit_code == 4
    assert f"not as the rules say: {name}" in done.output
    found = json.loads((tmp_path / "stability.json").read_text())["limits"]
    assert [len(item["failures"]) for item in found] == [0, 1]


def test_unknown_names_and_the_list(run):
    done = run("cuaght")
    assert done.exit_code == 2
    assert "did you mean caught" in done.output
    assert "cautious" in run("--list").output
