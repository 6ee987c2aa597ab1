"""Sense of the element sizes: whether they can show the fillets and the folds of this stack.

The tightest fold that a pressure p holds against a rigidity D per width has a radius of the order of

    r = (D/p)^(1/3)   [mm]

by balance of moments D/r and p r^2; D is that of all plies and both diaphragms, which fold together.
"""

from __future__ import annotations

import math

import numpy as np

from ddf.case import Case, hyperelastic_material, woven_material
from ddf.loads.path import KPA, LoadPath
from ddf.materials import ogden
from ddf.plausible.findings import Findings

ELEMENTS_A_FOLD = 4.0  # elements over the length 2 pi r of a fold: fewer cannot bend round it
ELEMENTS_A_FILLET = 0.5  # fillet radius over the diaphragm's element
DEEP_MM, PRESSED_KPA = (
    40.0,
    20.0,
)  # depth of the platform from which on, and vacuum at which, rubber bulges to the walls
ELEMENTS_A_WALL = 5.0  # elements over that depth: with 2 to 3 of them the sheets flew apart in the frame's corners


def fold_radius_mm(case: Case, path: LoadPath) -> float:
    """Radius [mm] of the tightest fold of the whole stack at the largest pressure on it."""
    terms = hyperelastic_material(case, case.diaphragms.material).abaqus_terms
    skin = ogden.bending_rigidity(terms, case.diaphragms.thickness_mm) if case.diaphragms.bending else 0.0
    rigidity = 2.0 * skin + sum(min(woven_material(case, ply.material).bending_rigidity_Nmm) for ply in case.plies)
    pressure = KPA * max(np.max(path.atmosphere - path.cavity), np.max(path.box - path.cavity))
    return math.inf if pressure <= 0.0 else (rigidity / pressure) ** (1.0 / 3.0)


def wall_depth_mm(case: Case, path: LoadPath) -> float:
    """Depth [mm] of the platform below the frame at which vacuum draws the sheets to the box's walls; 0: not deep."""
    if case.tool is None:
        return 0.0
    height = case.tool.height_mm or case.tool.radius_mm or float(path.lift.max())
    pressed = path.atmosphere - path.box > PRESSED_KPA
    depth = float(np.max(np.where(pressed, height - path.lift, 0.0)))
    return depth if depth > DEEP_MM else 0.0


def examine_mesh(case: Case, path: LoadPath, found: Findings) -> None:
    """Look at the sizes of the elements against fold and fillet."""
    radius = fold_radius_mm(case, path)
    largest = 2.0 * math.pi * radius / ELEMENTS_A_FOLD
    for place, ply in enumerate(case.plies):
        if ply.element_mm > largest:
            problem = f"{ply.element_mm:g} cannot resolve the tightest wrinkles, folds of a radius of {radius:.2g} mm"
            found.warn(
                ("plies", place, "element_mm"), problem, f"<= {largest:.2g} for {ELEMENTS_A_FOLD:g} elements a fold"
            )
    size = case.diaphragms.element_mm
    coarsest = max(ply.element_mm for ply in case.plies)
    if size > 2.0 * coarsest:
        problem = f"{size:g} is more than twice the plies' {coarsest:g}: wrinkles of the plies are smeared in contact"
        found.warn(("diaphragms", "element_mm"), problem, f"<= {2.0 * coarsest:g}")
    depth = wall_depth_mm(case, path)
    if depth > 0.0 and case.diaphragms.element_max_mm > depth / ELEMENTS_A_WALL:
        problem = (
            f"{case.diaphragms.element_max_mm:g} at the frame is too large for a box evacuated while its platform is "
            f"{depth:g} mm below: sheets drawn to its walls cannot bend into the corners, and may fly apart there"
        )
        found.warn(("diaphragms", "element_max_mm"), problem, f"<= {depth / ELEMENTS_A_WALL:.3g}")
    tool = case.tool
    if tool is not None and tool.shape not in ("file", "hemisphere") and tool.fillet_mm < ELEMENTS_A_FILLET * size:
        problem = f"{tool.fillet_mm:g} is far below the diaphragm's element of {size:g}: edges press between its nodes"
        found.warn(
            ("tool", "fillet_mm"), problem, f">= {ELEMENTS_A_FILLET * size:g}, or a smaller diaphragms.element_mm"
        )
