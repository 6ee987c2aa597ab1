"""Element size against the wrinkles' wavelength: a strip on a foundation, which wrinkles at a length of its own.

A strip of bending rigidity B on a foundation K wrinkles at  lambda = 2 pi (B/K)^(1/4)  (Hetenyi). Its lattice of
element a has the curvature  (4/a^2) sin^2(q a/2)  instead of q^2, so that

    sin(pi a / lambda') = pi a / lambda

The wrinkles lambda' come shorter than they should, and lock to the grid (lambda' = 2 a) from a = lambda/pi on. The
guards are the audit's: elements across the narrowest wrinkle (between half heights, about half a wave), and nodes in a
zigzag, which the metrics do not see as wrinkles. Both are taken as in a run, on a ply with waves of the length found.
"""

from __future__ import annotations

import math

import numpy as np

from ddf.metrics import find_wrinkles
from ddf.monitors.audit import across_check, zigzag_check
from ddf.output.snapshot import ply_surface
from ddf.study.stability.map import WARNED, Limit, Map, RuleLine, Spot, grid, judge
from ddf.verify.buckling import critical_modes, lowest_of
from ddf.verify.buckling_foundation import PLY, bedded
from ddf.verify.problem import Options
from ddf.verify.scenes import fabric_of, ply_scene, positions

COUNTS, QUICK_COUNTS = (2.2, 2.8, 3.5, 4.5, 6.0, 8.0, 12.0), (2.8, 4.5, 12.0)
PENALTIES, QUICK_PENALTIES = (5e-4, 5e-3), (5e-4,)  # N/mm3 on either face
WAVES = 6
WIDE_MM = 40.0
STEEP = 0.1  # amplitude of the waves that the metrics are shown, of their length
RIGHT = 0.05
"""Relative error of the wavelength up to which wrinkles are where they should be."""
ENOUGH = 12.0
"""Elements a wave by the rule: what the audit's 6 across a wrinkle come to; the wavelength is 1.3 % short."""


def _spot(count: float, penalty: float) -> Spot:
    fabric = fabric_of(Options())
    rigidity = fabric.bending_rigidity_Nmm[1]
    wave = 2.0 * math.pi * (rigidity / (2.0 * penalty)) ** 0.25
    element, length = wave / count, WAVES * wave
    modes = critical_modes(
        bedded(Options(), element, length, penalty), 2.0 * math.sqrt(2.0 * rigidity * penalty), 3, PLY
    )
    found = lowest_of(modes, length)[1]
    verdict, guard = judge(abs(found / wave - 1.0) <= RIGHT, WARNED, _audited(element, length, found))
    return Spot(count, wave, count >= ENOUGH, verdict, found / wave, guard)


def _audited(element: float, length: float, wave: float) -> str:
    """What the audit warns of in a ply with waves of that length [mm]."""
    scene = ply_scene(fabric_of(Options()), (WIDE_MM, length), element)
    x = positions(scene)
    x[2] = STEEP * wave * np.sin(2.0 * math.pi * (x[1] - x[1, 0, 0]) / wave + 0.5 * math.pi)
    found = find_wrinkles(ply_surface(scene, scene.state, 0), (0.0, 0.0), 0.4)
    checks = [zigzag_check(scene)] + ([across_check(found.smallest_elements_across)] if found.count else [])
    return "; ".join(f"{check['name']}: {check['value']:.2g}" for check in checks if not check["ok"])


def chart(quick: bool) -> Map:
    """Elements a wave and foundations."""
    counts, penalties = (QUICK_COUNTS, QUICK_PENALTIES) if quick else (COUNTS, PENALTIES)
    spots = tuple(_spot(count, penalty) for count, penalty in grid(counts, penalties))
    ends = np.array([8.0, 40.0])
    lines = (
        RuleLine(f"{ENOUGH:g} elements a wave: the rule", np.full(2, ENOUGH), ends),
        RuleLine("6: 5 % short", np.full(2, 6.0), ends),
        RuleLine("pi elements a wave: locked to the grid", np.full(2, math.pi), ends),
    )
    return Map("elements a wave", "wavelength [mm]", "wavelength found over the right one", spots, lines)


LIMIT = Limit(
    "wavelength", "Elements a wave of a wrinkling strip",
    "12 elements a wave (the audit: 6 between half heights); 5 % short at 6, locked to the grid below pi", chart,
)  # fmt: skip
