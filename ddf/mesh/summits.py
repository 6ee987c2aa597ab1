"""Sharp vertices of a tool: where its surface turns by a large solid angle within a small distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ddf.mesh.triangles import TriangleMesh

FloatArray = NDArray[np.float64]

SHARP_SR = 1.0
"""Solid angle within the reach from which on a vertex is sharp: the corner of a cube is pi/2 in all."""
LOWEST_MM = 2.0  # over the platform: what stands lower is under the sheet that lies on it
STEEPEST = 0.8
"""Least cosine between a vertex's axis and the vertical. Corners of a box (0.58) hang between edges that the sheet's
other points meet; with a point of their own three random scenes chattered that come to rest without."""


def summits(mesh: TriangleMesh, reach_mm: float) -> tuple[FloatArray, FloatArray]:
    """Places (k, 3) [mm] and outward axes (k, 3) of the vertices sharp to cells that cannot see within `reach_mm`.

    The solid angle at a mesh vertex is what the angles of its triangles lack to 2 pi (Gauss and Bonnet); that of a
    rounded vertex is the sum over its fillet. The place is the highest point along the axis, which is the mean normal.
    """
    points, angles, normals = mesh.points, angle_defects(mesh), _vertex_normals(mesh)
    tree = cKDTree(points)
    left = np.where(points[:, 2] > LOWEST_MM, angles, 0.0)
    curved = np.flatnonzero(left > 1e-6)
    sums = np.zeros(len(points))
    for k in curved:
        sums[k] = left[tree.query_ball_point(points[k], reach_mm)].sum()
    places, axes = [], []
    while sums.max(initial=0.0) > SHARP_SR:
        centre = points[int(np.argmax(sums))]
        near = np.array(tree.query_ball_point(centre, reach_mm))
        axis = (left[near, None] * normals[near]).sum(axis=0)
        axis /= np.linalg.norm(axis)
        if axis[2] > STEEPEST:
            places.append(points[near[np.argmax(points[near] @ axis)]])
            axes.append(axis)
        sums[tree.query_ball_point(centre, 2.0 * reach_mm)] = 0.0
    return np.array(places).reshape(-1, 3), np.array(axes).reshape(-1, 3)


def angle_defects(mesh: TriangleMesh) -> FloatArray:
    """2 pi less the angles around each vertex (k,) [sr]."""
    defects = np.full(len(mesh.points), 2.0 * np.pi)
    corners = mesh.points[mesh.triangles]
    for k in range(3):
        u, v = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1))
        np.subtract.at(defects, mesh.triangles[:, k], angle)
    return defects


def _vertex_normals(mesh: TriangleMesh) -> FloatArray:
    """Outward normals of the vertices (k, 3), by the area of their triangles."""
    corners = mesh.points[mesh.triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(mesh.points)
    for k in range(3):
        np.add.at(normals, mesh.triangles[:, k], area)
    lengths: FloatArray = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return normals / lengths
