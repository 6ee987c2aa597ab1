"""Axes of the speed-accuracy study: what a setting changes in a case, and the values to go through.

Values stand from the cheapest to the finest. Numbers are factors on the case's own settings, so that 1 is the case as
it is. Fibre tension is implicit, there are no inner steps (docs/solver.md), and so no axis of them. An axis more is an
entry more in `AXES`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ddf.case import Case, WovenMaterial, woven_material
from ddf.case.changes import Changes, stretched
from ddf.case.preset_data import PRESET_DATA

Value = float | str

LATTICE, SHELL, NET = "lattice", "shell-membrane", "net"
ON, OFF = "on", "off"
HALF, WHOLE = "half", "whole"


@dataclass(frozen=True)
class Axis:
    """One setting: its values from the cheapest to the finest, and what each changes."""

    name: str
    meaning: str
    values: tuple[Value, ...]
    own: Callable[[Case], Value]  # the value that stands for the case as it is
    change: Callable[[Case, Value, Changes], Changes]  # further changes, given those of the axes before
    label: Callable[[Case, Value], str]
    crossed: bool = True  # tried with every element size; else with the coarsest alone
    saves_steps: bool = False  # cheaper values make the step longer or the process shorter
    choices: tuple[str, ...] = ()  # of an axis without numbers: all that may be asked for


def _one(case: Case) -> Value:
    return 1.0


def _element(case: Case, value: Value, done: Changes) -> Changes:
    factor, d = float(value), case.diaphragms
    plies = {f"plies.{k}.element_mm": _mm(factor * ply.element_mm) for k, ply in enumerate(case.plies)}
    largest = max(d.element_max_mm, factor * d.element_mm)
    return plies | {"diaphragms.element_mm": _mm(factor * d.element_mm), "diaphragms.element_max_mm": _mm(largest)}


def _diaphragm(case: Case, value: Value, done: Changes) -> Changes:
    size = float(value) * float(done.get("diaphragms.element_mm", case.diaphragms.element_mm))
    largest = max(float(done.get("diaphragms.element_max_mm", case.diaphragms.element_max_mm)), size)
    return {"diaphragms.element_mm": _mm(size), "diaphragms.element_max_mm": _mm(largest)}


def _mass(case: Case, value: Value, done: Changes) -> Changes:
    factor, solver = float(value), case.solver
    changes: Changes = {"solver.diaphragm_mass_scaling": max(1.0, factor * solver.diaphragm_mass_scaling)}
    if solver.target_step_s is not None:
        return changes | {"solver.target_step_s": factor**0.5 * solver.target_step_s}
    if solver.mass_scaling is not None:
        return changes | {"solver.mass_scaling": max(1.0, factor * solver.mass_scaling)}
    return changes  # plies left to it are as heavy as the diaphragms' step asks


def _load_time(case: Case, value: Value, done: Changes) -> Changes:
    return stretched(case, float(value))


def _fibre(case: Case, value: Value, done: Changes) -> Changes:
    """Each ply's fabric with its fibres' modulus times the value: a material of its own."""
    changes: Changes = {}
    for k, ply in enumerate(case.plies):
        fabric = woven_material(case, ply.material)
        name = f"{ply.material}-modulus-{float(value):g}".replace(".", "_")
        changes[f'materials."{name}"'] = _softened(fabric, ply.material, float(value))
        changes[f"plies.{k}.material"] = name
    return changes


def _softened(fabric: WovenMaterial, name: str, factor: float) -> dict[str, Any]:
    modulus = [float(f"{factor * value:.9g}") for value in fabric.membrane_modulus_N_mm]
    if name in PRESET_DATA:
        return {"kind": "woven", "base": name, "membrane_modulus_N_mm": modulus}
    return fabric.model_dump(exclude={"base"}, exclude_none=True) | {"membrane_modulus_N_mm": modulus}


def _formulation(case: Case, value: Value, done: Changes) -> Changes:
    if value == NET:
        return {"model": "kinematic"}
    return {"model": "forming"} | {f"plies.{k}.formulation": value for k in range(len(case.plies))}


def _own_formulation(case: Case) -> Value:
    return NET if case.model == "kinematic" else case.plies[0].formulation


def _bending(case: Case, value: Value, done: Changes) -> Changes:
    return {"diaphragms.bending": value == ON}


def _self_contact(case: Case, value: Value, done: Changes) -> Changes:
    return {"solver.self_contact": value == ON}


def _symmetry(case: Case, value: Value, done: Changes) -> Changes:
    return {"solver.symmetry": "auto" if value == HALF else "off"}


def _mm(size: float) -> float:
    """A size to a thousandth of a millimetre, as a person would write it."""
    return round(size, 3)


def _element_label(case: Case, value: Value) -> str:
    return f"{_mm(float(value) * case.plies[0].element_mm):g}mm"


AXES: dict[str, Axis] = {
    axis.name: axis
    for axis in (
        Axis("element", "elements of plies and diaphragms", (2.0, 1.5, 1.0, 0.75), _one, _element, _element_label),
        Axis(
            "diaphragm", "elements of the diaphragms, beyond that", (1.5, 1.0, 0.75), _one, _diaphragm,
            lambda _, value: f"skin-x{value:g}", saves_steps=True,
        ),
        Axis(
            "mass", "mass scaling of plies and diaphragms", (4.0, 1.0, 0.5), _one, _mass,
            lambda _, value: f"mass-x{value:g}", saves_steps=True,
        ),
        Axis(
            "load-time", "durations of all stages, mass damping over them", (0.5, 1.0, 1.5), _one, _load_time,
            lambda _, value: f"time-x{value:g}", saves_steps=True,
        ),
        Axis(
            "fibre-modulus", "tensile modulus of the fibres", (0.1, 1.0), _one, _fibre,
            lambda _, value: f"fibre-x{value:g}",
        ),
        Axis(
            "bending", "bending of the diaphragms", (OFF, ON), lambda case: ON if case.diaphragms.bending else OFF,
            _bending, lambda _, value: f"bending-{value}", choices=(OFF, ON),
        ),
        Axis(
            "self-contact", "of sheets that fold", (OFF, ON), lambda case: ON if case.solver.self_contact else OFF,
            _self_contact, lambda _, value: f"self-contact-{value}", choices=(OFF, ON),
        ),
        Axis(
            "symmetry", "half model, of a scene that is its own image", (HALF, WHOLE),
            lambda case: HALF if case.solver.symmetry == "auto" else WHOLE, _symmetry, lambda _, value: str(value),
            choices=(HALF, WHOLE),
        ),
        Axis(
            "formulation", "of the plies", (NET, SHELL, LATTICE), _own_formulation, _formulation,
            lambda _, value: str(value), crossed=False, choices=(NET, SHELL, LATTICE),
        ),
    )
}  # fmt: skip
