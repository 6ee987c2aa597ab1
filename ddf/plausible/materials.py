"""Sense of the materials: values that point to a wrong unit, and laws that lose their stiffness."""

from __future__ import annotations

import numpy as np

from ddf.case import Case, WovenMaterial, hyperelastic_material, woven_material
from ddf.materials import ogden
from ddf.materials.shear_law import shear_samples
from ddf.plausible.findings import Findings

FABRIC_KG_M3 = (100.0, 4000.0)
LEAST_BENDING = 1e-5  # of a solid plate of the fabric's modulus: separate filaments of 5 um in 0.5 mm still have 1e-4
SHORTEST_TABLE_DEG = 10.0  # a measured shear law goes farther; 90 deg are 1.6 rad
STRETCHES = np.linspace(1.0, 2.5, 31)  # the range of a forming's diaphragm
SOFTEST_MPA, STIFFEST_MPA = 0.01, 100.0  # initial shear moduli of rubbers


SHEAR_UP_TO_DEG = 60.0  # shear angles of forming


def falling_range(weave: WovenMaterial) -> tuple[float, float] | None:
    """Shear angles [deg] between which N_s of the law that will run falls; None where it rises everywhere."""
    table = weave.shear_table
    angle, force = shear_samples(
        weave.shear_law, weave.thickness_mm, weave.shear_modulus_floor_MPa, weave.shear_modulus_polynomial_MPa,
        None if table is None else (table.angle_deg, table.normalised_shear_force_N_mm),
    )  # fmt: skip
    degrees = np.rad2deg(angle)
    down = np.flatnonzero((np.diff(force) < 0.0) & (degrees[1:] < SHEAR_UP_TO_DEG))
    return (float(degrees[down[0]]), float(degrees[down[-1] + 1])) if down.size else None


def examine_materials(case: Case, found: Findings) -> None:
    """Look at every material that is used."""
    for name in dict.fromkeys(ply.material for ply in case.plies):
        weave = woven_material(case, name)
        low, high = FABRIC_KG_M3
        density = weave.areal_density_gsm / weave.thickness_mm  # g/m2 over mm is kg/m3
        if not low <= density <= high:
            problem = f"a density of {density:.3g} kg/m3 is unusual for a fabric"
            found.warn(("materials", name, "areal_density_gsm"), problem, f"{low:g} to {high:g} kg/m3; check the units")
        solid = max(weave.membrane_modulus_N_mm) * weave.thickness_mm**2 / 12.0
        if max(weave.bending_rigidity_Nmm) > solid:
            problem = f"{max(weave.bending_rigidity_Nmm):g} is more than that of a solid plate of this modulus"
            found.warn(("materials", name, "bending_rigidity_Nmm"), problem, f"<= {solid:.3g}; check the units")
        if 0.0 < min(weave.bending_rigidity_Nmm) < LEAST_BENDING * solid:
            problem = (
                f"{min(weave.bending_rigidity_Nmm):g} is next to nothing: is it in N mm (per mm of width), not N m?"
            )
            found.warn(("materials", name, "bending_rigidity_Nmm"), problem, f">= {LEAST_BENDING * solid:.3g}")
        if weave.shear_table is not None and weave.shear_table.angle_deg[-1] < SHORTEST_TABLE_DEG:
            end = weave.shear_table.angle_deg[-1]
            problem = f"the table ends at {end:g} deg, and the law goes on straight; are its angles in radians?"
            found.warn(("materials", name, "shear_table", "angle_deg"), problem, "degrees, up to 40 or more")
        span = falling_range(weave)
        if span is not None:
            width = "" if weave.in_plane_rigidity > 0.0 else " one element wide"
            problem = (
                f"the shear force falls between {span[0]:.3g} and {span[1]:.3g} deg of shear, where shear gathers in "
                f"bands{width}"
            )
            found.warn(("materials", name, "shear_law"), problem, "'monotone', the closest law that is stable")
    for number, ply in enumerate(case.plies):
        if ply.formulation == "shell-membrane" and woven_material(case, ply.material).in_plane_bending_Nmm:
            problem = "shell-membrane elements have no in-plane bending, which the material asks for"
            found.fault(("plies", number, "formulation"), problem, "lattice, or leave in_plane_bending_Nmm out")
    name = case.diaphragms.material
    terms = hyperelastic_material(case, name).abaqus_terms
    modulus = ogden.initial_shear_modulus(terms)
    if not SOFTEST_MPA <= modulus <= STIFFEST_MPA:
        problem = f"an initial shear modulus of {modulus:.3g} MPa is not that of a rubber"
        found.warn(("materials", name, "ogden"), problem, f"{SOFTEST_MPA:g} to {STIFFEST_MPA:g} MPa; check the units")
    for mode in ("uniaxial", "planar"):
        falls = np.flatnonzero(np.diff(ogden.biot_stress(terms, STRETCHES, mode)) <= 0.0)
        if falls.size:
            stretch = STRETCHES[falls[0]]
            problem = f"the {mode} force falls beyond a stretch of {stretch:.3g}: the diaphragm can tear locally"
            found.warn(("materials", name, "ogden"), problem, "terms whose force rises up to a stretch of 2.5")
            break
