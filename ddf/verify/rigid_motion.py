"""Rigid motions and momenta of a ply: what holds for any deformation, whatever the material.

    flat ply turned and moved:      no force
    any deformation x:              sum f = 0,  sum x X f = 0,  f(R x + c) = R f(x)
    free motion with no damping:    linear and angular momentum stay

Forces are those of the step; sizes are relative to the largest force, or to the momenta of the parts. The implicit
string stiffness of tensioned fibres (`elements.tension`) loses angular momentum in proportion to the step, so its drift
is reported, and judged is that over the same time half of it is left at half the step.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddf.model import sheet_scalars
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.probe import Probe
from ddf.verify.problem import Answer, Check, Curve, Figure, FloatArray, Options, Problem
from ddf.verify.scenes import copied_state, fabric_of, march, ply_scene, positions, velocities

CELLS = 10
ELEMENT_MM = 3.0
STEPS, LOOKS = 2000, 20
BOUND = 1e-9
RATIO_BOUND = 0.1
SPEED_MM_S = 100.0


def rotation(rng: np.random.Generator) -> FloatArray:
    """A random rotation (3, 3)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q * np.linalg.det(q))


def _totals(x: FloatArray, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sum of the vectors p (3, n, m) and of their moments about the origin."""
    return p.sum(axis=(1, 2)), np.cross(x, p, axis=0).sum(axis=(1, 2))


def flight(scene: Scene, v: FloatArray, steps: int) -> FloatArray:
    """Drifts (2, LOOKS) of linear and angular momentum of a ply set off with velocities v (3, rows, cols)."""
    free = replace(scene, state=copied_state(scene.state))
    x, mass = positions(free), sheet_scalars(scene.model, scene.model.mass, 0)
    velocities(free)[:] = v
    scale, side = float(np.sum(mass * np.abs(v))), float(np.ptp(x[0]))
    start, sim, drifts = _totals(x, mass * v), Simulation(free), []
    for _ in range(LOOKS):
        march(sim, steps // LOOKS)
        now = _totals(x, mass * velocities(free))
        drifts.append((_largest(now[0] - start[0]) / scale, _largest(now[1] - start[1]) / scale / side))
    return np.array(drifts).T


def solve(options: Options) -> Answer:
    """Forces on a rumpled ply, then a free flight."""
    element = options.element_mm or ELEMENT_MM
    side = CELLS * element
    scene = ply_scene(fabric_of(options), (side, side), element)
    rng = np.random.default_rng(3)
    x = positions(scene)
    turn, away = rotation(rng), rng.uniform(-20.0, 20.0, 3).reshape(3, 1, 1)
    flat, rumpled = x.copy(), x + rng.uniform(-0.02, 0.02, x.shape) * element
    probe = Probe(scene)
    force = probe.forces(rumpled)
    size = float(np.abs(force).max())
    total, moment = _totals(rumpled, force)
    turned = probe.forces(np.tensordot(turn, rumpled, 1) + away)
    checks = [
        Check(
            "force on a flat ply turned and moved",
            "1",
            0.0,
            _largest(probe.forces(np.tensordot(turn, flat, 1) + away)) / size,
            BOUND,
            False,
        ),
        Check("sum of forces", "1", 0.0, _largest(total) / size, BOUND, False),
        Check("sum of moments over the side", "1", 0.0, _largest(moment) / size / side, BOUND, False),
        Check(
            "turned forces less forces turned",
            "1",
            0.0,
            _largest(turned - np.tensordot(turn, force, 1)) / size,
            BOUND,
            False,
        ),
    ]
    v = rng.normal(size=x.shape) * SPEED_MM_S + np.array([50.0, 20.0, -30.0]).reshape(3, 1, 1)
    steps = STEPS // 4 if options.quick else STEPS
    finer = replace(scene, model=scene.model._replace(dt=0.5 * scene.model.dt))
    drift, half = flight(scene, v, steps), flight(finer, v, 2 * steps)
    ratio = half[1, -1] / drift[1, -1]
    checks.append(Check(f"drift of linear momentum, {steps} steps", "1", 0.0, drift[0].max(), BOUND, False))
    checks.append(Check(f"drift of angular momentum, {steps} steps", "1", 0.0, drift[1].max(), None, False))
    checks.append(Check("the same at half the step, over it", "1", 0.5, ratio, RATIO_BOUND))
    at = np.arange(1, LOOKS + 1) * (steps // LOOKS)
    curves = (
        Curve("bound of the linear", at[[0, -1]].astype(float), np.full(2, BOUND)),
        Curve("linear", at.astype(float), np.maximum(drift[0], 1e-20), points=True),
        Curve("angular", at.astype(float), np.maximum(drift[1], 1e-20), points=True),
    )
    table = {"step": at.astype(float), "linear_drift": drift[0], "angular_drift": drift[1]}
    return Answer(tuple(checks), Figure("step", "drift of momentum", curves, log_y=True), table)


def _largest(values: FloatArray) -> float:
    return float(np.abs(values).max())


PROBLEM = Problem("rigid-motion", "Rigid motions and momenta of a ply", "invariance of the equations of motion", solve)
