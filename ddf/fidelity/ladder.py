"""The ladder: rungs from a net that takes milliseconds to elements that take minutes, each with its measured error.

Measured on the paper's 0/90 case, a ply of 350 mm over a tool of 82 mm lifted at 1.17 m/s on average
(docs/speed-accuracy.md): mean distance of the formed outline from that of the finest rung. Rungs that another one
beats in both time and error are left out (6 mm elements are no nearer than 4 mm in half the durations, and 3 and 2 mm
at the shipped ones no nearer than 4 mm: what is left of inertia decides). Larger masses are shorter durations by
another name. For other plies elements and errors go with the ply's shorter side, the same number of elements across
it: what is expected there is an extrapolation.

The same on every rung, because measured there: plies are lattices (shell-membrane plies cost 41 times as much and
give the same part), diaphragms bend (without it 23 wrinkles more), sheets touch themselves where they fold (a few per
cent of the time). Scenes that are their own mirror image are computed by half, in half of the time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddf.build import load_path
from ddf.case import Case
from ddf.case.changes import Changes, changed, stretched

MEASURED_SIDE_MM = 350.0
MEASURED_LIFT_MM_S = 82.0 / 0.07


@dataclass(frozen=True)
class Rung:
    """Elements [mm] and durations (factor) on the scene of the measurement, and the error found there [mm]."""

    name: str
    ply_mm: float | None  # None: the kinematic net
    diaphragm_mm: float
    durations: float
    error_mm: float


LADDER = (
    Rung("net", None, 0.0, 1.0, 3.06),
    Rung("quick", 4.0, 5.0, 0.5, 0.38),
    Rung("coarse", 4.0, 5.0, 1.0, 0.32),
    Rung("coarse-slow", 4.0, 5.0, 2.0, 0.088),
    Rung("medium-slow", 3.0, 3.75, 2.0, 0.06),
    Rung("fine-slow", 2.0, 2.5, 2.0, 0.0),
)
"""From the cheapest to the finest, which is what the others are measured against."""


def shorter_side(case: Case) -> float:
    """Shorter side [mm] of the smallest ply's bounding box, along its fibres or across."""
    sides = []
    for ply in case.plies:
        turn = np.radians(ply.orientation_deg)
        axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        extents = [np.ptp(np.asarray(ply.outline_mm()) @ turned, axis=0).min() for turned in (np.eye(2), axes)]
        sides.append(float(min(extents)))
    return min(sides)


def mean_lift_speed(case: Case) -> float:
    """Mean speed [mm/s] of the fastest stage of the lift; 0 without one."""
    path = load_path(case)
    return float(np.max(np.abs(np.diff(path.lift)) / np.diff(path.time)))


def at(case: Case, rung: Rung) -> Case:
    """The case on a rung, all else as it is."""
    plain = case.model_copy(update={"fidelity": "as-given", "target": None})
    if rung.ply_mm is None:
        return changed(plain, {"model": "kinematic"})
    scale = shorter_side(case) / MEASURED_SIDE_MM
    element, skin = round(scale * rung.ply_mm, 2), round(scale * rung.diaphragm_mm, 2)
    changes: Changes = {
        "diaphragms.element_mm": skin,
        "diaphragms.element_max_mm": max(case.diaphragms.element_max_mm, skin),
        "diaphragms.bending": True,
        "solver.self_contact": True,
        "solver.symmetry": "auto",
    }
    for k in range(len(case.plies)):
        changes |= {f"plies.{k}.element_mm": element, f"plies.{k}.formulation": "lattice"}
    factor = round(rung.durations * max(1.0, mean_lift_speed(case) / MEASURED_LIFT_MM_S), 3)
    return changed(plain, changes | (stretched(case, factor) if factor != 1.0 else {}))
