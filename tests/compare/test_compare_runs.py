"""`ddf compare` on finished runs: kinematic ones, which take a second."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

from ddf.case import case_from_dict
from ddf.cli import main
from ddf.compare.runs import compare_runs
from ddf.errors import UsageError
from ddf.metrics import outline_area, shear_angle
from ddf.output.reopen import formed_ply
from ddf.output.results import open_run
from ddf.run import run_case

CASE = {
    "model": "kinematic",
    "plies": [{"size_mm": [150.0, 120.0], "orientation_deg": 30.0, "element_mm": 6.0}],
    "tool": {"shape": "hemisphere", "radius_mm": 50.0},
    "output": {"pictures": False},
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("compare")
    run_case(case_from_dict(CASE), folder / "a")
    run_case(case_from_dict(CASE | {"kinematic": {"start_mm": [12.0, 0.0]}}), folder / "b")
    return folder


def test_ply_comes_back_from_its_files(runs):
    run = open_run(runs / "a")
    ply = formed_ply(run, "ply-1")
    metrics = run.metrics["plies"][0]
    assert ply.spacing == pytest.approx((6.0, 6.0), rel=1e-6)
    assert ply.cell_fraction.sum() * 36.0 == pytest.approx(150.0 * 120.0, rel=0.002)
    assert np.abs(shear_angle(ply)).max() == pytest.approx(metrics["shear_max_deg"], rel=1e-4)
    assert outline_area([loop * 6.0 for loop in ply.outline]) == pytest.approx(18_000.0, rel=1e-3)


def test_a_run_equals_itself(runs, tmp_path):
    result = compare_runs(runs / "a", runs / "a", tmp_path / "same", pictures=False)
    ply = result.plies[0]
    assert ply.outline.largest_mm < 1e-6
    assert ply.shear.rms_deg < 1e-6
    assert all(a == b for a, b in ply.numbers.values())


def test_command_leaves_table_files_and_pictures(runs, tmp_path):
    out = tmp_path / "out"
    done = CliRunner().invoke(main, ["compare", str(runs / "a"), str(runs / "b"), "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert "outlines apart" in done.output
    assert "shear_max_deg" in done.output
    data = json.loads((out / "comparison.json").read_text())
    ply = data["plies"][0]
    assert ply["outline"]["largest_mm"] > 0.5
    assert 0.1 < ply["shear"]["rms_deg"] < 30.0
    with open(out / "metrics.csv", newline="") as stream:
        rows = {row["quantity"]: row for row in csv.DictReader(stream)}
    known = open_run(runs / "b").metrics["plies"][0]["shear_max_deg"]
    assert float(rows["shear_max_deg"]["b"]) == pytest.approx(known, rel=1e-4)
    for name in ("formed-ply-1", "shear-ply-1", "outlines-ply-1"):
        assert (out / "pictures" / f"{name}.png").stat().st_size > 10_000
    assert CliRunner().invoke(main, ["compare", str(runs / "a"), str(runs / "b"), "-o", str(out)]).exit_code == 2


def test_measured_outline_as_given_and_aligned(runs, tmp_path):
    profile = open_run(runs / "a").profile("ply-1")
    c, s = np.cos(np.radians(10.0)), np.sin(np.radians(10.0))
    turned = np.stack([profile["x_mm"], profile["y_mm"]], axis=1) @ [[c, s], [-s, c]] + [7.0, -3.0]
    file = tmp_path / "m.csv"
    file.write_text("x_mm,y_mm\n" + "".join(f"{x},{y}\n" for x, y in turned))
    given = compare_runs(runs / "a", runs / "b", tmp_path / "given", file, pictures=False)
    fitted = compare_runs(runs / "a", runs / "b", tmp_path / "fit", file, align=True, pictures=False)
    assert given.measured[0].fit is None
    assert given.measured[0].distances.mean_mm > 2.0
    assert fitted.measured[0].fit.turn_deg == pytest.approx(-10.0, abs=0.05)
    assert fitted.measured[0].distances.largest_mm < 0.1
    assert fitted.measured[1].distances.mean_mm > 0.2


def test_runs_without_a_common_ply_are_refused(runs, tmp_path):
    other = CASE | {"plies": [CASE["plies"][0] | {"name": "other"}]}
    run_case(case_from_dict(other), tmp_path / "c")
    with pytest.raises(UsageError, match="no ply is in both runs"):
        compare_runs(runs / "a", tmp_path / "c", tmp_path / "out")
