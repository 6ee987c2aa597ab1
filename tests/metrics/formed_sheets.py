"""Synthetic formed sheets whose wrinkles, gaps and outlines are known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ddf.metrics import PlySurface

FWHM = 2 * np.sqrt(2 * np.log(2))  # full width at half height of a Gaussian, in standard deviations


def grid(size_mm: float = 200.0, spacing_mm: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """Material coordinates (n, n) [mm] of a square blank centred on the axis."""
    count = round(size_mm / spacing_mm) + 1
    line = (np.arange(count) - 0.5 * (count - 1)) * spacing_mm
    return np.meshgrid(line, line, indexing="ij")


def sheet(
    x: np.ndarray,
    distance: Callable | None = None,
    spacing_mm: float = 2.0,
    offset_mm: float = 0.0,
    **changes,
) -> PlySurface:
    """A whole square ply at positions x (3, n, m)."""
    n, m = x.shape[1:]
    u, v = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    x0 = np.stack([(u - 0.5 * (n - 1)) * spacing_mm, (v - 0.5 * (m - 1)) * spacing_mm, 0.0 * u])
    values = {
        "name": "ply",
        "x": np.asarray(x, float),
        "x0": x0,
        "spacing": (spacing_mm, spacing_mm),
        "active": np.ones((n, m), bool),
        "cell_fraction": np.ones((n - 1, m - 1)),
        "outline": [square_outline(n, m)],
        "corners": [np.arange(4) * 20],
        "offset_mm": offset_mm,
        "distance": distance,
    }
    return PlySurface(**{**values, **changes})


def square_outline(n: int, m: int) -> np.ndarray:
    """The grid's border, 20 points a side, anticlockwise from (0, 0); corners at points 0, 20, 40, 60."""
    t = np.arange(20) / 20
    u = np.concatenate([t, 1 + 0 * t, 1 - t, 0 * t]) * (n - 1)
    v = np.concatenate([0 * t, t, 1 + 0 * t, 1 - t]) * (m - 1)
    return np.stack([u, v], axis=1)


def plane_distance(points: np.ndarray) -> np.ndarray:
    """Distance to the platform z = 0."""
    return points[:, 2].copy()


def cone_distance(height: float, slope: float) -> Callable:
    """Exact distance to the cone z = height - r tan(slope), from outside."""

    def distance(points: np.ndarray) -> np.ndarray:
        r, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2] - height
        side = z * np.cos(slope) + r * np.sin(slope)
        beyond = r * np.cos(slope) - z * np.sin(slope) < 0  # nearest to the apex
        return np.where(beyond, np.hypot(r, z), side)

    return distance


def on_cone(u: np.ndarray, v: np.ndarray, h: np.ndarray, height: float, slope: float) -> np.ndarray:
    """Points at distance h from the cone over plan positions (u, v) of their foot, (3, n, m)."""
    r = np.maximum(np.hypot(u, v), 1e-9)
    foot = np.stack([u, v, height - r * np.tan(slope)])
    normal = np.stack([u / r * np.sin(slope), v / r * np.sin(slope), np.cos(slope) + 0 * u])
    return foot + h * normal


def taper(s: np.ndarray, length: float, ends: float) -> np.ndarray:
    """1 along the middle of a ridge of whole `length`, cos^2 to 0 over `ends` at both ends."""
    inner = np.clip((0.5 * length - np.abs(s)) / ends, 0, 1)
    return np.sin(0.5 * np.pi * inner) ** 2


def taper_length(length: float, ends: float, share: float) -> float:
    """Length of the part of a tapered ridge that is higher than `share` of its height."""
    return length - 2 * ends * 2 / np.pi * np.arcsin(np.sqrt(share))


