"""Fibre tension: implicit in the lattice, explicit with damping in shell-membrane plies.

The lattice takes fibre tension by backward Euler, so there are no inner steps and no resonance of a multi-rate step.
What could go wrong is left: a free, sheared ply shaken at random must lose energy at any step, measured by the step
over that of explicit fibres, a sqrt(m / E h). Shell-membrane plies take it explicitly, with damping z of critical at
the highest frequency: stable for  omega dt <= 2 (sqrt(1 + z^2) - z).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ddf.dynamics.timestep import damped_limit
from ddf.monitors.energy import energies
from ddf.monitors.stability import check_state
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.study.stability.map import STOPPED, FloatArray, Limit, Map, RuleLine, Spot, grid, judge
from ddf.verify.problem import SHELL_MEMBRANE, Options
from ddf.verify.scenes import areal_mass, erect_directors, fabric_of, march, ply_scene, positions, velocities

SIDE_MM, ELEMENT_MM = 40.0, 4.0
SPEED_MM_S = 100.0
STEPS, LOOK = 2000, 50
GAIN = 1.1
"""A free ply whose energy in the last quarter is more than this share of that in the first gains energy."""


def _shaken(scene: Scene, sheared: FloatArray | None = None) -> tuple[float, str]:
    """Energy at the end over that at the start, and what stopped it; a free ply with random velocities."""
    x, v = positions(scene), velocities(scene)
    if sheared is not None:
        x[:2] = np.tensordot(sheared, x[:2], 1)
    v += SPEED_MM_S * np.random.default_rng(0).normal(size=v.shape)
    start, sim, totals = scene.state.x.copy(), Simulation(scene), []
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(STEPS // LOOK):
            march(sim, LOOK)
            alarm = check_state(scene.model, scene.state, ["ply"], start)
            if alarm is not None:
                return math.inf, alarm.problem.partition(" of ")[0]
            energy = energies(scene.model, scene.state)
            totals.append(energy.total_kinetic + energy.total_strain)
    quarter = len(totals) // 4
    return float(np.mean(totals[-quarter:]) / np.mean(totals[:quarter])), ""


def _implicit(ratio: float, degrees: float) -> Spot:
    """The lattice: the modulus is what makes the step long."""
    fabric = fabric_of(Options())
    plain = ply_scene(fabric, (SIDE_MM, SIDE_MM), ELEMENT_MM)
    stiff = areal_mass(fabric) * (ratio * ELEMENT_MM / plain.model.dt) ** 2
    scene = ply_scene(
        fabric.model_copy(update={"membrane_modulus_N_mm": (stiff, stiff)}), (SIDE_MM, SIDE_MM), ELEMENT_MM
    )
    half = 0.5 * math.radians(degrees)
    gain, guard = _shaken(scene, np.array([[math.cos(half), math.sin(half)], [math.sin(half), math.cos(half)]]))
    verdict, guard = judge(gain < GAIN, STOPPED, guard)
    return Spot(ratio, degrees, True, verdict, gain, guard)


def _explicit(ratio: float, damping: float) -> Spot:
    """Shell-membrane: the step over the undamped limit."""
    fabric = fabric_of(Options())
    scene = ply_scene(fabric, (SIDE_MM, SIDE_MM), ELEMENT_MM, formulation=SHELL_MEMBRANE, fibre_damping=damping)
    omega = damped_limit(1.0, damping) / (scene.model.dt / scene.case.solver.step_safety)
    scene = replace(scene, model=scene.model._replace(dt=ratio * 2.0 / omega))
    erect_directors(scene, np.zeros(positions(scene).shape[1:], bool))
    gain, guard = _shaken(scene)
    safe = ratio <= scene.case.solver.step_safety * float(_limit(np.array(damping)))
    verdict, guard = judge(gain < GAIN, STOPPED, guard)
    return Spot(ratio, damping, safe, verdict, gain, guard)


def _limit(damping: FloatArray) -> FloatArray:
    """Stable step over the undamped one."""
    return np.sqrt(1.0 + damping**2) - damping


def _map(spot: Callable[[float, float], Spot], xs: tuple[float, ...], ys: tuple[float, ...], **rest: Any) -> Map:
    spots = tuple(spot(x, y) for x, y in grid(xs, ys))
    return Map(measure="energy at the end over that at the start", spots=spots, **rest)


def chart_implicit(quick: bool) -> Map:
    """Steps over the explicit fibres' and shear angles."""
    ratios, angles = ((100.0,), (0.0, 40.0)) if quick else ((10.0, 30.0, 100.0, 1000.0), (0.0, 20.0, 40.0, 60.0))
    return _map(
        _implicit, ratios, angles, x_label="step over a sqrt(m / E h)", y_label="shear angle [deg]",
        lines=(), log_y=False,
    )  # fmt: skip


def chart_explicit(quick: bool) -> Map:
    """Steps over the undamped limit and damping ratios."""
    ratios = (0.8, 1.2) if quick else (0.3, 0.5, 0.7, 0.8, 0.9, 1.1, 1.3)
    dampings = (0.06,) if quick else (0.0, 0.06, 0.2, 0.5)
    z = np.linspace(0.0, 0.55, 50)
    lines = (RuleLine("sqrt(1 + z^2) - z", _limit(z), z), RuleLine("0.85 of it: used", 0.85 * _limit(z), z))
    return _map(
        _explicit, ratios, dampings, x_label="step over the undamped limit", y_label="solver.fibre_damping",
        lines=lines, log_x=False, log_y=False,
    )  # fmt: skip


IMPLICIT = Limit(
    "fibre-step", "Implicit fibre tension of a lattice ply",
    "no limit: fibre tension is implicit (docs/solver.md), there are no inner steps to choose", chart_implicit,
)  # fmt: skip
EXPLICIT = Limit(
    "fibre-damping", "Explicit fibre tension of a shell-membrane ply",
    "omega dt <= 2 (sqrt(1 + z^2) - z), z = solver.fibre_damping, times step_safety", chart_explicit,
)  # fmt: skip
