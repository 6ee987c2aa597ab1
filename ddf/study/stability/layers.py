"""Stiffness and damping of the contact between layers: a stack under vacuum.

The penalty K gives by p/K under a pressure p. A flat stack under p has its middle surfaces  offset - p/K  apart (three
times stiffer beyond a fifth of the offset), and lies still.
"""

from __future__ import annotations

import numpy as np

from ddf.build import build_scene
from ddf.contact.layers import HARD, HARDENING
from ddf.model import sheet_vectors
from ddf.study.stability.map import FloatArray, Limit, Map, RuleLine, Spot, grid, judge
from ddf.study.stability.scenes import FLAT, make_case, rough
from ddf.study.stability.trial import run_guarded

STIFFNESSES, QUICK_STIFFNESSES = (0.03, 0.1, 0.2, 0.5, 3.0, 20.0), (0.03, 3.0)
DAMPINGS, QUICK_DAMPINGS = (0.0, 0.2, 1.0), (0.2,)
PRESSURE = 0.101325  # MPa
RULE = 0.2  # of the offset: p/K up to where the penalty hardens
RIGHT = 0.5
"""Part of the offset up to which sheets may lie in one another."""


def give(stiffness: float, offset: float) -> float:
    """Depth [mm] at which the penalty bears the atmosphere."""
    hard = HARD * offset
    plain = PRESSURE / stiffness
    return plain if plain <= hard else hard + (plain - hard) / HARDENING


def _spot(stiffness: float, damping: float) -> Spot:
    solver = {"contact_stiffness_N_mm3": stiffness, "contact_damping": damping}
    scene = rough(build_scene(make_case(FLAT, solver=solver)))
    trial = run_guarded(scene)
    bottom, ply, top = (_middle(sheet_vectors(scene.model, scene.state.x, k)) for k in range(3))
    offset = float(scene.model.pairs["offset"][0])
    depth = max(offset - (ply - bottom), offset - (top - ply))
    depth = depth if np.isfinite(depth) else np.inf
    safe = PRESSURE / stiffness <= RULE * offset and damping > 0.0
    verdict, guard = judge(depth <= RIGHT * offset, trial.kind, trial.guard)
    return Spot(stiffness, damping, safe, verdict, depth, guard)


def _middle(x: FloatArray) -> float:
    return float(x[2, x.shape[1] // 2, x.shape[2] // 2])


def chart(quick: bool) -> Map:
    """Stiffnesses and damping ratios."""
    stiffnesses, dampings = (QUICK_STIFFNESSES, QUICK_DAMPINGS) if quick else (STIFFNESSES, DAMPINGS)
    spots = tuple(_spot(k, z) for k, z in grid(stiffnesses, dampings))
    ends, softest = np.array([-0.1, 1.2]), PRESSURE / RULE
    lines = (RuleLine("p/K = a fifth of the distance", np.full(2, softest), ends),)
    return Map(
        "solver.contact_stiffness_N_mm3", "solver.contact_damping", "depth of the layers in one another [mm]", spots,
        lines, log_y=False,
    )  # fmt: skip


LIMIT = Limit(
    "layer-contact", "Stiffness and damping of contact between layers",
    "p/K stays below a fifth of the distance at which sheets touch (K >= 0.5 N/mm3 for 1 mm), some damping", chart,
)  # fmt: skip
