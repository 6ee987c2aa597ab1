"""The boundary profile of a formed ply: outline in space, its area and length, and the draw-in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ddf.metrics.surface import Array, PlySurface, at_points


class BoundaryProfile(NamedTuple):
    """The loops of the outline, deformed and initial, points in the order of the outline."""

    deformed: list[Array]  # [mm] (k, 3) each
    initial: list[Array]  # [mm] (k, 3) each


def boundary_profile(surface: PlySurface) -> BoundaryProfile:
    """Positions of the outline's material points by the bilinear map of their cells."""
    loops = [open_loop(loop) for loop in surface.outline]
    return BoundaryProfile(
        deformed=[at_points(surface.x, loop) for loop in loops],
        initial=[at_points(surface.x0, loop) for loop in loops],
    )


def open_loop(loop: Array) -> Array:
    """The loop without a last point that repeats the first."""
    return loop[:-1] if len(loop) > 1 and np.allclose(loop[0], loop[-1]) else loop


def signed_area(loop: Array) -> float:
    """Area of a closed loop in plan, A = 1/2 sum (x_k y_k+1 - x_k+1 y_k) [mm2]; positive anticlockwise."""
    x, y = loop[:, 0], loop[:, 1]
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def outline_area(loops: list[Array]) -> float:
    """Area in plan [mm2]: the largest loop less all others (holes)."""
    areas = sorted((abs(signed_area(loop)) for loop in loops), reverse=True)
    return areas[0] - sum(areas[1:]) if areas else 0.0


def outline_length(loops: list[Array]) -> float:
    """Length of all loops [mm]; in space for (k, 3) points, in plan for (k, 2)."""
    return float(sum(np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1).sum() for p in loops))


def draw_in(surface: PlySurface) -> dict[str, dict[str, float]]:
    """Draw-in [mm] of each mid-side and corner of the outer loop, in plan, positive inward.

    Mid-side: -(x - x0).n with n the side's outward normal in the flat blank; the material point half-way
    along the side. Corner: -(x - x0).r with r the direction from the centre of the blank to the corner.
    Keys are the direction of n or r in degrees, for example "90deg". Empty where there are no corners.
    """
    result: dict[str, dict[str, float]] = {"mid_side": {}, "corner": {}}
    if not surface.outline or not surface.corners:
        return result
    profile = boundary_profile(surface)
    outer = int(np.argmax([abs(signed_area(loop)) for loop in profile.initial]))
    corners = np.unique(np.asarray(surface.corners[outer], dtype=np.int64) % len(profile.initial[outer]))
    if len(corners) < 3:
        return result
    start, end = profile.initial[outer][:, :2], profile.deformed[outer][:, :2]
    polygon = start[corners]
    centre = _centroid(polygon)
    turn = np.sign(signed_area(polygon))
    for k, corner in enumerate(corners):
        _add(result["corner"], start[corner] - centre, start[corner], end[corner])
        side = polygon[(k + 1) % len(corners)] - polygon[k]
        following = int(corners[(k + 1) % len(corners)])
        middle = _half_way(start, int(corner), following)
        normal = turn * np.array([side[1], -side[0]])
        _add(result["mid_side"], normal, _along(start, *middle), _along(end, *middle))
    return result


def _centroid(polygon: Array) -> Array:
    """Centre of area of a polygon (k, 2)."""
    following = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * following[:, 1] - following[:, 0] * polygon[:, 1]
    return np.asarray(((polygon + following) * cross[:, None]).sum(axis=0) / (3 * cross.sum()))


def _half_way(loop: Array, first: int, last: int) -> tuple[NDArray[np.int64], float]:
    """The segment (two point numbers) and the place in it half-way along the loop from first to last."""
    count = len(loop)
    numbers = (first + np.arange((last - first) % count + 1)) % count
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(loop[numbers], axis=0), axis=1))])
    k = int(np.clip(np.searchsorted(length, 0.5 * length[-1]) - 1, 0, len(numbers) - 2))
    share = (0.5 * length[-1] - length[k]) / max(length[k + 1] - length[k], 1e-300)
    return numbers[k : k + 2], float(share)


def _along(loop: Array, segment: NDArray[np.int64], share: float) -> Array:
    return (1 - share) * loop[segment[0]] + share * loop[segment[1]]


def _add(table: dict[str, float], direction: Array, start: Array, end: Array) -> None:
    """Put -(end - start).direction into the table under the direction's angle, made unique."""
    unit = direction / max(float(np.linalg.norm(direction)), 1e-300)
    angle = round(float(np.degrees(np.arctan2(unit[1], unit[0])))) % 360
    key, copy = f"{angle}deg", 1
    while key in table:
        copy += 1
        key = f"{angle}deg_{copy}"
    table[key] = float(-(end - start) @ unit)
