"""A shell-membrane ply in the solver's own step: free flight with its rotations, and any number of threads."""

import numpy as np
import pytest

from ddf.model import sheet_scalars, sheet_shells
from ddf.monitors.energy import energies
from ddf.simulate import Simulation
from ddf.verify.problem import SHELL_MEMBRANE, Options
from ddf.verify.scenes import copied_state, fabric_of, march, ply_scene, positions, velocities


def _flight():
    """A ply of 11 x 11 nodes with its fibres askew, set off to stretch, shear, bend and turn."""
    scene = ply_scene(fabric_of(Options()), (30.0, 30.0), 3.0, formulation=SHELL_MEMBRANE, fibre_deg=20.0)
    x, v = positions(scene), velocities(scene)
    a, b = x[0] / 15.0, x[1] / 15.0
    v[0], v[1] = 50.0 + 100.0 * np.sin(2.0 * a) * np.cos(b), 20.0 - 200.0 * a + 80.0 * np.sin(a + 2.0 * b)
    v[2] = 500.0 * np.cos(2.0 * a + b) - 30.0
    return scene


def _momenta(scene):
    mass, x, v = sheet_scalars(scene.model, scene.model.mass, 0), positions(scene), velocities(scene)
    spin = sheet_shells(scene.model, scene.state.spin, 0, 3)
    turning = np.cross(x, mass * v, axis=0) + float(scene.model.sheets[0]["gyration"]) * mass * spin
    return (mass * v).sum(axis=(1, 2)), turning.sum(axis=(1, 2))


def test_free_flight_keeps_momenta_and_energy():
    scene = _flight()
    mass, size = sheet_scalars(scene.model, scene.model.mass, 0), 30.0
    scale = float(np.sum(mass * np.abs(velocities(scene))))
    linear, angular = _momenta(scene)
    before = energies(scene.model, scene.state).total_kinetic
    march(Simulation(scene), 2000)
    after, turned = _momenta(scene)
    assert np.abs(after - linear).max() < 1e-10 * scale
    assert np.abs(turned - angular).max() < 1e-6 * scale * size
    now = energies(scene.model, scene.state)
    assert now.total_kinetic < 0.9 * before  # some went into strain and into the fibres' damping
    assert now.total_kinetic + now.total_strain + now.dissipated["fibre_waves"] == pytest.approx(before, rel=0.005)


def test_threads_do_not_change_a_bit():
    first, second = _flight(), _flight()
    march(Simulation(first, 1), 50)
    sim = Simulation(second, 2)
    march(sim, 50)
    sim.close()
    for a, b in zip(copied_state(first.state), second.state, strict=True):
        assert np.array_equal(a, b)


def test_a_clamped_stack_keeps_its_energy_balance(make_scene):
    """A shell-membrane ply between diaphragms that are pressed on it, with the contacts of any other ply."""
    overrides = ("plies.0.formulation=shell-membrane", "plies.0.element_mm=10", "diaphragms.element_mm=10")
    scene = make_scene("flat-stack", *overrides, "process.stages.0.duration_s=0.003", "solver.mass_scaling=100")
    sim = Simulation(scene)
    while sim.time < 0.0035:
        sim.advance(50)
    found = energies(scene.model, scene.state)
    assert scene.state.springs.sum() > 0.0
    assert sum(found.strain[1].values()) > 0.0
    assert abs(found.error) < 0.01 * found.total_work
