"""SHEET records of a case and the tables of its shear laws."""

from __future__ import annotations

import numpy as np

from ddf.build.stack import Stack
from ddf.build.step import stiffest
from ddf.case import Case
from ddf.dynamics import timestep
from ddf.materials import ogden, shear_law
from ddf.model import DIAPHRAGM, PLY, PRESSURE_BOTTOM, PRESSURE_TOP, SHEET, SHELL_PLY

LOWEST = 0.75
"""Of the distance at which a ply and the diaphragm touch, what is left at most where the ply is borne."""

SQUEEZED = 0.5
"""Of the distance at which layers touch, what is left where the tool bears the last of them. Deeper ones cross as
meshes see them; rubber under 10 MPa may well give more."""


def _bed(thickness: list[float]) -> float:
    """Distance [mm] from the tool at which it bears the last of some sheets, diaphragm first (`contact.bed`).

    0, never, for plies so high in the stack that they might lie on the diaphragm itself at this distance, beside
    smaller ones.
    """
    layers = sum(0.5 * (a + b) for a, b in zip(thickness[:-1], thickness[1:], strict=True))
    share = SQUEEZED * layers / (0.5 * (thickness[0] + thickness[-1]))
    return 0.5 * thickness[0] + SQUEEZED * layers if share <= LOWEST + 1e-9 else 0.0


def sheet_records(case: Case, stack: Stack, terms):
    """SHEET records, the stacked shear and tangent tables and the largest shear tangent of each ply [N/mm]."""
    count = len(stack.plies) + 2
    sheets = np.zeros(count, SHEET)
    tables, slopes, tangents = [], [], []
    node = shell = 0
    d = case.diaphragms
    for k in range(count):
        s = sheets[k]
        s["node"], s["thickness"] = node, stack.thickness[k]
        s["squeeze"] = stack.thickness[k] if case.solver.in_plane_pressure else 0.0
        s["hourglass"] = 4.0 * ogden.initial_shear_modulus(terms) * d.thickness_mm
        if 0 < k < count - 1:
            ply, material = stack.plies[k - 1], stack.materials[k - 1]
            s["kind"], s["shear"] = PLY, k - 1
            s["rows"], s["cols"] = ply.x.shape[1:]
            s["a1"], s["a2"] = ply.spacing
            s["eh1"], s["eh2"] = material.membrane_modulus_N_mm
            s["bend1"], s["bend2"] = material.bending_rigidity_Nmm
            s["bend_in_plane"] = material.in_plane_rigidity
            s["fold_radius"] = 0.5 * (d.thickness_mm + material.thickness_mm)
            s["bed"] = 0.0 if case.tool is None else _bed(stack.thickness[: k + 1])
            s["bed_friction"] = min(case.friction.diaphragm_tool, case.friction.ply_diaphragm)
            table = material.shear_table
            angle, force = shear_law.shear_samples(
                material.shear_law, material.thickness_mm, material.shear_modulus_floor_MPa,
                material.shear_modulus_polynomial_MPa,
                None if table is None else (table.angle_deg, table.normalised_shear_force_N_mm),
            )  # fmt: skip
            tables.append(shear_law.shear_table(angle, force))
            slopes.append(shear_law.tangent_table(angle, force))
            tangents.append(shear_law.largest_tangent(angle, force))
            if case.plies[k - 1].formulation == "shell-membrane":
                s["kind"], s["shell"], s["bed"] = SHELL_PLY, shell, 0.0
                s["transverse"], s["glass"] = material.transverse_shear_N_mm, case.solver.hourglass
                s["gyration"] = timestep.shell_gyration(
                    stiffest(material), max(material.bending_rigidity_Nmm), material.transverse_shear_N_mm,
                    material.thickness_mm, ply.spacing,
                )  # fmt: skip
                shell += int(s["rows"] * s["cols"])
        else:
            s["kind"], s["rows"], s["cols"] = DIAPHRAGM, *stack.diaphragm.x.shape[1:]
            s["face"] = PRESSURE_BOTTOM if k == 0 else PRESSURE_TOP
            s["thickness"] = d.thickness_mm
            s["rigidity"] = ogden.bending_rigidity(terms, d.thickness_mm) if d.bending else 0.0
            s["fold_radius"] = d.thickness_mm + sum(m.thickness_mm for m in stack.materials)
        node += int(s["rows"] * s["cols"])
    return sheets, np.array(tables), np.array(slopes), tangents
