r"""Free vibration: energy that stays where the step is explicit, and what the implicit fibre tension takes.

Bending and shear are integrated by leapfrog, whose energy does not drift: a cantilever that swings in its first bending
mode, without damping, keeps U(x_n) + 1/2 m v^2, v the mean of the half steps' velocities around x_n. While
deflections are small the fibres are not stretched.

Fibre tension takes a backward Euler step. A fibre wave of frequency omega follows

    v' = v - omega^2 dt (q_n + dt v'),  q_(n+1) = q_n + dt v'
    (1 + omega^2 dt^2) q_(n+1) - 2 q_n + q_(n-1) = 0

so its amplitude goes with a factor z a step, |z|^2 = p = 1/(1 + omega^2 dt^2): it loses 1 - p of its energy.
Axial waves of a strip of length L, free at both ends, have omega = (2/a) sin(pi a / 2L) sqrt(E h / m).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddf.model import sheet_scalars
from ddf.monitors.energy import sheet_strain
from ddf.simulate import Simulation
from ddf.verify.problem import Answer, Check, Curve, Figure, FloatArray, Options, Problem
from ddf.verify.scenes import areal_mass, copied_state, fabric_of, held, march, ply_scene, positions, velocities

LENGTH_MM = 40.0
ELEMENT_MM = 2.0
STEPS, LOOKS = 10_000, 200
FIRST_ROOT = 1.8751040687
"""Of cos q cosh q = -1: the first mode's wave number times the length (clamped, free)."""
HEIGHTS = (1e-4, 0.3)
"""Of the tip over the length: small, and large enough to stretch fibres on the way."""
DRIFT_BOUND, FREQUENCY_BOUND, LOSS_BOUND = 0.001, 0.02, 0.02
WAVE_STEP = 0.05  # omega dt of the axial wave


