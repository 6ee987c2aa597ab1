"""Masses of all sheets and the stable step that goes with them."""

from __future__ import annotations

import math

import numpy as np

from ddf.build.stack import Stack
from ddf.case import Case
from ddf.case.schema import WovenMaterial
from ddf.dynamics import timestep
from ddf.materials import ogden
from ddf.mesh.ply import PlyMesh
from ddf.model import SHELL_PLY

OWN_STIFFNESS, OWN_DAMPING = 1 / 6, 0.25
"""Stiffness and damping ratio of a diaphragm's contact with itself over those of layers. It comes on top of the layers
that press on the other face; more would shorten the step of every run, and 0.5 N/mm3 give 0.2 mm under vacuum. A face
of a ply that touches itself touches nothing else: there it is the layers' stiffness."""
TONNE_PER_GSM_MM2 = 1e-12
TONNE_PER_KG_M3 = 1e-12


def areal_masses(case: Case, stack: Stack, density: float, tangents: list[float]) -> tuple[list[float], list[float]]:
    """Mass scaling of each ply and areal mass of each sheet as clamped [tonne/mm2]."""
    solver = case.solver
    scales = []
    for number, (ply, material, shear) in enumerate(zip(stack.plies, stack.materials, tangents, strict=True)):
        areal = material.areal_density_gsm * TONNE_PER_GSM_MM2
        if solver.target_step_s is not None:
            omega2 = ply_omega2(case, number, ply, material, shear, areal)
            step = solver.step_safety * timestep.damped_limit(math.sqrt(omega2), solver.contact_damping)
            scales.append(max(1.0, (solver.target_step_s / step) ** 2))
        else:
            scales.append(solver.mass_scaling if solver.mass_scaling is not None else 1.0)
    skin = solver.diaphragm_mass_scaling * density * case.diaphragms.thickness_mm / case.diaphragms.pre_stretch**2
    plies = [m.areal_density_gsm * TONNE_PER_GSM_MM2 * s for m, s in zip(stack.materials, scales, strict=True)]
    return scales, [skin, *plies, skin]


def ply_omega2(case: Case, number: int, ply: PlyMesh, material: WovenMaterial, shear: float, mass: float) -> float:
    """Bound of omega^2 of ply `number` of the case, of whichever formulation."""
    contact = 2.0 * case.solver.contact_stiffness_N_mm3
    if case.plies[number].formulation == "shell-membrane":
        stiff, transverse = stiffest(material), material.transverse_shear_N_mm
        return timestep.shell_membrane_omega2(stiff, shear, transverse, ply.spacing, contact, mass)
    return timestep.ply_omega2(shear, material.bending_rigidity_Nmm, ply.spacing, contact, mass)


def stiffest(material: WovenMaterial) -> float:
    """Tensile stiffness of the stiffer family, membrane and shell together [N/mm]."""
    flexural = 12.0 / material.thickness_mm**2
    both = zip(material.membrane_modulus_N_mm, material.bending_rigidity_Nmm, strict=True)
    return max(eh + flexural * d for eh, d in both)


def damp_fibres(case: Case, sheets: np.ndarray, masses: list[float], tangents: list[float]) -> None:
    """Set the damping time 2 z/omega of shell plies, z of critical at the highest frequency of the ply by itself."""
    for k, s in enumerate(sheets):
        if s["kind"] == SHELL_PLY:
            spacing = (float(s["a1"]), float(s["a2"]))
            stiff = max(float(s[f"eh{f}"]) + 12.0 * float(s[f"bend{f}"]) / float(s["thickness"]) ** 2 for f in (1, 2))
            omega2 = timestep.shell_membrane_omega2(stiff, 0.0, 0.0, spacing, 0.0, masses[k])
            s["viscous"] = 2.0 * case.solver.fibre_damping / math.sqrt(omega2)


def step_limit(case: Case, stack: Stack, terms, masses: list[float], tangents: list[float]) -> float:
    """Stable step [s], the least of all sheets, safety included."""
    solver, d = case.solver, case.diaphragms
    stiff = solver.contact_stiffness_N_mm3
    limits = []
    for k, (ply, material) in enumerate(zip(stack.plies, stack.materials, strict=True)):
        omega2 = ply_omega2(case, k, ply, material, tangents[k], masses[k + 1])
        damping = 2.0 * sum(pair_damping(case, masses, k + 1, other) for other in (k, k + 2))
        if case.plies[k].formulation == "shell-membrane":
            damping += 2.0 * case.solver.fibre_damping * math.sqrt(omega2) * masses[k + 1]
        limits.append((math.sqrt(omega2), damping / masses[k + 1]))
    mu, bending = ogden.initial_shear_modulus(terms), ogden.bending_rigidity(terms, d.thickness_mm)
    omega2 = timestep.diaphragm_omega2(
        mu, d.thickness_mm, bending if d.bending else 0.0, masses[0], d.element_mm, stiff
    )
    damping = 2.0 * max(pair_damping(case, masses, 0, other) for other in range(1, len(masses)))
    limits.append((math.sqrt(omega2), damping / masses[0]))
    if solver.self_contact:  # normal to flanks that touch: bending and contacts, but nothing of the membrane
        own, own_damping = own_contact(case, masses[0])
        omega2 = timestep.diaphragm_omega2(
            0.0, d.thickness_mm, bending if d.bending else 0.0, masses[0], d.element_mm, stiff + own
        )
        limits.append((math.sqrt(omega2), (damping + 2.0 * own_damping) / masses[0]))
    return solver.step_safety * min(timestep.damped_limit(w, c / (2.0 * w)) for w, c in limits)


def own_contact(case: Case, mass: float) -> tuple[float, float]:
    """Stiffness [N/mm3] and damping [N s/mm3] of a diaphragm's contact with itself, of areal mass `mass`."""
    s = case.solver
    stiffness = OWN_STIFFNESS * s.contact_stiffness_N_mm3
    return stiffness, timestep.contact_damping(OWN_DAMPING * s.contact_damping, stiffness, mass, mass)


def pair_damping(case: Case, masses: list[float], a: int, b: int) -> float:
    """Damping of the contact between two sheets [N s/mm3]."""
    s = case.solver
    return timestep.contact_damping(s.contact_damping, s.contact_stiffness_N_mm3, masses[a], masses[b])