def ridge(
    u: np.ndarray,
    v: np.ndarray,
    *,
    amplitude: float,
    sigma: float,
    angle_deg: float = 0.0,
    length: float = 1e6,
    ends: float = 20.0,
    centre: tuple[float, float] = (0.0, 0.0),
) -> np.ndarray:
    """Height of a Gaussian ridge along a line at an angle to the first family."""
    angle = np.radians(angle_deg)
    along = (u - centre[0]) * np.cos(angle) + (v - centre[1]) * np.sin(angle)
    across = -(u - centre[0]) * np.sin(angle) + (v - centre[1]) * np.cos(angle)
    return amplitude * np.exp(-0.5 * (across / sigma) ** 2) * taper(along, length, ends)


def omega(amplitude: float, neck: float, step: float = 0.01) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Arc length, lateral place and height of an overhanging fold: two feet, two flanks leaning out, a loop.

    Made of arcs of constant curvature, so inextensible; scaled to the amplitude; symmetric about 0. `neck` is
    the angle [rad] by which each flank leans over beyond upright.
    """
    lean = 0.5 * np.pi + neck
    s = np.arange(0, lean + step, step)  # foot: radius 1, turns up by `lean`
    turn = np.concatenate([s, np.linspace(lean, -lean, round(2 * lean * 1.5 / step) + 1)[1:], -s[::-1][1:]])
    turn = np.minimum(np.maximum(turn, -lean), lean)
    ds = np.full(len(turn) - 1, step)
    middle = 0.5 * (turn[1:] + turn[:-1])
    arc = np.concatenate([[0], np.cumsum(ds)])
    y = np.concatenate([[0], np.cumsum(np.cos(middle) * ds)])
    z = np.concatenate([[0], np.cumsum(np.sin(middle) * ds)])
    scale = amplitude / z.max()
    return scale * (arc - 0.5 * arc[-1]), scale * (y - 0.5 * y[-1]), scale * z


def folded(u: np.ndarray, v: np.ndarray, profile: tuple, angle_deg: float = 0.0) -> np.ndarray:
    """A flat sheet with an inextensible fold (arc, place, height) along a line at an angle to family 1."""
    arc, y, z = profile
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    along, across = u * c + v * s, -u * s + v * c
    place = np.interp(across, arc, y) + np.maximum(across - arc[-1], 0) + np.minimum(across - arc[0], 0)
    return np.stack([along * c - place * s, along * s + place * c, np.interp(across, arc, z)])


def bend(u: np.ndarray, v: np.ndarray, h: np.ndarray, slope: float, radius: float, flat_to: float = 0.0) -> np.ndarray:
    """A sheet with one cylindrical bend across the first direction, and points at height h over it.

    Level to u = flat_to, then an arc of `radius` through `slope` (up if positive), then straight.
    """
    turn = np.sign(slope) * np.clip((u - flat_to) / radius, 0, abs(slope))
    on_arc = radius * np.sin(np.abs(turn))
    rest = np.maximum(u - flat_to - radius * abs(slope), 0)
    x = np.minimum(u, flat_to) + on_arc + rest * np.cos(slope)
    z = np.sign(slope) * radius * (1 - np.cos(turn)) + rest * np.sin(slope)
    return np.stack([x - h * np.sin(turn), v, z + h * np.cos(turn)])


def corner_distance(slope: float, radius: float, flat_to: float = 0.0) -> Callable:
    """Distance to the hollow corner of platform and wall that `bend` (slope > 0) spans with its arc."""
    corner = flat_to + radius * np.tan(0.5 * slope)

    def distance(points: np.ndarray) -> np.ndarray:
        wall = points[:, 2] * np.cos(slope) - (points[:, 0] - corner) * np.sin(slope)
        return np.minimum(points[:, 2], wall)

    return distance


def edge_distance(slope: float, radius: float, flat_to: float = 0.0) -> Callable:
    """Exact distance to the rounded convex edge on which `bend` (slope < 0) lies, from outside."""
    slope = abs(slope)

    def distance(points: np.ndarray) -> np.ndarray:
        x, z = points[:, 0] - flat_to, points[:, 2] + radius
        on_arc = np.hypot(x, z) - radius
        falling = x * np.sin(slope) + z * np.cos(slope) - radius
        beyond = np.arctan2(x, z)
        return np.where(beyond < 0, points[:, 2], np.where(beyond > slope, falling, on_arc))

    return distance
