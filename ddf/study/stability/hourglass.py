"""The hourglass coefficient of shell-membrane plies: a ply sent off in the pattern that its cells do not see.

Cells with one point of integration see no strain where neighbours move to and fro in turn. The control must bring such
a pattern back: the ply is free, and in the end it should lie as it did. The guards see the strain of the cells' edges,
of which the cells themselves know nothing. The lattice has no such pattern (`ddf verify zero-energy-modes`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddf.loads.path import LoadPath
from ddf.study.stability.map import Limit, Map, RuleLine, Spot, grid, judge
from ddf.study.stability.trial import run_guarded
from ddf.verify.problem import SHELL_MEMBRANE, Options
from ddf.verify.scenes import erect_directors, fabric_of, ply_scene, positions, velocities

COEFFICIENTS, QUICK_COEFFICIENTS = (0.0, 1e-4, 1e-3, 0.005, 0.05, 0.5), (0.0, 0.05)
SPEEDS, QUICK_SPEEDS = (20.0, 100.0, 400.0), (100.0,)  # mm/s
SIDE_MM, ELEMENT_MM = 40.0, 4.0
DAMPING_1_S, SECONDS, MASS_SCALING = 300.0, 0.02, 256.0
RULE = 0.005
RIGHT = 0.005
"""Farthest node off its place at rest, in elements."""


def _spot(coefficient: float, speed: float) -> Spot:
    scene = ply_scene(
        fabric_of(Options()), (SIDE_MM, SIDE_MM), ELEMENT_MM, formulation=SHELL_MEMBRANE, hourglass=coefficient,
        mass_scaling=MASS_SCALING,
    )  # fmt: skip
    air = np.full(2, scene.path.atmosphere)
    path = LoadPath(np.array([0.0, SECONDS]), air, air, np.zeros(2), np.zeros(1, bool), np.array([DAMPING_1_S]),
                    ("rest",), float(air[0]))  # fmt: skip
    x = positions(scene)
    scene = replace(scene, path=path)
    erect_directors(scene, np.zeros(x.shape[1:], bool))
    i, j = np.indices(x.shape[1:])
    velocities(scene)[0] = speed * (-1.0) ** (i + j)
    start = x.copy()
    trial = run_guarded(scene)
    away = float(np.abs(positions(scene) - start).max()) / ELEMENT_MM
    away = away if np.isfinite(away) else np.inf
    guard = trial.guard if not trial.finished else ""  # of the audit its strain alone: nothing loads the ply
    strained = [check["name"] for check in trial.checks if "fibre" in check["name"] and not check["ok"]]
    verdict, guard = judge(away < RIGHT, trial.kind, guard or "; ".join(strained))
    return Spot(coefficient, speed, coefficient >= RULE, verdict, away, guard)


def chart(quick: bool) -> Map:
    """Coefficients and speeds."""
    coefficients, speeds = (QUICK_COEFFICIENTS, QUICK_SPEEDS) if quick else (COEFFICIENTS, SPEEDS)
    spots = tuple(_spot(coefficient, speed) for coefficient, speed in grid(coefficients, speeds))
    ends = np.array([10.0, 800.0])
    lines = (RuleLine("solver.hourglass = 0.005", np.full(2, RULE), ends),
             RuleLine("0.05: the default", np.full(2, 0.05), ends))  # fmt: skip
    return Map(
        "solver.hourglass", "speed of the pattern [mm/s]", "farthest node off its place [elements]", spots, lines,
        symlog_x=1e-4,
    )  # fmt: skip


LIMIT = Limit(
    "hourglass", "Hourglass coefficient of a shell-membrane ply",
    "0.005 at least (0.05 is the default); fibres lie along the grid, so a larger one does no harm", chart,
)  # fmt: skip
