"""Exact signed distances of the rounded primitives, in the tool frame, to check fields against.

Like the meshes every solid goes on downward without end. A rounded solid is the sharp one with its faces
moved inward by r, and the distance from that less r.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.errors import MeshError
from ddf.mesh.solids import BASE_ANGLES_DEG, RADIUS_OVER_HEIGHT, Dimensions

FloatArray = NDArray[np.float64]


def tetrahedron_distance(points: FloatArray, height: float, fillet: float, slope: float) -> FloatArray:
    """Distance (k,) [mm] of points (k, 3) from a rounded three-sided pyramid with its apex on the z axis.

    `slope` is the circumradius of the base over `height`. A face's outward normal is (h e, R/2)/|.|, e
    towards the middle of its side; the apex of the faces moved in by r is r |.|/(R/2) lower. Outside, the
    nearest of the feet on faces, ridges and apex that belong to the pyramid; inside, the nearest face.
    """
    angles = np.deg2rad(np.array(BASE_ANGLES_DEG) + 180.0)
    up = slope / 2.0
    normals = np.stack([np.cos(angles), np.sin(angles), np.full(3, up)], axis=1) / np.hypot(1.0, up)
    apex = np.array([0.0, 0.0, height - fillet / normals[0, 2]])
    p = np.asarray(points, dtype=np.float64) - apex
    s = p @ normals.T
    best = np.linalg.norm(p, axis=1)
    base = np.deg2rad(np.array(BASE_ANGLES_DEG))
    ridges = np.stack([slope * np.cos(base), slope * np.sin(base), -np.ones(3)], axis=1)
    ridges /= np.linalg.norm(ridges, axis=1)[:, None]
    for ridge in ridges:
        t = np.maximum(p @ ridge, 0.0)
        best = np.minimum(best, np.linalg.norm(p - t[:, None] * ridge, axis=1))
    for k in range(3):
        foot = p - s[:, k, None] * normals[k]
        on_face = (np.delete(foot @ normals.T, k, axis=1) <= 1e-9).all(axis=1)
        best = np.where(on_face, np.minimum(best, np.abs(s[:, k])), best)
    return np.where((s <= 0.0).all(axis=1), s.max(axis=1), best) - fillet


def hemisphere_distance(points: FloatArray, radius: float) -> FloatArray:
    """Distance (k,) [mm] of points (k, 3) from a half sphere about the origin on a cylinder below it."""
    x, y, z = np.asarray(points, dtype=np.float64).T
    return np.sqrt(x**2 + y**2 + np.maximum(z, 0.0) ** 2) - radius


def box_distance(points: FloatArray, size: tuple[float, float, float], fillet: float) -> FloatArray:
    """Distance (k,) [mm] of points (k, 3) from a box of length, width, height with rounded edges.

    With q = (|x| - (l/2 - r), |y| - (w/2 - r), z - (h - r)): d = |max(q, 0)| + min(max q, 0) - r.
    """
    length, width, height = size
    x, y, z = np.asarray(points, dtype=np.float64).T
    q = np.stack([np.abs(x) - length / 2, np.abs(y) - width / 2, z - height], axis=1) + fillet
    return _rounded(q, fillet)


def cylinder_distance(points: FloatArray, radius: float, height: float, fillet: float) -> FloatArray:
    """Distance (k,) [mm] of points (k, 3) from an upright cylinder with a rounded top edge."""
    x, y, z = np.asarray(points, dtype=np.float64).T
    return _rounded(np.stack([np.hypot(x, y) - radius, z - height], axis=1) + fillet, fillet)


def _rounded(q: FloatArray, fillet: float) -> FloatArray:
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0) - fillet


def primitive_distance(shape: str, points: FloatArray, size: Dimensions) -> FloatArray:
    """Distance (k,) [mm] of points (k, 3) from a primitive of `build_tool`; MeshError if it is not one."""
    if shape in RADIUS_OVER_HEIGHT:
        return tetrahedron_distance(points, size.height_mm, size.fillet_mm, RADIUS_OVER_HEIGHT[shape])
    if shape == "hemisphere":
        return hemisphere_distance(points, size.radius_mm)
    if shape == "box":
        return box_distance(points, (size.length_mm, size.width_mm, size.height_mm), size.fillet_mm)
    if shape == "cylinder":
        return cylinder_distance(points, size.radius_mm, size.height_mm, size.fillet_mm)
    raise MeshError(f"no exact distance is known for the tool shape {shape!r}")
