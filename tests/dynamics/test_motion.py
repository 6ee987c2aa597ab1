"""Whole steps of small scenes: conservation, rest, symmetry, and the same bits however they are run."""

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from ddf.dynamics.step import advance
from ddf.model import TOOL_FRICTION, TOOL_WORK, sheet_scalars, sheet_vectors
from ddf.monitors.energy import energies, sheet_strain
from ddf.simulate import Simulation

SMALL = (
    "frame.length_mm=220", "frame.width_mm=180", "plies.0.size_mm=[100,100]", "plies.0.element_mm=5",
    "diaphragms.element_mm=5",
)  # fmt: skip
FREE = (
    *SMALL, "diaphragms.gap_mm=100", "process.atmosphere_kPa=0.0001", "process.stages.0.cavity_pressure_kPa=0.0001",
    "solver.mass_damping_1_s=0",
)  # fmt: skip
FORMING = (
    "plies.0.element_mm=10", "diaphragms.element_mm=12", "process.stages.0.duration_s=0.002",
    "process.stages.1.duration_s=0.01", "process.stages.2.duration_s=0.01", "process.stages.3.duration_s=0.01",
)  # fmt: skip


def _middle_speed(scene, k):
    """Speeds at the time of the positions: half a kick with the last forces."""
    v, f = (sheet_vectors(scene.model, a, k) for a in (scene.state.v, scene.state.f))
    return v + 0.5 * scene.model.dt * sheet_scalars(scene.model, scene.model.inverse_mass, k) * f


def _smooth_push(scene, k, speed):
    """Give a sheet a smooth velocity, zero at held nodes."""
    x, v = (sheet_vectors(scene.model, a, k) for a in (scene.state.x, scene.state.v))
    s = (x - x.min(axis=(1, 2), keepdims=True)) / np.maximum(np.ptp(x, axis=(1, 2)), 1.0).reshape(3, 1, 1)
    bump = np.sin(np.pi * s[0]) * np.sin(np.pi * s[1])
    v[2] = speed * bump
    v[0] = 0.3 * speed * np.sin(2.0 * np.pi * s[0]) * np.sin(np.pi * s[1])


def test_free_diaphragms_keep_their_energy(make_scene):
    scene = make_scene("flat-stack", *FREE)
    for k in (0, 2):
        _smooth_push(scene, k, 2000.0 if k else -2000.0)
    sim, totals = Simulation(scene), []
    for _ in range(80):
        sim.advance(50)
        model, state = scene.model, scene.state
        row = []
        for k in (0, 2):
            mass = sheet_scalars(model, model.mass, k)
            kinetic = 0.5 * np.sum(mass * (_middle_speed(scene, k) ** 2).sum(axis=0))
            row.append((kinetic, sum(sheet_strain(model, state, k).values())))
        totals.append(row)
    totals = np.array(totals)  # (sample, sheet, kind)
    assert not scene.state.springs.any()
    total = totals.sum(axis=2)
    assert (totals[:, :, 1] > 0.5 * total).any()  # energy does go to and fro
    drift = total[-20:].mean(axis=0) / total[:20].mean(axis=0) - 1.0
    assert np.abs(drift).max() < 1e-3


def test_free_ply_keeps_its_momenta_and_never_gains_energy(make_scene):
    scene = make_scene("flat-stack", *FREE)
    model, state, rng = scene.model, scene.state, np.random.default_rng(0)
    mass = sheet_scalars(model, model.mass, 1)
    v = sheet_vectors(model, state.v, 1)
    v += rng.normal(size=v.shape) * 100.0 + np.array([50.0, 20.0, -30.0]).reshape(3, 1, 1)

    def momenta():
        q = (mass * sheet_vectors(model, state.v, 1)).reshape(3, -1).T
        return q.sum(axis=0), np.cross(sheet_vectors(model, state.x, 1).reshape(3, -1).T, q).sum(axis=0)

    def energy():
        return 0.5 * np.sum(mass * (sheet_vectors(model, state.v, 1) ** 2).sum(axis=0)) + sum(
            sheet_strain(model, state, 1).values()
        )

    linear, angular = momenta()
    size = np.sum(mass * np.abs(v))
    first, sim = energy(), Simulation(scene)
    for _ in range(4):
        sim.advance(250)
        p, l = momenta()
        assert np.abs(p - linear).max() < 1e-11 * size
        # the string's step loses a little where tension varies, see `elements.tension`; 50: half its width in mm
        assert np.abs(l - angular).max() < 1e-5 * size * 50.0
    assert energy() < first
    assert not state.springs.any()


