"""The sheets of a case as flat meshes, one on the other, and its tool."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ddf.build.rim import RINGS
from ddf.case import Case, resolve_gap_mm, woven_material
from ddf.case.schema import Tool, WovenMaterial
from ddf.mesh.diaphragm import DiaphragmMesh, mesh_diaphragm
from ddf.mesh.distance import DistanceField, distance_field
from ddf.mesh.ply import PlyMesh, mesh_ply
from ddf.mesh.tool import TriangleMesh, build_tool

FloatArray = NDArray[np.float64]

_TOOL_KEYS = ("height_mm", "radius_mm", "length_mm", "width_mm", "fillet_mm", "file", "unit")


class Stack(NamedTuple):
    """All sheets of a case in order, bottom diaphragm first."""

    plies: list[PlyMesh]
    materials: list[WovenMaterial]
    diaphragm: DiaphragmMesh
    z: list[float]  # mid-surface of each sheet [mm]
    thickness: list[float]  # as clamped [mm]


def mesh_stack(case: Case, even: bool = False, rings: int = RINGS) -> Stack:
    """Mesh all sheets of a case, with even numbers of cells where wanted, rings around plies. Raises MeshError."""
    plies = []
    for ply in case.plies:
        outline, holes, slits = ply.outline_mm(), ply.holes_mm, ply.slits_mm
        shape = np.asarray(outline) - np.asarray(ply.offset_mm)
        offset = (ply.offset_mm[0], ply.offset_mm[1])
        angle, element = ply.orientation_deg, ply.element_mm
        plies.append(mesh_ply(shape, holes, slits, angle, element, offset, ply.name, even, rings))
    d = case.diaphragms
    corners = np.concatenate([np.asarray(ply.outline_mm(), dtype=float) for ply in case.plies])
    low, high = corners.min(axis=0) - d.margin_mm, corners.max(axis=0) + d.margin_mm
    half = np.array([case.frame.length_mm, case.frame.width_mm]) / 2
    low, high = np.maximum(low, -half), np.minimum(high, half)
    box = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
    mesh = mesh_diaphragm(
        case.frame.length_mm, case.frame.width_mm, box, d.element_mm, d.element_max_mm, d.growth, even
    )
    materials = [woven_material(case, ply.material) for ply in case.plies]
    thick = [m.thickness_mm for m in materials]
    skin = d.thickness_mm / d.pre_stretch**2
    gap = resolve_gap_mm(case)
    ends = np.cumsum([0.0, *thick]) - 0.5 * sum(thick)
    mid = [float(0.5 * (a + b)) for a, b in zip(ends[:-1], ends[1:], strict=True)]
    z = [-0.5 * (gap + skin), *mid, 0.5 * (gap + skin)]
    return Stack(plies, materials, mesh, z, [skin, *thick, skin])


def flat_positions(stack: Stack) -> FloatArray:
    """Positions (3 N,) of all sheets, flat at their heights in the stack [mm]."""
    meshes: list[PlyMesh | DiaphragmMesh] = [stack.diaphragm, *stack.plies, stack.diaphragm]
    parts = []
    for mesh, z in zip(meshes, stack.z, strict=True):
        x = np.array(mesh.x, dtype=float)
        x[2] = z
        parts.append(x.ravel())
    return np.concatenate(parts)


def mesh_tool(tool: Tool) -> tuple[TriangleMesh, DistanceField]:
    """Tool mesh, turned and placed, and its distance field."""
    keys = {key: getattr(tool, key) for key in tool.used_keys() if key in _TOOL_KEYS}
    mesh = build_tool(tool.shape, **{key: value for key, value in keys.items() if value is not None})
    c, s = math.cos(math.radians(tool.turn_deg)), math.sin(math.radians(tool.turn_deg))
    points = mesh.points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    points += [*tool.position_mm, 0.0]
    placed = TriangleMesh(points, mesh.triangles)
    return placed, distance_field(placed)


def nominal_height(tool: Tool, mesh: TriangleMesh) -> float:
    """Height [mm] that touches the stack at zero lift: of the sharp solid, or of the file's highest point."""
    if tool.shape == "hemisphere" and tool.radius_mm is not None:
        return tool.radius_mm
    return float(mesh.top_mm) if tool.height_mm is None else tool.height_mm
