"""Masses of all sheets and the stable step that goes with them."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

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
SHELL_SCALING = 24.0
"""Mass scaling of shell-membrane plies where none is given."""
TONNE_PER_GSM_MM2 = 1e-12
TONNE_PER_KG_M3 = 1e-12


def areal_masses(
    case: Case, stack: Stack, density: float, terms, tangents: list[float]
) -> tuple[list[float], list[float]]:
    """Mass scaling of each ply and areal mass of each sheet as clamped [tonne/mm2].

    Where neither a scaling nor a step is given, lattice plies get what their own stable step needs to be that of the
    diaphragms: less shortens the step, more only makes them slow. Shell-membrane plies, whose fibres are explicit and
    would need far more, get SHELL_SCALING.
    """
    solver = case.solver
    skin = solver.diaphragm_mass_scaling * density * case.diaphragms.thickness_mm / case.diaphragms.pre_stretch**2
    scales = []
    for number, (ply, material, shear) in enumerate(zip(stack.plies, stack.materials, tangents, strict=True)):
        areal = material.areal_density_gsm * TONNE_PER_GSM_MM2
        if solver.mass_scaling is not None:
            scale = solver.mass_scaling
        elif solver.target_step_s is not None:
            omega2 = ply_omega2(case, number, ply, material, shear, areal)
            step = solver.step_safety * timestep.damped_limit(math.sqrt(omega2), solver.contact_damping)
            scale = max(1.0, (solver.target_step_s / step) ** 2)
        elif case.plies[number].formulation == "shell-membrane":
            scale = SHELL_SCALING
        else:
            scale = _fitting_scale(case, number, stack, terms, shear, (skin, areal))
        scales.append(scale)
    plies = [m.areal_density_gsm * TONNE_PER_GSM_MM2 * s for m, s in zip(stack.materials, scales, strict=True)]
    return scales, [skin, *plies, skin]


def _fitting_scale(case: Case, number: int, stack: Stack, terms, shear: float, masses: tuple[float, float]) -> float:
    """Mass scaling with which a ply between diaphragms has their stable step; masses of a diaphragm and of the ply."""
    ply, material, (skin, areal) = stack.plies[number], stack.materials[number], masses

    def ahead(scale: float) -> float:
        both = [skin, scale * areal, skin]
        limits = [_diaphragm_limit(case, terms, both), _ply_limit(case, number, ply, material, shear, both, 1)]
        return math.log(limits[1] / limits[0])

    most = 1e6
    if ahead(1.0) >= 0.0 or ahead(most) <= 0.0:
        return 1.0 if ahead(1.0) >= 0.0 else most
    return float(brentq(ahead, 1.0, most, rtol=1e-6))


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
    sheets = zip(stack.plies, stack.materials, tangents, strict=True)
    plies = [_ply_limit(case, k, *sheet, masses, k + 1) for k, sheet in enumerate(sheets)]
    return case.solver.step_safety * min(_diaphragm_limit(case, terms, masses), *plies)


def _ply_limit(
    case: Case, number: int, ply: PlyMesh, material: WovenMaterial, shear: float, masses: list[float], k: int
) -> float:
    """Largest stable step [s] of ply `number` of the case; masses of a stack in which it is sheet k."""
    omega2 = ply_omega2(case, number, ply, material, shear, masses[k])
    damping = 2.0 * sum(pair_damping(case, masses, k, other) for other in (k - 1, k + 1))
    if case.plies[number].formulation == "shell-membrane":
        damping += 2.0 * case.solver.fibre_damping * math.sqrt(omega2) * masses[k]
    return _damped_limit(omega2, damping / masses[k])


def _diaphragm_limit(case: Case, terms, masses: list[float]) -> float:
    """Largest stable step [s] of the diaphragms; masses of their stack."""
    solver, d, stiff = case.solver, case.diaphragms, case.solver.contact_stiffness_N_mm3
    mu, bending = ogden.initial_shear_modulus(terms), ogden.bending_rigidity(terms, d.thickness_mm)
    bending = bending if d.bending else 0.0
    omega2 = timestep.diaphragm_omega2(mu, d.thickness_mm, bending, masses[0], d.element_mm, stiff)
    damping = 2.0 * max(pair_damping(case, masses, 0, other) for other in range(1, len(masses)))
    limit = _damped_limit(omega2, damping / masses[0])
    if not solver.self_contact:
        return limit
    # normal to flanks that touch: bending and contacts, but nothing of the membrane
    own, own_damping = own_contact(case, masses[0])
    omega2 = timestep.diaphragm_omega2(0.0, d.thickness_mm, bending, masses[0], d.element_mm, stiff + own)
    return min(limit, _damped_limit(omega2, (damping + 2.0 * own_damping) / masses[0]))


def _damped_limit(omega2: float, rate: float) -> float:
    """Largest stable step [s] at omega^2 [1/s2] with damping over mass `rate` [1/s]."""
    omega = math.sqrt(omega2)
    return float(timestep.damped_limit(omega, rate / (2.0 * omega)))


def own_contact(case: Case, mass: float) -> tuple[float, float]:
    """Stiffness [N/mm3] and damping [N s/mm3] of a diaphragm's contact with itself, of areal mass `mass`."""
    s = case.solver
    stiffness = OWN_STIFFNESS * s.contact_stiffness_N_mm3
    return stiffness, timestep.contact_damping(OWN_DAMPING * s.contact_damping, stiffness, mass, mass)


def pair_damping(case: Case, masses: list[float], a: int, b: int) -> float:
    """Damping of the contact between two sheets [N s/mm3]."""
    s = case.solver
    return timestep.contact_damping(s.contact_damping, s.contact_stiffness_N_mm3, masses[a], masses[b])
