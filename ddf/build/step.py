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

OWN_STIFFNESS, OWN_DAMPING = 0.5, 0.25
"""Stiffness [N/mm3] of a diaphragm's contact with itself, half of the layers' at most, and its damping ratio over
theirs. It comes on top of the layers that press on the other face; more would shorten the step of every run, and it
gives 0.2 mm under vacuum. A face of a ply that touches itself touches nothing else: there it is the layers' own."""
MOST_SCALING = 9.6
"""Most times its own mass, over the diaphragms' factor, that a ply carries for the sake of the step (24 at 2.5)."""
SPARE = 2.2
"""Mass of plies over what the diaphragms' step asks: layers pressed deep in one another are stiffer than its bound."""
ROUNDS = 6
TONNE_PER_GSM_MM2 = 1e-12
TONNE_PER_KG_M3 = 1e-12


def areal_masses(
    case: Case, stack: Stack, terms, density: float, tangents: list[float]
) -> tuple[list[float], list[float]]:
    """Mass scaling of each ply and areal mass of each sheet as clamped [tonne/mm2].

    Plies without a factor or a step of their own are as heavy as the diaphragms' step asks, `SPARE` included, up to
    `MOST_SCALING`.
    """
    solver = case.solver
    areal = [m.areal_density_gsm * TONNE_PER_GSM_MM2 for m in stack.materials]
    skin = solver.diaphragm_mass_scaling * density * case.diaphragms.thickness_mm / case.diaphragms.pre_stretch**2
    scales = [1.0 if solver.mass_scaling is None else solver.mass_scaling for _ in areal]

    def masses() -> list[float]:
        return [skin, *(m * s for m, s in zip(areal, scales, strict=True)), skin]

    if solver.target_step_s is not None:
        for k in range(len(areal)):
            omega = math.sqrt(ply_omega2(case, k, stack.plies[k], stack.materials[k], tangents[k], areal[k]))
            step = solver.step_safety * timestep.damped_limit(omega, solver.contact_damping)
            scales[k] = max(1.0, (solver.target_step_s / step) ** 2)
    elif solver.mass_scaling is None:
        most = MOST_SCALING * solver.diaphragm_mass_scaling
        for _ in range(ROUNDS):  # masses of both sheets are in the damping of their contact
            *plies, diaphragm = step_limits(case, stack, terms, masses(), tangents)
            for k, step in enumerate(plies):
                scales[k] = max(1.0, min(scales[k] * SPARE * (diaphragm / step) ** 2, most))
    return scales, masses()


def ply_omega2(case: Case, number: int, ply: PlyMesh, material: WovenMaterial, shear: float, mass: float) -> float:
    """Bound of omega^2 of ply `number` of the case, of whichever formulation."""
    contact = 2.0 * case.solver.contact_stiffness_N_mm3
    if case.plies[number].formulation == "shell-membrane":
        stiff, transverse = stiffest(material), material.transverse_shear_N_mm
        return timestep.shell_membrane_omega2(stiff, shear, transverse, ply.spacing, contact, mass)
    first, second = (max(d, material.in_plane_rigidity) for d in material.bending_rigidity_Nmm)
    return timestep.ply_omega2(shear, (first, second), ply.spacing, contact, mass)


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
    return min(step_limits(case, stack, terms, masses, tangents))


def step_limits(case: Case, stack: Stack, terms, masses: list[float], tangents: list[float]) -> list[float]:
    """Stable steps [s] of the plies, then of the diaphragms, safety included."""
    solver, d = case.solver, case.diaphragms
    stiff = solver.contact_stiffness_N_mm3
    limits = []
    for k, (ply, material) in enumerate(zip(stack.plies, stack.materials, strict=True)):
        omega2 = ply_omega2(case, k, ply, material, tangents[k], masses[k + 1])
        damping = 2.0 * sum(pair_damping(case, masses, k + 1, other) for other in (k, k + 2))
        if case.plies[k].formulation == "shell-membrane":
            damping += 2.0 * case.solver.fibre_damping * math.sqrt(omega2) * masses[k + 1]
        limits.append(_damped(omega2, damping / masses[k + 1]))
    mu, bending = ogden.initial_shear_modulus(terms), ogden.bending_rigidity(terms, d.thickness_mm)
    bending = bending if d.bending else 0.0
    omega2 = timestep.diaphragm_omega2(mu, d.thickness_mm, bending, masses[0], d.element_mm, stiff)
    damping = 2.0 * max(pair_damping(case, masses, 0, other) for other in range(1, len(masses)))
    skin = _damped(omega2, damping / masses[0])
    if solver.self_contact:  # normal to flanks that touch: bending and contacts, but nothing of the membrane
        own, own_damping = own_contact(case, masses[0])
        omega2 = timestep.diaphragm_omega2(0.0, d.thickness_mm, bending, masses[0], d.element_mm, stiff + own)
        skin = min(skin, _damped(omega2, (damping + 2.0 * own_damping) / masses[0]))
    return [solver.step_safety * limit for limit in [*limits, skin]]


def _damped(omega2: float, rate: float) -> float:
    """Limit of `timestep.damped_limit` for a bound of omega^2 and a damping over mass [1/s]."""
    omega = math.sqrt(omega2)
    return timestep.damped_limit(omega, rate / (2.0 * omega))


def own_contact(case: Case, mass: float) -> tuple[float, float]:
    """Stiffness [N/mm3] and damping [N s/mm3] of a diaphragm's contact with itself, of areal mass `mass`."""
    s = case.solver
    stiffness = min(OWN_STIFFNESS, 0.5 * s.contact_stiffness_N_mm3)
    return stiffness, timestep.contact_damping(OWN_DAMPING * s.contact_damping, stiffness, mass, mass)


def pair_damping(case: Case, masses: list[float], a: int, b: int) -> float:
    """Damping of the contact between two sheets [N s/mm3]."""
    s = case.solver
    return timestep.contact_damping(s.contact_damping, s.contact_stiffness_N_mm3, masses[a], masses[b])
