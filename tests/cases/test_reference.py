"""The coarse form of the paper's 0/90 case against its committed metrics.

After buckling the smallest difference in arithmetic changes details, so the tolerances are those of a whole:
areas and draw-in closely, wrinkles by their total.
"""

import json
from pathlib import Path

import pytest
from crossings import crossings_of_frame

from ddf.case import load_case
from ddf.output.results import open_run
from ddf.run import run_case

REFERENCE = Path(__file__).with_name("tetrahedron-0-90-coarse.json")


@pytest.fixture(scope="module")
def formed(tmp_path_factory):
    case = load_case("cases/tetrahedron-0-90-coarse.toml")
    return run_case(case, tmp_path_factory.mktemp("coarse") / "run")


@pytest.fixture(scope="module")
def reference():
    return json.loads(REFERENCE.read_text())


def test_run_settles(formed):
    checks = {check["name"]: check for check in formed.checks}
    assert formed.stop_reason == "finished"
    assert checks["kinetic over internal energy"]["ok"]
    assert checks["deepest penetration of the tool"]["value"] < 0.5  # 5 mm elements over 5 mm fillets
    assert checks["gap over the tool's apex"]["value"] < 1.2  # the same; 1.0 is asked of finer meshes
    assert checks["energy balance error"]["ok"]
    assert checks["energy given back by what only takes"]["value"] < 0.01
    assert checks["taken by waves of the fibres"]["ok"]
    assert checks["taken by mass damping"]["value"] == pytest.approx(30.0, abs=5.0)
    # at the limit of the audit, 0.3 %, in the bars over the apex: 0.29 to 0.30 with changes of grid, masses and step
    assert checks["largest fibre strain"]["value"] == pytest.approx(0.30, abs=0.03)


def test_outline(formed, reference):
    ply = formed.plies[0]
    assert ply["outline_area_mm2"] == pytest.approx(reference["outline_area_mm2"], rel=0.01)
    for kind in ("draw_in_mid_side_mm", "draw_in_corner_mm"):
        for place, value in reference[kind].items():
            assert ply[kind][place] == pytest.approx(value, abs=3.0), (kind, place)


def test_shear(formed, reference):
    ply = formed.plies[0]
    assert ply["shear_mean_deg"] == pytest.approx(reference["shear_mean_deg"], rel=0.1)


def test_wrinkles(formed, reference):
    ply = formed.plies[0]
    assert ply["wrinkle_count"] >= 4
    assert ply["wrinkle_total_length_mm"] == pytest.approx(reference["wrinkle_total_length_mm"], rel=0.35)
    assert ply["wrinkle_largest_amplitude_mm"] == pytest.approx(reference["wrinkle_largest_amplitude_mm"], rel=0.35)


def test_no_sheet_crosses_itself(formed):
    run = open_run(formed.folder)
    for sheet in ("bottom-diaphragm", "ply-1", "top-diaphragm"):
        assert len(crossings_of_frame(run, [sheet])[sheet, sheet]) == 0
