"""Sense of a tool that is read from a file: it opens, is closed, and has the size of a tool for this frame."""

from __future__ import annotations

import math

import numpy as np

from ddf.case import Case
from ddf.errors import MeshError
from ddf.mesh.tool import UNITS, TriangleMesh, build_tool
from ddf.plausible.findings import Findings

SMALLEST_MM = 1.0


def examine_tool_file(case: Case, found: Findings) -> None:
    """Read the tool's file and hold it against the frame and the diaphragm's elements."""
    tool = case.tool
    if tool is None or tool.shape != "file":
        return
    try:
        mesh = build_tool("file", file=tool.file, unit=tool.unit)
    except MeshError as error:
        found.fault(("tool", "file"), error.message, error.hint)
        return
    across, half = _reach(mesh, tool.turn_deg, tool.position_mm), 0.5 * min(case.frame.length_mm, case.frame.width_mm)
    size = f"{2 * across:.4g} mm across and {mesh.top_mm:.4g} mm high"
    reach = np.abs(tool.position_mm) + across - 0.5 * np.array([case.frame.length_mm, case.frame.width_mm])
    if min(across, mesh.top_mm) < SMALLEST_MM or across < case.diaphragms.element_mm:
        allowed = f"more than {SMALLEST_MM:g} mm, and than a diaphragm's element"
        found.fault(("tool", "unit"), f"the tool is {size}: too small", allowed, _unit(tool.unit, across, half))
    elif (reach > 0.0).any():
        allowed = f"within +-{0.5 * case.frame.length_mm:g} x +-{0.5 * case.frame.width_mm:g} mm"
        found.fault(
            ("tool", "file"),
            f"the tool is {size}: it reaches beyond the frame",
            allowed,
            _unit(tool.unit, across, half),
        )
    low = float(mesh.points[:, 2].min())
    if low > 1.0:
        problem = f"the tool floats {low:.4g} mm above its platform z = 0"
        found.warn(("tool", "file"), problem, "a base at or below z = 0")


def _reach(mesh: TriangleMesh, turn_deg: float, position_mm: tuple[float, float]) -> float:
    """Largest distance [mm] of the part above the platform from the tool's axis along x or y, as turned."""
    turn = math.radians(turn_deg)
    turning = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    above = mesh.points[mesh.points[:, 2] >= min(0.0, mesh.top_mm)]
    return float(np.abs(above[:, :2] @ turning).max())


def _unit(given: str, across: float, half: float) -> str:
    """The unit that would make a tool of a sensible size in this frame, if one does."""
    for unit in ("mm", "m", "inch"):
        scaled = across * UNITS[unit] / UNITS[given]
        if unit != given and 0.05 * half <= scaled <= half:
            return f'unit = "{unit}"'
    return ""
