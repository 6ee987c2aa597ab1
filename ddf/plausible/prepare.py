"""From a case to a scene that is worth running: faults first, then the meshes, then what they tell."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

from ddf.build import build_scene, load_path
from ddf.case import Case
from ddf.case.faults import Problem
from ddf.case.load import Source
from ddf.case.words import KeyPath
from ddf.errors import CaseError, MeshError
from ddf.plausible.cost import examine_disk, examine_memory, examine_steps
from ddf.plausible.findings import Findings
from ddf.plausible.materials import examine_materials
from ddf.plausible.mesh import examine_mesh
from ddf.plausible.process import examine_process
from ddf.plausible.tool_file import examine_tool_file
from ddf.scene import Scene


def examine(case: Case) -> Findings:
    """Look at a case before anything is meshed."""
    found = Findings()
    path = load_path(case)
    examine_process(case, path, found)
    examine_materials(case, found)
    examine_mesh(case, path, found)
    examine_tool_file(case, found)
    examine_memory(case, found)
    return found


def prepare(
    case: Case,
    source: Source | None = None,
    warn: Callable[[str], None] = lambda text: None,
    folder: Path | None = None,
) -> Scene:
    """Examine a case, mesh it, examine the scene, and return it; each warning goes to `warn`.

    With `folder` the frames are held against its disk. Raises CaseError with the faults of the case, placed by
    `source`, and MeshError where the meshing itself fails.
    """
    source = source or Source()
    _settle(examine(case), source, warn)
    try:
        scene = build_scene(case)
    except MeshError as error:
        key = _blamed(case, error.message)
        if key is None:
            raise
        raise CaseError([source.fault(Problem(key, error.message, error.hint))]) from error
    found = Findings()
    examine_steps(scene, found)
    if folder is not None:
        examine_disk(scene, float(shutil.disk_usage(folder).free), found)
    _settle(found, source, warn)
    return scene


def _settle(found: Findings, source: Source, warn: Callable[[str], None]) -> None:
    for problem in found.warnings:
        warn(f"warning: {source.fault(problem)}")
    if found.faults:
        raise CaseError([source.fault(problem) for problem in found.faults])


def _blamed(case: Case, message: str) -> KeyPath | None:
    """The key that a mesher's message is about; None where the mesher itself is at fault."""
    if "fillet" in message and case.tool is not None:
        return ("tool", "fillet_mm")
    for place, ply in enumerate(case.plies):
        if message.startswith(f"{ply.name}:"):
            return ("plies", place)
    return ("diaphragms",) if message.startswith("diaphragm:") else None
