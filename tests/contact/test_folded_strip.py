"""A strip folded over that pressure closes: it goes through itself unless it touches itself."""

import dataclasses

import folded_strip as fold
import numpy as np
import pytest
from crossings import crossings

from ddf.contact.friction import TANGENTIAL
from ddf.model import CONTACT_DAMPING, FRICTION, State
from ddf.monitors.energy import energies
from ddf.simulate import Simulation
from ddf.verify.bench import come_to_rest

PRESSURE = 0.02


def _crossings(bench):
    return len(crossings(np.ascontiguousarray(bench.x().reshape(3, -1).T), fold.quads()))


def _kept(bench):
    energy = energies(bench.model, bench.state)
    return energy.total_kinetic + energy.total_strain + energy.contact_spring + sum(energy.dissipated.values())


def _touching(bench):
    nodes = bench.x().size // 3
    return [bench.state.place[5 * int(p["first"]) :][2 * nodes : 3 * nodes] < 0.0 for p in bench.model.pairs]


def test_a_closing_fold_crosses_itself_without_self_contact_only():
    for touches in (False, True):
        bench = fold.folded_strip(PRESSURE, 0.6, touches)
        sim, found, heat = bench.simulation(), 0, [0.0]
        while sim.time < 0.008:
            sim.advance(20)
            found = max(found, _crossings(bench))
            heat.append(bench.state.ledger[:, FRICTION].sum())
        assert (found > 0) != touches
    above, below = _touching(bench)
    assert above.sum() > 15
    assert not below.any()
    assert heat[-1] > 0.1
    assert (np.diff(heat) >= 0.0).all()


def test_a_stack_that_folds_keeps_its_order():
    for touches in (False, True):
        bench, q = fold.folded_stack(PRESSURE, touches), fold.quads(34)
        sim, found = bench.simulation(), 0
        while sim.time < 0.01:
            sim.advance(50)
            points = [np.ascontiguousarray(bench.x(k).reshape(3, -1).T) for k in range(3)]
            found += sum(len(crossings(p, q)) for p in points)
            found += sum(len(crossings(points[k], q, points[k + 1], q)) for k in range(2))
            if found:  # what sheets that went through themselves do to each other is of no use
                break
        assert (found > 0) != touches
    touching = [int(t.sum()) for t in _touching(bench)]
    # the inner diaphragm on itself; between the other sheets' flanks lie two layers and more
    assert touching[6] > 20
    assert touching[2:6] == [0, 0, 0, 0]


def test_a_closed_fold_comes_to_rest_with_its_thickness():
    bench = fold.folded_strip(PRESSURE, 0.6, damping=1000.0)
    sim = bench.simulation()
    assert come_to_rest(bench, sim, 20.0, 0.05)
    middle = bench.x()[2, 4:9, fold.WIDTH // 2], bench.x()[2, -9:-4, fold.WIDTH // 2][::-1]
    gap = (middle[1] - middle[0]).min()
    assert gap == pytest.approx(1.5 - PRESSURE / fold.STIFFNESS, abs=0.04)


def test_energy_of_flanks_thrown_together_is_accounted_for():
    bench = fold.folded_strip(0.0, 0.6, damping=0.0)
    free = bench.model.mass.reshape(fold.CELLS + 1, -1) > 0.0
    upper = np.arange(fold.CELLS + 1)[:, None] > fold.CELLS / 2
    bench.v()[2] = np.where(free, np.where(upper, -6000.0, 6000.0), 0.0)
    bench = dataclasses.replace(bench, model=bench.model._replace(dt=0.25 * bench.model.dt))
    sim, errors, touching = bench.simulation(), [], 0
    sim.advance(10)
    total = _kept(bench)
    while sim.time < 0.006:
        sim.advance(10)
        errors.append(_kept(bench) / total - 1.0)
        touching = max(touching, _touching(bench)[0].sum())
    assert touching > 10
    assert bench.state.ledger[:, CONTACT_DAMPING].sum() > 0.1 * total
    assert np.abs(errors).max() < 0.02  # while contacts begin; then
    assert abs(errors[-1]) < 0.002


def _run(bench, threads=1, steps=450):
    sim = bench.simulation(threads)
    sim.advance(steps)
    sim.close()
    return [array.copy() for array in bench.state]


def test_the_same_bits_with_two_threads_and_after_a_restart():
    one, two = (fold.folded_strip(PRESSURE, 0.6) for _ in range(2))
    first, second = _run(one), _run(two, threads=2)
    assert _touching(one)[0].sum() > 5
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))
    again = dataclasses.replace(one, state=State(*(array.copy() for array in one.state)))
    assert all(np.array_equal(a, b) for a, b in zip(_run(one), _run(again), strict=True))


def test_the_step_is_below_what_the_closed_fold_allows():
    """Power iteration on the forces of the closed fold: omega dt stays below 2."""
    bench = fold.folded_strip(PRESSURE, 0.6, damping=1000.0)
    sim = bench.simulation()
    sim.advance(900)
    assert _touching(bench)[0].sum() > 15
    start, rng = State(*(array.copy() for array in bench.state)), np.random.default_rng(0)
    free = bench.model.inverse_mass > 0.0
    n = free.size

    def force(move):
        for array, kept in zip(bench.state, start, strict=True):
            array[...] = kept
        bench.state.v[:] = 0.0
        bench.state.x[:] += move.ravel()
        one = Simulation(sim.scene)
        one.advance(1)
        one.close()
        return bench.state.f.reshape(3, n).copy()

    mode, still = rng.normal(size=(3, n)) * free, force(np.zeros((3, n)))
    for _ in range(60):
        mode *= 1e-5 / np.abs(mode).max()
        pulled = -(force(mode) - still) * bench.model.inverse_mass
        square = float((pulled * mode).sum() / (mode * mode).sum())
        mode = pulled
    assert square > 1e9 * TANGENTIAL
    assert np.sqrt(square) * bench.model.dt < 2.0
