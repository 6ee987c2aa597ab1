"""Every shipped case in coarse form: it is checked without a fault, and its first steps are sound."""

from pathlib import Path

import numpy as np
import pytest

from ddf.case import load_case
from ddf.case.load import load_source
from ddf.describe import describe_scene
from ddf.model import sheet_vectors
from ddf.monitors.energy import energies
from ddf.monitors.stability import check_state
from ddf.plausible import prepare
from ddf.simulate import Simulation

CASES = sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))
STEPS = 240  # beyond the first contacts of all layers


def coarse(path):
    plies = len(load_case(path).plies)
    return [*(f"plies.{k}.element_mm=8" for k in range(plies)), "diaphragms.element_mm=10"]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_case_is_checked_and_begins_soundly(path):
    assert path.read_text().startswith("# ")  # says what it shows
    case, source = load_source(path, coarse(path))
    scene = prepare(case, source, print)
    assert case.title in describe_scene(scene)
    start = scene.state.x.copy()
    sim = Simulation(scene)
    try:
        sim.advance(STEPS)
    finally:
        sim.close()
    assert check_state(scene.model, scene.state, [sheet.name for sheet in scene.sheets], start) is None
    bottom, top = (sheet_vectors(scene.model, scene.state.x, k)[2] for k in (0, len(scene.sheets) - 1))
    middle = bottom.shape[0] // 2, bottom.shape[1] // 2
    first = sheet_vectors(scene.model, start, 0)[2]
    assert bottom[middle] > first[middle]  # the cavity's vacuum draws the diaphragms together
    assert 0.0 < (top - bottom)[middle] < 2 * abs(first[middle])
    energy = energies(scene.model, scene.state)
    assert energy.total_work > 0
    assert abs(energy.error) < 0.05 * energy.total_work
    assert np.isfinite(scene.state.v).all()
