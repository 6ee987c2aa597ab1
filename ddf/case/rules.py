"""Which keys of a table go together: one of two, those a shape needs. They read the file's own tables,
so that they find their faults even where other values are wrong.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ddf.case.faults import KINDS, Problem, closest
from ddf.case.materials import merged_with_base
from ddf.case.preset_data import PRESET_DATA
from ddf.case.tool import COMMON_KEYS, OPTIONAL_KEYS, REQUIRED_KEYS, Tool
from ddf.case.words import KeyPath

Table = dict[str, Any]


def key_problems(raw: Table) -> list[Problem]:
    """Return the problems of every table of a case whose keys do not go together."""
    found: list[Problem] = []
    plies = raw.get("plies")
    for place, ply in enumerate(plies if isinstance(plies, list) else []):
        if isinstance(ply, dict):
            found += one_of(ply, ("plies", place), "size_mm", "polygon_mm")
    materials = raw.get("materials")
    for name, material in (materials if isinstance(materials, dict) else {}).items():
        if isinstance(material, dict):
            found += _material(material, ("materials", name))
    if isinstance(tool := raw.get("tool"), dict):
        found += _tool(tool)
    if isinstance(process := raw.get("process"), dict):
        found += one_of(process, ("process",), "stages", "breakpoints")
    if isinstance(solver := raw.get("solver"), dict):
        found += one_of(solver, ("solver",), "mass_scaling", "target_step_s", needed=False)
    found += _fidelity(raw)
    return found


def one_of(table: Table, path: KeyPath, a: str, b: str, *, needed: bool = True) -> Iterator[Problem]:
    """Yield a problem where both of two keys are given, or none of them though one is needed."""
    given = [key for key in (a, b) if table.get(key) is not None]
    if len(given) == 2:
        yield Problem((*path, b), f"cannot be given together with {a}", f"either {a} or {b}")
    elif not given and needed:
        yield Problem((*path, a), f"one of {a} and {b} is required", f"either {a} or {b}")


def _fidelity(raw: Table) -> Iterator[Problem]:
    target, auto = raw.get("target"), raw.get("fidelity") == "auto"
    if isinstance(target, dict):
        yield from one_of(target, ("target",), "seconds", "accuracy_mm")
        if not auto:
            yield Problem(("target",), "means nothing without fidelity = 'auto'", "fidelity = 'auto', or no [target]")
    elif auto and target is None:
        yield Problem(("fidelity",), "'auto' needs a [target]", "target.seconds or target.accuracy_mm")
    if auto and raw.get("model") == "kinematic":
        yield Problem(("fidelity",), "'auto' chooses the model itself", "no model, or fidelity = 'as-given'")


def _material(table: Table, path: KeyPath) -> Iterator[Problem]:
    base, kind = table.get("base"), table.get("kind")
    if isinstance(base, str):
        fitting = [name for name, preset in PRESET_DATA.items() if preset["kind"] == kind or kind not in KINDS]
        if base not in PRESET_DATA:
            problem = f"no preset is called {base!r}"
            yield Problem((*path, "base"), problem, ", ".join(fitting), closest(base, PRESET_DATA))
        elif base not in fitting:
            problem = f"the preset {base!r} is {PRESET_DATA[base]['kind']}, not {kind}"
            yield Problem((*path, "base"), problem, ", ".join(fitting))
    merged = merged_with_base(table)
    if kind == "woven" and (merged is not table or not isinstance(base, str)):
        yield from one_of(merged, path, "shear_modulus_polynomial_MPa", "shear_table")


def _tool(table: Table) -> Iterator[Problem]:
    shape = table.get("shape")
    if not isinstance(shape, str) or shape not in REQUIRED_KEYS:
        return
    required, optional = REQUIRED_KEYS[shape], OPTIONAL_KEYS[shape]
    for key in required:
        if table.get(key) is None:
            yield Problem(("tool", key), f"required for the shape {shape!r}")
    allowed = (*COMMON_KEYS, *required, *optional)
    for key in table:
        if key in Tool.model_fields and key not in allowed:
            yield Problem(("tool", key), f"means nothing for the shape {shape!r}", ", ".join(allowed))
