"""A formed part in its tool's own frame, read back from a run's folder: what exports are made of.

Tool frame: the platform is z = 0, x and y as in the tool's file (`tool.position_mm` and `turn_deg` are undone).
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ddf.build import build_scene
from ddf.case import Case, case_from_dict, woven_material
from ddf.case.tool import Tool
from ddf.errors import UsageError
from ddf.mesh.triangles import TriangleMesh
from ddf.metrics import PlySurface
from ddf.output.reopen import formed_ply, plies_of
from ddf.output.results import FinishedRun, open_run
from ddf.output.snapshot import middle_offset_mm
from ddf.output.vtu import TOOL

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FormedPly:
    """One ply of a part."""

    surface: PlySurface  # x in the tool's frame; x0 flat, as laid in the case's frame
    thickness_mm: float  # flat
    orientation_deg: float  # of family 1 in the flat ply


@dataclass(frozen=True)
class FormedPart:
    """Plies, bottom first, and the tool that they lie on."""

    title: str
    plies: tuple[FormedPly, ...]
    tool: TriangleMesh | None  # without one the plies lie on the platform


def formed_part(path: str | Path, names: Sequence[str] = ()) -> FormedPart:
    """The part of a finished run, forming or kinematic; only the plies `names` if any are given.

    Reads the last frames; a forming run's scene is meshed again for its tool's height. Raises UsageError for a run
    that has not finished, wrote no frames (`output.vtu = false`) or has no such ply.
    """
    run = open_run(path)
    if run.info.get("stop_reason") != "finished":
        raise UsageError(f"{run.path} holds a run that is not finished", "finish it with ddf run --resume")
    case = case_from_dict(tomllib.loads(run.resolved_text))
    chosen = chosen_plies(run, names)
    tool, base_z, offsets = _placed(run, case, frame_times(run, chosen[0])[-1])
    plies = []
    for ply in case.plies:
        if ply.name not in chosen:
            continue
        surface = formed_ply(run, ply.name)
        x = _in_tool_frame(surface.x, case.tool, base_z)
        thickness = woven_material(case, ply.material).thickness_mm
        moved = replace(surface, x=x, offset_mm=offsets[ply.name])
        plies.append(FormedPly(moved, thickness, ply.orientation_deg))
    if tool is not None:
        tool = TriangleMesh(_in_tool_frame(tool.points.T, case.tool, 0.0).T.copy(), tool.triangles)
    return FormedPart(case.title or run.path.name, tuple(plies), tool)


def chosen_plies(run: FinishedRun, names: Sequence[str] = ()) -> list[str]:
    """The plies of a run, bottom first; of these `names` only, if any. Raises UsageError for one that is not there."""
    known = plies_of(run)
    for name in names:
        if name not in known:
            raise UsageError(f"{run.path} has no ply {name!r}", f"plies: {', '.join(known)}")
    return [name for name in known if not names or name in names]


def frame_times(run: FinishedRun, ply: str) -> list[float]:
    """Times [s] of a ply's frames. Raises UsageError if there are none."""
    there = (run.path / f"{ply}.pvd").is_file()
    times = [time for time, _ in run.frames(ply)] if there else []
    if not times:
        raise UsageError(f"{run.path} has no frames of {ply}", "run it with output.vtu = true")
    return times


def _placed(run: FinishedRun, case: Case, time: float) -> tuple[TriangleMesh | None, float, dict[str, float]]:
    """Tool where it stands in plan, its base's height at a time [mm], each ply's distance from it when it conforms."""
    if case.model == "kinematic":
        net = None if case.tool is None else run.read_frame(TOOL)
        tool = None if net is None else TriangleMesh(net["points"], net["cells"])
        return tool, 0.0, {ply.name: case.kinematic.offset_mm for ply in case.plies}
    scene = build_scene(case)
    offsets = {scene.sheets[k].name: middle_offset_mm(scene, k) for k in scene.ply_sheets}
    return scene.tool_mesh, scene.tool_z(time), offsets


def _in_tool_frame(x: Array, tool: Tool | None, base_z: float) -> Array:
    """Points (3, ...) of the case's frame in the tool's."""
    if tool is None:
        return np.stack([x[0], x[1], x[2] - base_z])
    c, s = np.cos(np.radians(tool.turn_deg)), np.sin(np.radians(tool.turn_deg))
    px, py = x[0] - tool.position_mm[0], x[1] - tool.position_mm[1]
    return np.stack([c * px + s * py, -s * px + c * py, x[2] - base_z])
