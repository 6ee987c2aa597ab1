"""The ladder of fidelity "auto": what its rungs change in a case, and what they leave alone."""

import pytest

from ddf.case import load_case
from ddf.fidelity.ladder import LADDER, at, mean_lift_speed, shorter_side

BY_NAME = {rung.name: rung for rung in LADDER}


@pytest.fixture
def auto(request):
    """A shipped case with fidelity auto and further overrides."""

    def make(name, *overrides):
        chosen = ("fidelity=auto", "target.seconds=60", *overrides)
        return load_case(request.config.rootpath / f"cases/{name}.toml", chosen)

    return make


def test_rungs_on_the_paper_s_case_are_what_was_measured(auto):
    case = auto("tetrahedron-0-90")
    assert shorter_side(case) == pytest.approx(350.0)
    assert mean_lift_speed(case) == pytest.approx(82.0 / 0.07)
    sizes = [
        (there.plies[0].element_mm, there.diaphragms.element_mm, sum(s.duration_s for s in there.process.stages))
        for there in (at(case, rung) for rung in LADDER[1:])
    ]
    wanted = [(4.0, 5.0, 0.12), (4.0, 5.0, 0.24), (4.0, 5.0, 0.48), (3.0, 3.75, 0.48), (2.0, 2.5, 0.48)]
    for found, (ply, skin, time) in zip(sizes, wanted, strict=True):
        assert found == pytest.approx((ply, skin, time), rel=1e-3)


def test_a_rung_changes_elements_and_times_and_nothing_else(auto):
    case = auto("tetrahedron-0-90", "solver.self_contact=false", "friction.ply_diaphragm=0.33")
    there = at(case, BY_NAME["coarse-slow"])
    assert (there.fidelity, there.target, there.solver.self_contact) == ("as-given", None, True)
    assert there.friction == case.friction
    assert there.tool == case.tool
    assert there.materials == case.materials
    assert [s.tool_lift_mm for s in there.process.stages] == [s.tool_lift_mm for s in case.process.stages]
    # so much more time at as much less damping: each stage is damped as much
    longer = 2.0
    for new, old in zip(there.process.stages, case.process.stages, strict=True):
        assert new.duration_s == pytest.approx(longer * old.duration_s, rel=1e-3)
        if old.mass_damping_1_s is not None:
            assert new.mass_damping_1_s == pytest.approx(old.mass_damping_1_s / longer, rel=1e-3)
    assert there.solver.mass_damping_1_s == pytest.approx(case.solver.mass_damping_1_s / longer, rel=1e-3)


def test_elements_go_with_the_ply_and_a_fast_lift_is_slowed(auto):
    case = auto("tetrahedron-0-90", "plies.0.size_mm=[700.0, 175.0]", "process.stages.1.duration_s=0.05")
    there = at(case, BY_NAME["coarse"])
    assert there.plies[0].element_mm == pytest.approx(2.0)
    assert there.process.stages[1].duration_s == pytest.approx(0.07)
    assert there.process.stages[2].duration_s == pytest.approx(1.4 * case.process.stages[2].duration_s)


def test_the_side_of_a_turned_ply_is_its_own_and_not_its_box_s(auto):
    assert shorter_side(auto("tetrahedron-45")) == pytest.approx(350.0)
