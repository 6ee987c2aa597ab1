"""Checks between valid parts of a case: materials by name, the process and the tool.

Every check takes only parts that are valid by themselves, so that it can run beside other faults.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

from pydantic import ValidationError

from ddf.case import schema
from ddf.case.checks_geometry import mesh_problems, ply_problems, start_problems, tool_problems
from ddf.case.checks_values import gap_problem, material_problems
from ddf.case.faults import KINDS, Problem, closest
from ddf.case.preset_data import PRESET_DATA
from ddf.case.schema import with_ply_names
from ddf.case.words import KeyPath

T = TypeVar("T")


DEFAULT_WEAVE = schema.Ply.model_fields["material"].default
RESERVED_NAMES = ("bottom-diaphragm", "top-diaphragm", "tool")  # other sheets' files
_OUTLINE_KEYS = ("size_mm", "polygon_mm", "holes_mm", "slits_mm", "offset_mm", "element_mm")


@dataclass(frozen=True)
class Parts:
    """The parts of a case that are valid by themselves; None where one is not (or is left out).

    Of the plies, only the outlines count: the other keys hold defaults.
    """

    frame: schema.Frame | None
    diaphragms: schema.Diaphragms | None
    plies: list[schema.Ply | None]
    tool: schema.Tool | None
    kinematic: schema.Kinematic | None
    breakpoints: schema.Breakpoints | None
    shear_tables: dict[str, schema.ShearTable | None]
    rubbers: dict[str, schema.HyperelasticMaterial | None]
    weaves: dict[str, schema.WovenMaterial | None]


def valid_parts(raw: dict[str, Any]) -> Parts:
    """Validate each part of a case alone, and keep what is valid."""
    materials = {name: table for name, table in _table(raw, "materials").items() if isinstance(table, dict)}
    rubber = schema.HyperelasticMaterial.model_validate
    return Parts(
        frame=_valid(schema.Frame.model_validate, raw.get("frame", {})),
        diaphragms=_valid(schema.Diaphragms.model_validate, raw.get("diaphragms", {})),
        plies=[_valid(schema.Ply.model_validate, _outline_keys(ply)) for ply in _items(raw, "plies")],
        tool=_valid(schema.Tool.model_validate, raw.get("tool")),
        kinematic=_valid(schema.Kinematic.model_validate, raw.get("kinematic", {})),
        breakpoints=_valid(schema.Breakpoints.model_validate, _table(raw, "process").get("breakpoints")),
        shear_tables={
            name: _valid(schema.ShearTable.model_validate, table.get("shear_table"))
            for name, table in materials.items()
        },
        rubbers={name: _valid(rubber, table) for name, table in materials.items()},
        weaves={name: _valid(schema.WovenMaterial.model_validate, table) for name, table in materials.items()},
    )


def cross_problems(raw: dict[str, Any], parts: Parts) -> list[Problem]:
    """Return every problem between the valid parts of a case."""
    found = [*_material_uses(raw), *_materials(parts), *_process(raw, parts)]
    names = [_name_of(ply) for ply in _items(with_ply_names(raw), "plies")]
    found += [*_repeated(("plies",), names), *_reserved(names)]
    for place, ply in enumerate(parts.plies):
        if ply is not None and (ply.size_mm is None) != (ply.polygon_mm is None):
            found += ply_problems(ply, ("plies", place), parts.frame)
            if raw.get("model") == "kinematic" and parts.kinematic is not None:
                found += start_problems(ply, parts.kinematic.start_mm, place)
    if parts.tool is not None:
        found += tool_problems(parts.tool, parts.frame)
    if parts.diaphragms is not None:
        found += mesh_problems(parts.diaphragms, parts.frame, parts.plies, parts.tool)
        materials = [ply.get("material", DEFAULT_WEAVE) for ply in _items(raw, "plies") if isinstance(ply, dict)]
        found += gap_problem(parts.diaphragms.gap_mm, materials, parts.weaves)
    found += material_problems(parts.weaves)
    return found


def _valid(validate: Callable[[Any], T], table: Any) -> T | None:
    try:
        return validate(table)
    except ValidationError:
        return None


def _outline_keys(ply: Any) -> Any:
    if not isinstance(ply, dict):
        return None
    return {"name": "outline"} | {key: value for key, value in ply.items() if key in _OUTLINE_KEYS}


def _table(table: dict[str, Any], key: str) -> dict[str, Any]:
    found = table.get(key)
    return found if isinstance(found, dict) else {}


def _items(table: Any, key: str) -> list[Any]:
    items = table.get(key) if isinstance(table, dict) else None
    return items if isinstance(items, list) else []


def _name_of(table: Any) -> str | None:
    name = table.get("name") if isinstance(table, dict) else None
    return name if isinstance(name, str) else None


def _repeated(path: KeyPath, names: Sequence[str | None]) -> Iterator[Problem]:
    """Yield a problem for each name that stands twice; case is ignored, as some file systems do."""
    seen: dict[str, int] = {}
    for place, name in enumerate(names):
        if name is None:
            continue
        first = seen.setdefault(name.casefold(), place)
        if first != place:
            problem = f"the name {name!r} is already that of {path[-1]}.{first}"
            yield Problem((*path, place, "name"), problem, "a unique name")


def _reserved(names: Sequence[str | None]) -> Iterator[Problem]:
    """Yield a problem for each ply whose files would be those of a diaphragm or of the tool."""
    for place, name in enumerate(names):
        if name is not None and name.casefold() in RESERVED_NAMES:
            problem = f"the name {name!r} is taken by the run's own files"
            yield Problem(("plies", place, "name"), problem, f"any name but {', '.join(RESERVED_NAMES)}")


def _material_uses(raw: dict[str, Any]) -> Iterator[Problem]:
    """Check that each material asked for exists and is of the kind it is used as."""
    kinds: dict[str, Any] = {name: preset["kind"] for name, preset in PRESET_DATA.items()}
    for name, table in _table(raw, "materials").items():
        kinds[name] = table.get("kind") if isinstance(table, dict) else None
    uses: list[tuple[KeyPath, Any, str]] = [
        (("diaphragms", "material"), _table(raw, "diaphragms").get("material"), "hyperelastic")
    ]
    for place, ply in enumerate(_items(raw, "plies")):
        used = ply.get("material") if isinstance(ply, dict) else None
        uses.append((("plies", place, "material"), used, "woven"))
    for path, name, wanted in uses:
        fitting = [known for known, kind in kinds.items() if kind == wanted]
        if not isinstance(name, str):
            continue  # Left out, or of a wrong type, which is reported elsewhere.
        if name not in kinds:
            yield Problem(path, f"no material is called {name!r}", ", ".join(fitting), closest(name, kinds))
        elif kinds[name] != wanted and kinds[name] in KINDS:
            yield Problem(path, f"the material {name!r} is {kinds[name]}, not {wanted}", ", ".join(fitting))


def _materials(parts: Parts) -> Iterator[Problem]:
    """Check shear tables and the stiffness of rubbers."""
    for name, table in parts.shear_tables.items():
        if table is not None:
            yield from _shear_table(table, ("materials", name, "shear_table"))
    for name, rubber in parts.rubbers.items():
        if rubber is None:
            continue
        path: KeyPath = ("materials", name, "ogden")
        for place, term in enumerate(rubber.ogden):
            if term.alpha == 0:
                yield Problem((*path, place, "alpha"), "0 is out of range", "any number but 0")
        if sum(mu for mu, _ in rubber.abaqus_terms) <= 0:
            problem = "the initial shear modulus of these terms is not positive"
            yield Problem(path, problem, "a sum of mu (abaqus) or mu alpha/2 (classical) > 0")


def _shear_table(table: schema.ShearTable, path: KeyPath) -> Iterator[Problem]:
    angles, forces = table.angle_deg, table.normalised_shear_force_N_mm
    if len(angles) != len(forces):
        problem = f"has {len(forces)} items, but angle_deg has {len(angles)}"
        yield Problem((*path, "normalised_shear_force_N_mm"), problem, "as many as angles")
    yield from _ascending(angles, (*path, "angle_deg"))
    if forces[0] != 0:
        problem = f"starts at {forces[0]:g}, but no shear means no force"
        yield Problem((*path, "normalised_shear_force_N_mm"), problem, "0 first")


def _ascending(values: Sequence[float], path: KeyPath) -> Iterator[Problem]:
    """Check that a list starts at 0 and ascends strictly."""
    allowed = "0 first, then strictly ascending"
    if values[0] != 0:
        yield Problem(path, f"starts at {values[0]:g}", allowed)
    for place, (low, high) in enumerate(pairwise(values), start=1):
        if high <= low:
            yield Problem((*path, place), f"{high:g} follows {low:g}", allowed)
            return


def _process(raw: dict[str, Any], parts: Parts) -> Iterator[Problem]:
    """Check stage names, the breakpoints' lists, and that only a tool is lifted."""
    path: KeyPath = ("process", "stages")
    process = raw.get("process")
    yield from _repeated(path, [_name_of(stage) for stage in _items(process, "stages")])
    lifts: list[KeyPath] = []
    for place, stage in enumerate(_items(process, "stages")):
        lift = stage.get("tool_lift_mm") if isinstance(stage, dict) else None
        if isinstance(lift, int | float) and lift > 0:
            lifts.append((*path, place, "tool_lift_mm"))
    points = parts.breakpoints
    if points is not None:
        path = ("process", "breakpoints")
        yield from _ascending(points.time_s, (*path, "time_s"))
        for key in ("cavity_pressure_kPa", "box_pressure_kPa", "tool_lift_mm"):
            values = getattr(points, key)
            if values is not None and len(values) != len(points.time_s):
                problem = f"has {len(values)} items, but time_s has {len(points.time_s)}"
                yield Problem((*path, key), problem, "as many as times")
        if points.tool_lift_mm and max(points.tool_lift_mm) > 0:
            lifts.append((*path, "tool_lift_mm"))
    if lifts and raw.get("tool") is None:
        yield Problem(lifts[0], "there is no tool to lift", "0 or left out, or add a [tool]")
