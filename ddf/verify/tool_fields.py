"""Distance fields of simple tools, from their exact distances."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ddf.mesh.distance import DistanceField
from ddf.verify.problem import FloatArray

Distance = Callable[[FloatArray], tuple[FloatArray, FloatArray]]  # points (3, ...) -> d (...), gradient (3, ...)


def gridded(distance: Distance, low: tuple[float, ...], high: tuple[float, ...], spacing: float) -> DistanceField:
    """The distance on a grid between two corners [mm]."""
    axes = [np.arange(round((b - a) / spacing) + 1) * spacing + a for a, b in zip(low, high, strict=True)]
    d, gradient = distance(np.array(np.meshgrid(*axes, indexing="ij")))
    values = np.ascontiguousarray(np.stack([d, *gradient], axis=-1).astype(np.float32))
    return DistanceField(values, np.array(low), spacing)


def plane(degrees: float, height: float) -> Distance:
    """A plane through (0, 0, height) that falls towards +x."""
    t = np.deg2rad(degrees)
    normal = np.array([np.sin(t), 0.0, np.cos(t)])

    def distance(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        d = np.tensordot(normal, points, 1) - normal[2] * height
        return d, np.broadcast_to(normal.reshape(3, *([1] * d.ndim)), points.shape)

    return distance


def cylinder(radius: float, height: float) -> Distance:
    """A round bar along y with its axis at the height."""

    def distance(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, z = points[0], points[2] - height
        r = np.maximum(np.hypot(x, z), 1e-9)
        return r - radius, np.array([x / r, np.zeros_like(r), z / r])

    return distance


def sphere(radius: float, height: float) -> Distance:
    """A ball about (0, 0, height)."""

    def distance(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        away = points - np.array([0.0, 0.0, height]).reshape(3, *([1] * (points.ndim - 1)))
        r = np.maximum(np.sqrt((away * away).sum(axis=0)), 1e-9)
        return r - radius, away / r

    return distance
