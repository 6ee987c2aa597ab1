"""The time step over the stable one, at several mass scalings, on a flat stack that is clamped and comes to rest.

A flat stack, rough by a hundredth of a millimetre at first, is pressed flat: the ply's middle surface goes to z = 0.
"""

from __future__ import annotations

import numpy as np

from ddf.build import build_scene
from ddf.model import sheet_vectors
from ddf.study.stability.map import Limit, Map, RuleLine, Spot, grid, judge
from ddf.study.stability.scenes import FLAT, make_case, rough
from ddf.study.stability.trial import run_case_guarded

RATIOS, QUICK_RATIOS = (0.5, 0.85, 1.1, 1.5, 2.5), (0.85, 2.5)
MASSES, QUICK_MASSES = (6.0, 24.0, 96.0), (24.0,)
FLAT_MM = 0.1


def _spot(ratio: float, mass: float) -> Spot:
    plain = build_scene(make_case(FLAT, solver={"mass_scaling": mass}))
    stable = plain.step_limit / plain.case.solver.step_safety
    case = make_case(FLAT, solver={"mass_scaling": mass, "step_s": ratio * stable})
    scene = rough(build_scene(case))
    trial = run_case_guarded(case, scene)
    away = float(np.abs(sheet_vectors(scene.model, scene.state.x, 1)[2]).max())
    away = away if np.isfinite(away) else np.inf
    verdict, guard = judge(away < FLAT_MM, trial.kind, trial.guard)
    return Spot(ratio, mass, ratio <= 0.85, verdict, away, guard)


def chart(quick: bool) -> Map:
    """Step ratios and mass scalings."""
    ratios, masses = (QUICK_RATIOS, QUICK_MASSES) if quick else (RATIOS, MASSES)
    ends = np.array([4.0, 140.0])
    lines = (RuleLine("solver.step_safety = 0.85", np.full(2, 0.85), ends),
             RuleLine("bound of the stable step", np.ones(2), ends))  # fmt: skip
    spots = tuple(_spot(ratio, mass) for ratio, mass in grid(ratios, masses))
    return Map("step over the stable one", "mass scaling of the plies", "ply out of its plane [mm]", spots, lines)


LIMIT = Limit(
    "step", "Time step of a clamped flat stack",
    "the step is 0.85 of the bound (dynamics/timestep.py); a step_s beyond the bound is refused", chart,
)  # fmt: skip