def swing(options: Options, height: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times [s], energies [mJ] and the tip's heights [mm] of a cantilever let go from its first mode's shape."""
    fabric, a = fabric_of(options, bending=True), options.element_mm or ELEMENT_MM
    scene = ply_scene(fabric, (2.0 * a, LENGTH_MM + 0.5 * a), a)
    x, v = positions(scene), velocities(scene)
    clamp = np.zeros(x.shape[1:], bool)
    clamp[:, :2] = True
    scene = held(scene, clamp)
    s = np.maximum(x[1] - x[1, 0, 0] - 0.5 * float(scene.model.sheets[0]["a2"]), 0.0) / LENGTH_MM
    q, r = FIRST_ROOT * s, FIRST_ROOT
    ratio = (np.cosh(r) + np.cos(r)) / (np.sinh(r) + np.sin(r))
    x[2] = 0.5 * height * LENGTH_MM * (np.cosh(q) - np.cos(q) - ratio * (np.sinh(q) - np.sin(q)))
    x[2][clamp] = 0.0
    _keep_lengths(x, float(scene.model.sheets[0]["a2"]))
    mass = sheet_scalars(scene.model, scene.model.mass, 0)
    sim, rows = Simulation(scene), []
    for _ in range(LOOKS):
        march(sim, STEPS // LOOKS - 1)
        before, strain, time, tip = (
            v.copy(),
            sum(sheet_strain(scene.model, scene.state, 0).values()),
            sim.time,
            x[2, 1, -1],
        )
        march(sim, 1)
        rows.append((time, strain + 0.125 * np.sum(mass * ((before + v) ** 2).sum(axis=0)), tip))
    time, energy, tip = np.array(rows).T
    return time, energy, tip


def _keep_lengths(x: FloatArray, a: float) -> None:
    """Draw nodes back along y so that bars along the strip keep their length."""
    for j in range(1, x.shape[2]):
        x[1, :, j] = x[1, :, j - 1] + np.sqrt(a * a - (x[2, :, j] - x[2, :, j - 1]) ** 2)


def fibre_wave(options: Options) -> tuple[float, float]:
    """Energy that an axial wave loses a step, as expected and as measured."""
    fabric, a = fabric_of(options, bending=True), options.element_mm or ELEMENT_MM
    scene = ply_scene(fabric, (2.0 * a, LENGTH_MM), a)
    spacing = float(scene.model.sheets[0]["a2"])
    omega = (
        2.0
        / spacing
        * np.sin(0.5 * np.pi * spacing / LENGTH_MM)
        * np.sqrt(fabric.membrane_modulus_N_mm[1] / areal_mass(fabric))
    )
    scene = replace(scene, model=scene.model._replace(dt=WAVE_STEP / float(omega)), state=copied_state(scene.state))
    x, mass = positions(scene), sheet_scalars(scene.model, scene.model.mass, 0)
    flat = x.copy()
    shape = np.cos(np.pi * (x[1] + 0.5 * LENGTH_MM) / LENGTH_MM)
    x[1] += 1e-5 * shape
    sim, q = Simulation(scene), []
    for _ in range(200):
        march(sim, 1)
        q.append(np.sum(mass * shape * (x[1] - flat[1])))
    past = np.column_stack([q[1:-1], q[:-2]])
    (_, minus_p), *_ = np.linalg.lstsq(past, np.array(q[2:]), rcond=None)
    return 1.0 - 1.0 / (1.0 + WAVE_STEP**2), float(1.0 + minus_p)


def solve(options: Options) -> Answer:
    """Drift of a small swing, loss of a large one, and of a fibre wave."""
    fabric = fabric_of(options)
    curves: list[Curve] = []
    table: dict[str, FloatArray] = {}
    drifts = []
    for height in HEIGHTS:
        time, energy, tip = swing(options, height)
        fifth = LOOKS // 5
        drifts.append(float(energy[-fifth:].mean() / energy[:fifth].mean() - 1.0))
        curves.append(Curve(f"tip {height:g} L", time, 1e6 * (energy / energy[0] - 1.0), points=True))
        table |= {"time_s": time, f"energy_over_first_{height:g}": energy / energy[0], f"tip_{height:g}_mm": tip}
    curves.insert(0, Curve("kept", time[[0, -1]], np.zeros(2)))
    omega = (FIRST_ROOT / LENGTH_MM) ** 2 * np.sqrt(fabric.bending_rigidity_Nmm[1] / areal_mass(fabric))
    small = table[f"tip_{HEIGHTS[0]:g}_mm"]
    expected, got = fibre_wave(options)
    checks = (
        Check(f"energy drift, {STEPS} steps, tip {HEIGHTS[0]:g} L", "1", 0.0, drifts[0], DRIFT_BOUND, False),
        Check(
            "first frequency", "1/s", float(omega), _frequency(table["time_s"], small, float(omega)), FREQUENCY_BOUND
        ),
        Check(f"energy drift, {STEPS} steps, tip {HEIGHTS[1]:g} L", "1", 0.0, drifts[1], None, False),
        Check(f"loss of a fibre wave a step, omega dt = {WAVE_STEP:g}", "1", expected, got, LOSS_BOUND),
    )
    return Answer(checks, Figure("time [s]", "energy gained, of the first [1e-6]", tuple(curves)), table)


def _frequency(time: FloatArray, tip: FloatArray, near: float) -> float:
    """The frequency [1/s] near a guess whose cosine and sine fit best."""

    def rest(omega: float) -> float:
        waves = np.column_stack([np.cos(omega * time), np.sin(omega * time)])
        return float(np.sum((tip - waves @ np.linalg.lstsq(waves, tip, rcond=None)[0]) ** 2))

    found = near * np.linspace(0.9, 1.1, 2001)
    return float(found[np.argmin([rest(omega) for omega in found])])


PROBLEM = Problem("free-vibration", "Energy of free vibration", "no damping, no work; backward Euler's factor", solve)
