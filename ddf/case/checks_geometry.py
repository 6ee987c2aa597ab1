"""Checks of places and outlines: plies, their holes and slits, and the tool, within the frame."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ddf.case.faults import Problem
from ddf.case.geometry import coinciding_corners, crossing_edges, inside, lines_meet
from ddf.case.plies import Ply
from ddf.case.schema import Diaphragms, Frame, Tool
from ddf.case.tool import REQUIRED_KEYS
from ddf.case.words import KeyPath

FRAME_MARGIN_MM = 20.0
MAX_CUT_POINTS = 10_000  # of all holes and slits of a ply: each is checked against the outline and the other holes


def ply_problems(ply: Ply, path: KeyPath, frame: Frame | None) -> Iterator[Problem]:
    """Check a ply's outline, its holes and slits, its place in the frame and its element size."""
    outline_path = (*path, "size_mm" if ply.polygon_mm is None else "polygon_mm")
    outline = np.asarray(ply.outline_mm())
    if frame is not None:
        yield from _in_frame(outline, ply, path, outline_path, frame)
    short = float(np.ptp(outline, axis=0).min())
    if ply.element_mm > 0.5 * short > 0.0:
        problem = f"{ply.element_mm:g} is too large for a ply {short:g} mm across"
        yield Problem((*path, "element_mm"), problem, f"<= {0.5 * short:g}")
    broken = list(_polygon(ply.polygon_mm, outline_path)) if ply.polygon_mm is not None else []
    yield from broken
    if not broken:
        yield from _cuts(ply, path)


def _in_frame(outline: np.ndarray, ply: Ply, path: KeyPath, outline_path: KeyPath, frame: Frame) -> Iterator[Problem]:
    half = 0.5 * np.array([frame.length_mm, frame.width_mm]) - FRAME_MARGIN_MM
    beyond = (np.abs(outline) - half).max(axis=0)
    if (beyond <= 1e-9).all():
        return
    fits = (0.5 * np.ptp(outline, axis=0) <= half).all()
    moved = fits and ply.offset_mm != (0.0, 0.0)
    axis = int(np.argmax(beyond))
    problem = f"the ply reaches {beyond[axis]:.4g} mm too far along {'xy'[axis]}"
    allowed = f"within +-{half[0]:g} x +-{half[1]:g} mm, {FRAME_MARGIN_MM:g} mm inside the frame"
    yield Problem((*path, "offset_mm") if moved else outline_path, problem, allowed)


def _polygon(points: tuple[tuple[float, float], ...], path: KeyPath) -> Iterator[Problem]:
    """Check that a polygon is simple: no corner twice in a row, no edges that meet."""
    same = coinciding_corners(points)
    if same is not None:
        problem = f"corners {same[0]} and {same[1]} are at one place"
        yield Problem(path, problem, "each corner once, the first not repeated at the end")
        return
    crossing = crossing_edges(points)
    if crossing is not None:
        problem = f"edges {crossing[0]} and {crossing[1]} cross or touch"
        yield Problem(path, problem, "a simple polygon")


def _cuts(ply: Ply, path: KeyPath) -> Iterator[Problem]:
    """Check that holes are simple, inside the outline and apart, and that slits stay inside it."""
    for key, cuts in (("holes_mm", ply.holes_mm), ("slits_mm", ply.slits_mm)):
        count = sum(len(cut) for cut in cuts)
        if count > MAX_CUT_POINTS:
            yield Problem((*path, key), f"has {count} points in all", f"<= {MAX_CUT_POINTS} points")
            return
    dx, dy = ply.offset_mm
    outline = tuple((x - dx, y - dy) for x, y in ply.outline_mm())
    sound: list[int] = []
    for place, hole in enumerate(ply.holes_mm):
        hole_path = (*path, "holes_mm", place)
        broken = list(_polygon(hole, hole_path))
        yield from broken
        if broken:
            continue
        crosses = lines_meet(hole, outline, closed=(True, True), touching=True)
        if crosses or not inside(hole[:1], outline).all():
            yield Problem(hole_path, "the hole is not inside the outline", "clear of the outline")
        for other in sound:
            if _overlap(hole, ply.holes_mm[other]):
                yield Problem(hole_path, f"meets or overlaps holes_mm.{other}", "holes apart from each other")
                break
        sound.append(place)
    for place, slit in enumerate(ply.slits_mm):
        leaves = lines_meet(slit, outline, closed=(False, True), touching=False)
        if leaves or not inside(slit, outline).all():
            problem = "the slit is not inside the outline"
            yield Problem((*path, "slits_mm", place), problem, "inside the outline; it may end on it")


