"""Rungs of the speed-accuracy study: what they change, how they are named, which are run."""

from pathlib import Path

import numpy as np
import pytest

from ddf.build import build_scene, load_path
from ddf.case import load_case
from ddf.errors import UsageError
from ddf.study.axes import AXES
from ddf.study.rungs import chosen_axes, make_rungs
from ddf.study.speed_accuracy import make_study
from ddf.sweep.plan import assignments

CASE = "tetrahedron-0-90-coarse"
CASE_PATH = Path("cases") / f"{CASE}.toml"


@pytest.fixture(scope="module")
def case():
    return load_case(CASE)


def _loaded(case, name, value):
    return load_case(CASE, assignments(AXES[name].change(case, value, {})))


def test_every_value_of_every_axis_makes_a_case_that_loads():
    study = make_study(CASE_PATH, chosen_axes((), {}, False), "cross")
    names = [rung.name for rung in study.rungs]
    assert len(set(names)) == len(names)
    assert names[0] == "finest"
    assert {"8mm", "4mm", "8mm_net", "8mm_shell-membrane", "4mm_bending-off", "8mm_skin-x1.5_mass-x4_time-x0.5"} <= set(
        names
    )
    for rung in study.rungs:
        study.plan.load(rung.point)


def test_load_time_keeps_pressures_lift_and_the_damping_of_each_stage(case):
    was, now = load_path(case), load_path(_loaded(case, "load-time", 0.5))
    np.testing.assert_allclose(now.time, 0.5 * was.time)
    np.testing.assert_allclose(now.damping * np.diff(now.time), was.damping * np.diff(was.time))
    for name in ("cavity", "box", "lift"):
        np.testing.assert_array_equal(getattr(now, name), getattr(was, name))


def test_mass_lengthens_the_step_by_its_root(case):
    steps = [build_scene(_loaded(case, "mass", value)).model.dt for value in (1.0, 4.0)]
    assert steps[1] / steps[0] == pytest.approx(2.0, rel=0.02)


def test_softer_fibres_are_those_of_the_same_fabric(case):
    from ddf.case import woven_material

    soft = _loaded(case, "fibre-modulus", 0.1)
    before, after = woven_material(case, case.plies[0].material), woven_material(soft, soft.plies[0].material)
    assert after.membrane_modulus_N_mm == pytest.approx([0.1 * e for e in before.membrane_modulus_N_mm])
    assert after.shear_modulus_polynomial_MPa == before.shear_modulus_polynomial_MPa


def test_sizes_of_diaphragms_are_counted_from_those_of_the_elements(case):
    axes = {"element": (2.0, 1.0), "diaphragm": (1.5, 1.0)}
    rungs = {rung.name: rung.changes for rung in make_rungs(case, axes, "grid")}
    assert set(rungs) == {"finest", "8mm", "8mm_skin-x1.5", "4mm_skin-x1.5"}
    assert rungs["finest"] == {}
    assert rungs["8mm_skin-x1.5"]["diaphragms.element_mm"] == pytest.approx(2.0 * 1.5 * case.diaphragms.element_mm)


def test_designs_and_the_quick_choice(case):
    axes = {"element": (2.0, 1.0), "mass": (4.0, 1.0, 0.5), "bending": ("off", "on")}
    counts = {design: len(make_rungs(case, axes, design)) for design in ("star", "cross", "grid")}
    assert counts == {"star": 5, "cross": 7, "grid": 12}
    quick = chosen_axes(("element", "mass"), {}, True)
    assert quick == {"element": (2.0, 1.0), "mass": (4.0, 1.0)}


@pytest.mark.parametrize(
    ("names", "values", "words"),
    [
        (("elemnt",), {}, "did you mean element"),
        ((), {"mass": ["heavy"]}, "factor"),
        ((), {"bending": ["2"]}, "off, on"),
    ],
)
def test_what_cannot_be_asked_for(names, values, words):
    with pytest.raises(UsageError) as caught:
        chosen_axes(names, values, False)
    assert words in str(caught.value)
