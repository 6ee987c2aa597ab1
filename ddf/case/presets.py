"""Materials that ship with ddf, and the look-up of a material by its name in a case."""

from __future__ import annotations

from pydantic import TypeAdapter

from ddf.case.faults import closest
from ddf.case.materials import HyperelasticMaterial, Material, WovenMaterial
from ddf.case.preset_data import PRESET_DATA, PRESET_SOURCES
from ddf.case.schema import Case
from ddf.errors import CaseError, Fault

_ADAPTER: TypeAdapter[WovenMaterial | HyperelasticMaterial] = TypeAdapter(Material)

PRESETS: dict[str, WovenMaterial | HyperelasticMaterial] = {
    name: _ADAPTER.validate_python(data) for name, data in PRESET_DATA.items()
}


def preset_source(name: str) -> str:
    """Return the citation of a preset, with what is known about the quality of its numbers."""
    return PRESET_SOURCES[name]


def resolve_material(case: Case, name: str) -> WovenMaterial | HyperelasticMaterial:
    """Return the material called `name`: the case's own first, then the presets.

    Raises CaseError where there is none.
    """
    if name in case.materials:
        return case.materials[name]
    if name in PRESETS:
        return PRESETS[name]
    known = [*case.materials, *PRESETS]
    problem = f"no material is called {name!r}"
    raise CaseError([Fault("<case>", 1, "materials", problem, ", ".join(known), closest(name, known))])


def woven_material(case: Case, name: str) -> WovenMaterial:
    """Return the woven material called `name`; raises CaseError where it is of another kind."""
    material = resolve_material(case, name)
    if isinstance(material, WovenMaterial):
        return material
    raise CaseError([Fault("<case>", 1, "materials", f"{name!r} is not woven", "a woven material")])


def hyperelastic_material(case: Case, name: str) -> HyperelasticMaterial:
    """Return the hyperelastic material called `name`; raises CaseError where it is of another kind."""
    material = resolve_material(case, name)
    if isinstance(material, HyperelasticMaterial):
        return material
    problem = f"{name!r} is not hyperelastic"
    raise CaseError([Fault("<case>", 1, "materials", problem, "a hyperelastic material")])


def resolve_gap_mm(case: Case) -> float:
    """Return the gap between the diaphragms' inner surfaces [mm]: as given, or 0.2 + the plies' thickness."""
    if case.diaphragms.gap_mm is not None:
        return case.diaphragms.gap_mm
    return 0.2 + sum(woven_material(case, ply.material).thickness_mm for ply in case.plies)