def _overlap(a: tuple[tuple[float, float], ...], b: tuple[tuple[float, float], ...]) -> bool:
    if lines_meet(a, b, closed=(True, True), touching=True):
        return True
    return bool(inside(a[:1], b)[0] or inside(b[:1], a)[0])


def start_problems(ply: Ply, start: tuple[float, float] | None, place: int) -> Iterator[Problem]:
    """Check that a net starts on the ply (for None: at its centre)."""
    at = ply.offset_mm if start is None else start
    local = ((at[0] - ply.offset_mm[0], at[1] - ply.offset_mm[1]),)
    outline = tuple((x - ply.offset_mm[0], y - ply.offset_mm[1]) for x, y in ply.outline_mm())
    if not inside(local, outline).all() or any(inside(local, hole).all() for hole in ply.holes_mm):
        problem = f"({at[0]:g}, {at[1]:g}) mm is not on the fabric of plies.{place}"
        yield Problem(("kinematic", "start_mm"), problem, "a place on every ply")


def tool_problems(tool: Tool, frame: Frame | None) -> Iterator[Problem]:
    """Check that the tool stands inside the frame and that its fillet fits on it."""
    if any(getattr(tool, key) is None for key in REQUIRED_KEYS[tool.shape]):
        return
    radius = tool.footprint_radius_mm()
    if frame is not None and radius is not None:
        corners = _box_corners(tool) if tool.shape == "box" else None
        reach = np.full(2, radius) if corners is None else np.abs(corners).max(axis=0)
        half = 0.5 * np.array([frame.length_mm, frame.width_mm])
        beyond = np.abs(np.asarray(tool.position_mm)) + reach - half
        if (beyond > 1e-9).any():
            key = "position_mm" if (reach <= half).all() else "shape"
            axis = int(np.argmax(beyond))
            problem = f"the tool reaches {beyond[axis]:.4g} mm beyond the frame along {'xy'[axis]}"
            yield Problem(("tool", key), problem, f"within +-{half[0]:g} x +-{half[1]:g} mm")
    used = tool.used_keys()
    room = math.inf
    for key, part in (("height_mm", 1.0), ("radius_mm", 1.0), ("length_mm", 0.5), ("width_mm", 0.5)):
        size = getattr(tool, key) if key in used else None
        room = min(room, math.inf if size is None else part * size)
    if "fillet_mm" in used and tool.fillet_mm > room:
        problem = f"{tool.fillet_mm:g} is too large for this tool"
        yield Problem(("tool", "fillet_mm"), problem, f"<= {room:g}")


def _box_corners(tool: Tool) -> np.ndarray:
    """Return two neighbouring corners of a box's base [mm] about its centre, turned. Shape (2, 2)."""
    a, b = 0.5 * (tool.length_mm or 0.0), 0.5 * (tool.width_mm or 0.0)
    turn = math.radians(tool.turn_deg)
    turning = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    turned: np.ndarray = np.array([[a, b], [a, -b]]) @ turning
    return turned


def mesh_problems(
    diaphragms: Diaphragms, frame: Frame | None, plies: Sequence[Ply | None], tool: Tool | None
) -> Iterator[Problem]:
    """Check that elements are small against frame, plies and tool: a mesh that cannot show their shape is none."""
    path = ("diaphragms", "element_mm")
    size = diaphragms.element_mm
    if diaphragms.element_max_mm < size:
        yield Problem(("diaphragms", "element_max_mm"), "is smaller than element_mm", f">= {size:g}")
    sides = [("frame", 0.25 * min(frame.length_mm, frame.width_mm))] if frame is not None else []
    for ply in plies:
        if ply is not None and (ply.size_mm is None) != (ply.polygon_mm is None):
            sides.append(("smallest ply", 0.5 * float(np.ptp(np.asarray(ply.outline_mm()), axis=0).min())))
    radius = tool.footprint_radius_mm() if tool is not None else None
    if radius is not None:
        sides.append(("tool", radius))
        for place, ply in enumerate(plies):
            if ply is not None and ply.element_mm > radius:
                problem = f"{ply.element_mm:g} is too large for a tool {2 * radius:.4g} mm across"
                yield Problem(("plies", place, "element_mm"), problem, f"<= {radius:.4g}")
    if sides:
        what, largest = min(sides, key=lambda side: side[1])
        if size > largest > 0.0:
            yield Problem(path, f"{size:g} is too large for the {what}", f"<= {largest:.4g}")
