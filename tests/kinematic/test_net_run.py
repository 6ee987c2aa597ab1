"""A kinematic case run as any other: its folder, its summary, its failures."""

import numpy as np
import pytest
from click.testing import CliRunner

from ddf.case import load_case
from ddf.cli import main
from ddf.errors import CaseError, DdfError
from ddf.output.results import open_run
from ddf.run import run_case
from ddf.verify import kinematic_net
from ddf.verify.problem import Options

CASE = """
model = "kinematic"
[[plies]]
size_mm = [160.0, 140.0]
element_mm = 8.0
[[plies]]
size_mm = [100.0, 100.0]
orientation_deg = 45.0
element_mm = 8.0
[tool]
shape = "hemisphere"
radius_mm = 60.0
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("net") / "net.toml"
    path.write_text(CASE)
    return path


@pytest.fixture(scope="module")
def folder(file):
    out = file.parent / "run"
    done = CliRunner().invoke(main, ["run", str(file), "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert "ply-1: shear up to" in done.output
    assert "locked" in done.output
    return out


def test_folder_reads_like_a_forming_run(folder):
    run = open_run(folder)
    assert run.info["stop_reason"] == "finished"
    assert [ply["ply"] for ply in run.metrics["plies"]] == ["ply-1", "ply-2"]
    flat, draped = run.read_frame("ply-1", 0), run.read_frame("ply-1", 1)
    assert np.ptp(flat["points"][:, 2]) < 1e-9
    assert np.ptp(draped["points"][:, 2]) > 40.0
    assert np.abs(draped["shear_angle_deg"]).max() == pytest.approx(run.metrics["plies"][0]["shear_max_deg"], abs=1e-3)
    profile = run.profile("ply-1")
    assert np.abs(profile["x0_mm"]).max() == pytest.approx(80.0)
    for name in ("patterns/ply-1.csv", "patterns/ply-1-nodes.csv", "pictures/shear-ply-2.png", "report.html"):
        assert (folder / name).stat().st_size > 0


def test_locked_share_is_the_area_beyond_the_angle(folder, file, tmp_path):
    run_case(load_case(file, ["kinematic.locking_deg=20", "output.pictures=false"]), tmp_path / "run")
    angle = np.abs(open_run(folder).read_frame("ply-1")["shear_angle_deg"])
    locked = open_run(tmp_path / "run").metrics["plies"][0]["locked_area_percent"]
    assert locked == pytest.approx(100 * (angle > 20.0).mean(), abs=0.5)
    assert locked > 5.0


def test_a_net_that_fails_leaves_what_was_laid(file, tmp_path):
    sharp = [
        "plies.0.size_mm=[300, 300]",
        "plies.0.element_mm=4",
        "kinematic.foot_radius_mm=0",
        "output.pictures=false",
    ]
    with pytest.raises(DdfError, match=r"ply-1: the net cannot be laid beyond node"):
        run_case(load_case(file, sharp), tmp_path / "run")
    run = open_run(tmp_path / "run")
    assert run.info["stop_reason"] == "failed"
    assert "start_mm" in run.info["message"]
    assert 5.0 < run.metrics["plies"][0]["laid_percent"] < 99.0
    assert run.metrics["plies"][1]["laid_percent"] == pytest.approx(100.0)


def test_faults_of_a_kinematic_case_have_their_place(file):
    with pytest.raises(CaseError) as caught:
        load_case(file, ["kinematic.start_mm=[60, 60]", "kinematic.locking_deg=95", "model=kinematik"])
    text = str(caught.value)
    assert "kinematic.locking_deg: 95 is out of range" in text
    assert "did you mean 'kinematic'" in text
    with pytest.raises(CaseError, match=r"start_mm: \(60, 60\) mm is not on the fabric of plies.1"):
        load_case(file, ["kinematic.start_mm=[60, 60]"])


def test_check_tells_whether_the_net_closes(file):
    done = CliRunner().invoke(main, ["check", str(file)])
    assert done.exit_code == 0
    assert "100.0 % of the ply" in done.output
    assert done.output.count("100.0 %") == 2


def test_report_is_drawn_again(file, tmp_path):
    run_case(load_case(file, ["output.pictures=false"]), tmp_path / "run")
    (tmp_path / "run" / "report.html").unlink()
    assert CliRunner().invoke(main, ["report", str(tmp_path / "run")]).exit_code == 0
    assert (tmp_path / "run" / "report.html").stat().st_size > 0


def test_verification_notices_a_wrong_net(monkeypatch):
    right = kinematic_net.drape_ply
    monkeypatch.setattr(kinematic_net, "drape_ply", lambda ply, field, start: right(ply, field, start, 0.1))
    assert not kinematic_net.PROBLEM.solve(Options(quick=True)).passed