def test_threads_do_not_change_a_bit(make_scene):
    scenes = [make_scene("tetrahedron-0-90-coarse", *FORMING) for _ in range(2)]
    for threads, scene in enumerate(scenes, 1):
        sim = Simulation(scene, threads)
        for _ in range(6):
            sim.advance(50)
        sim.close()
    one, two = (scene.state for scene in scenes)
    ledger = one.ledger.sum(axis=0)
    assert ledger[TOOL_WORK] > 0.0  # the tool has been reached
    assert ledger[TOOL_FRICTION] != 0.0
    for name, a, b in zip(one._fields, one, two, strict=True):
        assert np.array_equal(a, b), name


def test_state_is_all_that_a_resumed_run_needs(make_scene, copy_scene):
    scene = make_scene("tetrahedron-0-90-coarse", *FORMING)
    sim = Simulation(scene)
    for _ in range(3):
        sim.advance(50)
    again = copy_scene(scene)
    resumed = Simulation(again, 2)
    for _ in range(3):
        sim.advance(50)
        resumed.advance(50)
    resumed.close()
    assert resumed.step == 300
    for name, a, b in zip(scene.state._fields, scene.state, again.state, strict=True):
        assert np.array_equal(a, b), name


@pytest.fixture(scope="module")
def clamped(make_scene):
    """A flat stack, small but of 5 mm elements, evacuated and held; energies and a mirror error on the way."""
    scene = make_scene("flat-stack", *SMALL, "process.stages.0.duration_s=0.02", "process.stages.1.duration_s=0.02")
    sim, history = Simulation(scene), []
    while sim.step < scene.steps:
        sim.advance(min(10, scene.steps - sim.step))
        history.append((sim.time, energies(scene.model, scene.state)))
    return scene, history


def test_clamped_stack_comes_to_rest_and_stays_there(clamped):
    _, history = clamped
    work = max(abs(e.total_work) for _, e in history)
    assert work > 1.0
    late = [e.total_kinetic / work for time, e in history if time > 0.022]
    assert len(late) > 50
    assert max(late) < 1e-4
    assert late[-1] < 1e-5


def test_clamped_stack_is_in_contact_and_flat(clamped):
    scene, _ = clamped
    z = sheet_vectors(scene.model, scene.state.x, 1)[2]
    top, bottom = (sheet_vectors(scene.model, scene.state.x, k)[2] for k in (2, 0))
    assert np.abs(z).max() < 1e-3
    # pressure on springs in series: each face gives p/K
    give = 0.101325 / scene.case.solver.contact_stiffness_N_mm3
    middle = np.s_[top.shape[0] // 2, top.shape[1] // 2]
    assert top[middle] - bottom[middle] == pytest.approx(2.0 * (1.0 - give), rel=0.01)


def test_energy_balance_of_the_clamped_stack_closes(clamped):
    _, history = clamped
    # while the sheets still ring, energies of positions and of velocities half a step apart differ by some per cent
    assert max(abs(e.error_share) for time, e in history if time > 0.005) < 0.03
    assert max(abs(e.error_share) for time, e in history if time > 0.015) < 0.01


def test_flat_stack_stays_symmetric(clamped):
    scene, _ = clamped
    size = np.abs(scene.state.x).max()
    for k in range(3):
        x = sheet_vectors(scene.model, scene.state.x, k)
        for axis in (0, 1):
            mirrored = np.flip(x, axis + 1).copy()
            mirrored[axis] *= -1.0
            assert np.abs(mirrored - x).max() < 1e-9 * size, (k, axis)


def test_the_length_of_a_batch_does_not_matter(make_scene):
    damped = []
    for batch in (10, 50):
        scene = make_scene("flat-stack", *SMALL, "process.stages.0.duration_s=0.01", "process.stages.1.duration_s=0.02")
        sim = Simulation(scene)
        while sim.step < 300:
            sim.advance(batch)
        damped.append(energies(scene.model, scene.state).dissipated["contact_damping"])
    assert damped[1] == pytest.approx(damped[0], rel=0.05)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_step_allocates_nothing(make_scene, threads):
    scene = make_scene("flat-stack", *SMALL)
    sim = Simulation(scene, threads)
    sim.advance(5)
    _nrt_python.memsys_enable_stats()
    counts = []
    for steps in (10, 110):
        schedule = scene.path.schedule((sim.step + np.arange(steps)) * scene.model.dt, scene.base_z, scene.model.dt)
        before = rtsys.get_allocation_stats().alloc
        sim.team.run(advance, scene.model, scene.state, sim.work, schedule, sim.step, 1.0)
        counts.append(rtsys.get_allocation_stats().alloc - before)
    sim.close()
    _nrt_python.memsys_disable_stats()
    assert counts[0] == counts[1], "allocations a step"
