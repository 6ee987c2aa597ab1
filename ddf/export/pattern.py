"""The flat pattern of a ply: what to cut from the flat fabric so that the formed ply ends at a trim line.

A trim line seen from above (x, y) is a knife that comes down on the formed ply: of every layer under it, as in a
fold that hangs over, what lies inside stays. With p(u, v) the place in plan of the material point (u, v) and d the
signed distance from the trim line, the pattern is the region d(p(u, v)) < 0 and its edge the line d(p(u, v)) = 0: it is
one-valued where the inverse of p is not, and maps on the trim line exactly, fold or no fold.

A trim line in space (x, y, z) is mapped point by point to the nearest point of the ply's mid-surface, for walls that
a view from above does not show. Across a fold it goes straight from foot to foot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddf.errors import UsageError
from ddf.export.closest import nearest_triangles
from ddf.export.loops import chained, closed, dense, parallel_line, signed_distance, simplified, zero_lines
from ddf.export.part import FormedPart, FormedPly
from ddf.mesh.closest import closest_on_triangle
from ddf.mesh.outline import signed_area
from ddf.mesh.triangles import TriangleMesh
from ddf.metrics import PlySurface
from ddf.metrics.surface import at_points, fill_inactive, inside_outline
from ddf.output.figures import view_box
from ddf.output.plots import base_segments
from ddf.output.raster import view_from_above

Array = NDArray[np.float64]

CHORD_MM = 0.02  # largest distance of the pattern's chords from the line they stand for
SMALLEST_MM2 = 1.0  # loops smaller than this are left out
REACH_MM = 30.0  # a trim line in space may be this far from the ply
COVER_PIXELS = 1600


@dataclass(frozen=True)
class FlatPattern:
    """The pattern of one ply. Flat coordinates are those of the case's frame: the ply as it is laid."""

    ply: FormedPly
    trim: Array  # (k, 2) or (k, 3) [mm] in the tool's frame
    grid: list[Array]  # closed lines (k, 2) in grid coordinates (u, v), the outer one first
    flat: list[Array]  # the same, [mm]
    error_mm: float  # largest distance of the pattern, formed, from the trim line
    notes: list[str]

    @property
    def area_mm2(self) -> float:
        """Area of fabric inside the pattern's outer line."""
        return abs(signed_area(self.flat[0]))


def foot_line(tool: TriangleMesh | None, distance_mm: float) -> Array:
    """The line (k, 2) at a distance outside the tool's foot, in the tool's frame. Raises UsageError without a tool."""
    loops = [] if tool is None else chained(base_segments(tool))
    if not loops:
        raise UsageError("the run has no tool with a foot", "give a trim line with --trim FILE")
    foot = max(loops, key=lambda loop: abs(signed_area(loop)))
    return simplified(foot, 0.01) if distance_mm == 0.0 else parallel_line(foot, distance_mm)


def flat_patterns(part: FormedPart, trim: Array) -> list[FlatPattern]:
    """The pattern of every ply for one trim line. Raises UsageError where a ply does not reach it."""
    return [flat_pattern(ply, trim) for ply in part.plies]


def flat_pattern(ply: FormedPly, trim: Array) -> FlatPattern:
    """Map a closed trim line (k, 2) or (k, 3) [mm], in the tool's frame, to the flat ply."""
    surface = ply.surface
    if not surface.outline:
        raise UsageError(f"{surface.name} has no outline", "the ply must be formed to its edge")
    if trim.shape[1] == 2:
        grid, notes = _knife(surface, trim)
        formed = np.concatenate([formed_points(surface, loop) for loop in grid])
        error = float(np.abs(signed_distance(formed[:, :2], trim)).max())
    else:
        loop, error = _nearest(surface, dense(trim, min(surface.spacing)))
        grid, notes = [loop], [f"nearest points of the mid-surface, up to {error:.2f} mm from the trim line"]
    flat = [flat_points(surface, loop) for loop in grid]
    return FlatPattern(ply, trim, grid, flat, error, notes)


def formed_points(surface: PlySurface, grid: Array) -> Array:
    """Where material points (k, 2) are on the formed ply, (k, 3) [mm]."""
    return at_points(fill_inactive(surface.x, surface.active), grid)


def flat_points(surface: PlySurface, grid: Array) -> Array:
    """Where material points (k, 2) are on the flat ply, (k, 2) [mm]: its lattice is affine, also beyond its edge."""
    i, j = np.nonzero(surface.active)
    design = np.stack([np.ones(len(i)), i, j], axis=1)
    solution = np.linalg.lstsq(design, surface.x0[:2, i, j].T, rcond=None)[0]
    return np.asarray(solution[0] + grid @ solution[1:])


def _knife(surface: PlySurface, trim: Array) -> tuple[list[Array], list[str]]:
    """Lines of d(p(u, v)) = 0, the largest first, and what is to be said about them."""
    _refuse_uncovered(surface, trim)
    nodes = np.full(surface.shape, np.nan)
    nodes[surface.active] = signed_distance(surface.x[:2, surface.active].T, trim)
    loops, dropped = [], 0
    for line in zero_lines(nodes):
        if not closed(line):
            _refuse_edge(surface, line)
        loop = _on_the_line(surface, trim, line[:-1], np.roll(line[:-1], -1, axis=0) - np.roll(line[:-1], 1, axis=0))
        loop = _with_middles(surface, trim, loop)
        if abs(signed_area(loop * surface.spacing)) < SMALLEST_MM2:
            dropped += 1
            continue
        if not inside_outline(surface, loop).all():
            _refuse_edge(surface, loop[~inside_outline(surface, loop)])
        loops.append(loop)
    if not loops:
        raise UsageError(f"the trim line meets {surface.name} nowhere", "is it in mm, and in the tool's frame?")
    loops.sort(key=lambda loop: -abs(signed_area(loop * surface.spacing)))
    notes = []
    if len(loops) > 1:
        notes.append(f"a fold hangs over the trim line: {len(loops) - 1} more closed lines inside or beside the outer")
    if dropped:
        notes.append(f"{dropped} closed lines under {SMALLEST_MM2:g} mm2 left out")
    return loops, notes


