"""Stable steps: the bounds hold for the forces' own stiffness."""

import numpy as np
import pytest

from ddf.build.step import MOST_SCALING
from ddf.dynamics.timestep import contact_damping, damped_limit, diaphragm_omega2, ply_omega2


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.5, 1.0])
def test_damped_limit_is_the_limit_of_the_oscillator(ratio):
    omega = 1234.0

    def growth(dt):
        # v' = v - dt (omega^2 x + 2 z omega v); x' = x + dt v'
        a = np.array([[1.0 - 2 * ratio * omega * dt, -dt * omega**2]])
        step = np.vstack([a, [dt * a[0, 0], 1.0 + dt * a[0, 1]]])
        scale = np.diag([1.0, omega])
        return np.abs(np.linalg.eigvals(scale @ step @ np.linalg.inv(scale))).max()

    limit = damped_limit(omega, ratio)
    assert growth(0.999 * limit) <= 1.0 + 1e-9
    assert growth(1.001 * limit) > 1.0


def test_bounds_sum_their_parts():
    bare = ply_omega2(0.5, (0.3, 0.2), (2.0, 1.0), 0.0, 1e-9)
    assert bare == pytest.approx((4 * 0.5 * 1.25 + 16 * (0.3 / 16 + 0.2)) / 1e-9)
    assert ply_omega2(0.5, (0.3, 0.2), (2.0, 1.0), 3.0, 1e-9) - bare == pytest.approx(6e9)
    skin = diaphragm_omega2(0.96, 1.5, 1.1, 1.65e-9, 2.5, 0.0)
    assert diaphragm_omega2(0.96, 1.5, 1.1, 1.65e-9, 2.5, 2.0) - skin == pytest.approx(4.0 / 1.65e-9)


def test_contact_damping_is_a_fraction_of_critical():
    assert contact_damping(0.5, 2.0, 2e-9, 2e-9) == pytest.approx(np.sqrt(2.0 * 1e-9))
    assert contact_damping(0.5, 2.0, 2e-9, np.inf) == pytest.approx(np.sqrt(2.0 * 2e-9))


@pytest.mark.parametrize(("element", "least"), [(5, 1.0), (12, 0.97)])
def test_self_contact_costs_no_step_but_with_large_elements(make_scene, element, least):
    small = ("frame.length_mm=220", "frame.width_mm=180", "plies.0.size_mm=[100,100]", "plies.0.element_mm=5")
    with_it, without = (
        make_scene("flat-stack", *small, f"diaphragms.element_mm={element}", f"solver.self_contact={key}").model
        for key in ("true", "false")
    )
    assert least <= with_it.dt / without.dt <= 1.0
    own = with_it.pairs["slave"] == with_it.pairs["master"]
    assert sorted(with_it.pairs["slave"][own]) == [0, 0, 1, 1, 2, 2]
    assert not (without.pairs["slave"] == without.pairs["master"]).any()


SMALL = ("frame.length_mm=420", "frame.width_mm=300", "plies.0.size_mm=[100,100]", "plies.0.element_mm=5")


@pytest.mark.parametrize("scaling", [1.5, 6.0])
def test_plies_left_to_it_leave_the_step_to_the_diaphragms(make_scene, scaling):
    keys = (*SMALL, "diaphragms.element_mm=6", "solver.contact_stiffness_N_mm3=1",
            f"solver.diaphragm_mass_scaling={scaling}")  # fmt: skip
    scene = make_scene("flat-stack", *keys)
    own = scene.sheets[1].mass_scaling
    heavy, light = (make_scene("flat-stack", *keys, f"solver.mass_scaling={factor * own}").model.dt
                    for factor in (2.0, 0.4))  # fmt: skip
    assert 1.0 < own < MOST_SCALING * scaling + 1e-9
    assert scene.model.dt == pytest.approx(heavy, rel=0.04)
    assert light < 0.9 * scene.model.dt
