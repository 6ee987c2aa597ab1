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


def fold_radius_mm(case: Case, path: LoadPath) -> float:
    """Radius [mm] of the tightest fold of the whole stack at the largest pressure on it."""
    terms = hyperelastic_material(case, case.diaphragms.material).abaqus_terms
    skin = ogden.bending_rigidity(terms, case.diaphragms.thickness_mm) if case.diaphragms.bending else 0.0
    rigidity = 2.0 * skin + sum(min(woven_material(case, ply.material).bending_rigidity_Nmm) for ply in case.plies)
    pressure = KPA * max(np.max(path.atmosphere - path.cavity), np.max(path.box - path.cavity))
    return math.inf if pressure <= 0.0 else (rigidity / pressure) ** (1.0 / 3.0)


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
    tool = case.tool
    if tool is not None and tool.shape not in ("file", "hemisphere") and tool.fillet_mm < ELEMENTS_A_FILLET * size:
        problem = f"{tool.fillet_mm:g} is far below the diaphragm's element of {size:g}: edges press between its nodes"
        found.warn(
            ("tool", "fillet_mm"), problem, f">= {ELEMENTS_A_FILLET * size:g}, or a smaller diaphragms.element_mm"
        )