def _on_the_line(surface: PlySurface, trim: Array, points: Array, along: Array) -> Array:
    """Points (k, 2) moved square to `along`, by up to half an element, to where d = 0; as they are where it is not."""
    x = fill_inactive(surface.x[:2], surface.active)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across *= 0.5 / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]

    def value(t: Array) -> Array:
        return signed_distance(at_points(x, points + t[:, None] * across), trim)

    low, high = np.full(len(points), -1.0), np.full(len(points), 1.0)
    at_low, at_high = value(low), value(high)
    bracketed = (at_low > 0) != (at_high > 0)
    for _ in range(22):
        t = 0.5 * (low + high)
        same = (value(t) > 0) == (at_low > 0)
        low, high = np.where(same, t, low), np.where(same, high, t)
    return points + np.where(bracketed, 0.5 * (low + high), 0.0)[:, None] * across


def _with_middles(surface: PlySurface, trim: Array, loop: Array) -> Array:
    """The closed line with points put in until its chords are true to CHORD_MM, where an element is not too small."""
    for _ in range(6):
        chord = np.roll(loop, -1, axis=0) - loop
        middle = loop + 0.5 * chord
        moved = _on_the_line(surface, trim, middle, chord)
        wanted = np.linalg.norm((moved - middle) * surface.spacing, axis=1) > CHORD_MM
        wanted &= np.linalg.norm(moved - middle, axis=1) < 0.51 * np.linalg.norm(chord, axis=1)
        if not wanted.any():
            break
        loop = np.insert(loop, np.flatnonzero(wanted) + 1, moved[wanted], axis=0)
    return loop


def _refuse_uncovered(surface: PlySurface, trim: Array) -> None:
    """Raise UsageError, with places, where no part of the ply lies under the trim line."""
    samples = dense(trim, 0.5)
    box = view_box(np.concatenate([samples.T, surface.x[:2, surface.active]], axis=1), 1.0)
    x = fill_inactive(surface.x, surface.active)
    view = view_from_above(x, surface.cell_fraction > 0, box, COVER_PIXELS, surface)
    col, row = ((samples - [box[0], box[2]]) / view.pixel_mm).astype(int).T
    missed = ~view.covered[row, col]
    if missed.any():
        starts = samples[missed & ~np.roll(missed, 1)] if not missed.all() else samples[:1]
        places = ", ".join(f"({x:.0f}, {y:.0f})" for x, y in starts[:6]) + (" ..." if len(starts) > 6 else "")
        raise UsageError(
            f"{surface.name} does not cover the trim line: {100 * missed.mean():.1f} % of it lies off the ply, "
            f"from {places} mm on",
            "a larger blank, or a trim line farther in; x and y in the tool's frame",
        )


def _refuse_edge(surface: PlySurface, grid: Array) -> None:
    x, y, z = formed_points(surface, grid[:1])[0]
    raise UsageError(
        f"{surface.name}: a fold, hole or slit brings its edge under the trim line at ({x:.0f}, {y:.0f}, {z:.0f}) mm",
        "move the trim line there",
    )


def _nearest(surface: PlySurface, trim: Array) -> tuple[Array, float]:
    """Grid coordinates (k, 2) of the mid-surface's points nearest to points (k, 3), and the largest distance."""
    n, m = surface.shape
    i, j = np.nonzero(surface.cell_fraction > 0)
    a, b, c, d = i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    vertices = fill_inactive(surface.x, surface.active).reshape(3, -1).T
    corners = triangles[nearest_triangles(vertices, triangles, trim)]
    weights = np.array([_weights(p, vertices[q]) for p, q in zip(trim, corners, strict=True)])
    distance = np.linalg.norm((weights[..., None] * vertices[corners]).sum(axis=1) - trim, axis=1)
    place = np.stack([corners // m, corners % m], axis=-1)
    grid = np.asarray((weights[..., None] * place).sum(axis=1))
    depth = np.stack([signed_distance(grid * surface.spacing, loop * surface.spacing) for loop in surface.outline])
    off = (depth[0] > -1e-3) | (depth[1:] < 1e-3).any(axis=0) | (distance > REACH_MM)
    if off.any():
        x, y, z = trim[off][0]
        raise UsageError(
            f"{surface.name} does not reach the trim line at ({x:.0f}, {y:.0f}, {z:.0f}) mm: "
            f"{100 * off.mean():.1f} % of it lies beyond its edge or over {REACH_MM:g} mm away",
            "x, y, z in mm in the tool's frame, z = 0 the platform",
        )
    return grid, float(distance.max())


def _weights(p: Array, corners: Array) -> Array:
    """Barycentric weights (3,) of the point of a triangle (3, 3) closest to p."""
    q = np.array(closest_on_triangle(p[0], p[1], p[2], corners)[:3])
    solution = np.linalg.lstsq((corners[1:] - corners[0]).T, q - corners[0], rcond=None)[0]
    return np.array([1.0 - solution.sum(), *solution])
