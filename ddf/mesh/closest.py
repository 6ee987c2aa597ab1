"""Closest point of a triangle surface, with the normal of the feature it lies on (kernels)."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ddf.mesh.triangles import TriangleMesh, directed_edges

FloatArray = NDArray[np.float64]

FACE, VERTEX, EDGE = 0, 1, 4
"""Feature codes: the face, vertex k as VERTEX + k, edge k (from vertex k to k+1) as EDGE + k."""


@njit(cache=True)
def closest_on_triangle(px, py, pz, corners):
    """Point of a triangle closest to p and the feature it lies on.

    `corners` (3, 3) [mm], one vertex a row. Returns (x, y, z, feature). Ericson, Real-Time Collision
    Detection (2005), section 5.1.5: barycentric regions, here with the feature reported.
    """
    ax, ay, az = corners[0, 0], corners[0, 1], corners[0, 2]
    ux, uy, uz = corners[1, 0] - ax, corners[1, 1] - ay, corners[1, 2] - az
    vx, vy, vz = corners[2, 0] - ax, corners[2, 1] - ay, corners[2, 2] - az
    wx, wy, wz = px - ax, py - ay, pz - az
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    d1, d2 = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    d3, d4, d5, d6 = d1 - uu, d2 - uv, d1 - uv, d2 - vv
    if d1 <= 0.0 and d2 <= 0.0:
        s, t, feature = 0.0, 0.0, 1
    elif d3 >= 0.0 and d4 <= d3:
        s, t, feature = 1.0, 0.0, 2
    elif d6 >= 0.0 and d5 <= d6:
        s, t, feature = 0.0, 1.0, 3
    else:
        va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
        if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
            s, t, feature = d1 / (d1 - d3), 0.0, 4
        elif va <= 0.0 and d4 >= d3 and d5 >= d6:
            t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
            s, feature = 1.0 - t, 5
        elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
            s, t, feature = 0.0, d2 / (d2 - d6), 6
        else:
            total = va + vb + vc
            s, t, feature = vb / total, vc / total, 0
    return ax + s * ux + t * vx, ay + s * uy + t * vy, az + s * uz + t * vz, feature


def pseudo_normals(mesh: TriangleMesh) -> FloatArray:
    """Unit outward normals (q, 7, 3) of each triangle's features: face, three vertices, three edges.

    Vertex normals are weighted by the angle of the face at the vertex, edge normals are the mean of the two
    faces: then the sign of (p - closest).normal says on which side p is, at any feature of a closed surface
    (Baerentzen & Aanaes, IEEE TVCG 11:243, 2005).
    """
    points, triangles = mesh.points, mesh.triangles
    corners = points[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    face = np.cross(sides[:, 0], -sides[:, 2])
    face /= np.linalg.norm(face, axis=1)[:, None]
    sides /= np.linalg.norm(sides, axis=2)[:, :, None]
    angle = np.arccos(np.clip(-np.sum(sides * np.roll(sides, 1, axis=1), axis=2), -1.0, 1.0))
    at_vertex = np.zeros_like(points)
    for k in range(3):
        np.add.at(at_vertex, triangles[:, k], angle[:, k, None] * face)
    edges = directed_edges(triangles)
    key = edges.min(axis=1) * len(points) + edges.max(axis=1)
    _, place = np.unique(key, return_inverse=True)
    at_edge = np.zeros((int(place.max()) + 1, 3))
    np.add.at(at_edge, place.reshape(-1), np.repeat(face, 3, axis=0))
    normals = np.concatenate([face[:, None], at_vertex[triangles], at_edge[place.reshape(-1, 3)]], axis=1)
    length = np.linalg.norm(normals, axis=2)
    return np.where(length[..., None] > 1e-12, normals / np.maximum(length, 1e-12)[..., None], face[:, None])


@njit(cache=True)
def nearest_triangles(corners, faces, order, origin, spacing, band, best, owner):
    """For grid points within `band` [mm] of the surface, the distance and the nearest triangle.

    `corners` (q, 3, 3), `faces` (q, 3) unit normals; `order` (q,) is the order of the scan (random: then few
    candidates improve on the last); `best` (nx, ny, nz) float32 starts at `band`, `owner` int32 at -1. Points
    of a sphere of the triangle's circumscribed radius + band are looked at, and passed over when neither the
    bounding sphere nor the plane of the triangle can be nearer than the best yet.
    """
    nx, ny, nz = best.shape
    for q in order:
        c = corners[q]
        mx = (c[0, 0] + c[1, 0] + c[2, 0]) / 3.0
        my = (c[0, 1] + c[1, 1] + c[2, 1]) / 3.0
        mz = (c[0, 2] + c[1, 2] + c[2, 2]) / 3.0
        radius = 0.0
        for k in range(3):
            r2 = (c[k, 0] - mx) ** 2 + (c[k, 1] - my) ** 2 + (c[k, 2] - mz) ** 2
            radius = max(radius, sqrt(r2))
        n = faces[q]
        reach = radius + band
        for i in range(
            max(0, int(np.ceil((mx - reach - origin[0]) / spacing))),
            min(nx, int(np.floor((mx + reach - origin[0]) / spacing)) + 1),
        ):
            x = origin[0] + i * spacing
            for j in range(
                max(0, int(np.ceil((my - reach - origin[1]) / spacing))),
                min(ny, int(np.floor((my + reach - origin[1]) / spacing)) + 1),
            ):
                y = origin[1] + j * spacing
                left = reach * reach - (x - mx) ** 2 - (y - my) ** 2
                if left <= 0.0:
                    continue
                high = sqrt(left)
                first = max(0, int(np.ceil((mz - high - origin[2]) / spacing)))
                last = min(nz, int(np.floor((mz + high - origin[2]) / spacing)) + 1)
                flat = reach * reach - left
                lean = n[0] * (x - mx) + n[1] * (y - my)
                for k in range(first, last):
                    z = origin[2] + k * spacing
                    limit = best[i, j, k]
                    if abs(lean + n[2] * (z - mz)) >= limit or flat + (z - mz) ** 2 >= (limit + radius) ** 2:
                        continue
                    qx, qy, qz, _ = closest_on_triangle(x, y, z, c)
                    d = sqrt((x - qx) ** 2 + (y - qy) ** 2 + (z - qz) ** 2)
                    if d < limit:
                        best[i, j, k] = d
                        owner[i, j, k] = q


@njit(cache=True)
def signed_distance(x, y, z, corners, normals):
    """Signed distance [mm] of a point from a triangle's surface and its unit gradient.

    `corners` (3, 3), `normals` (7, 3) of `pseudo_normals`. d = +-|p - c|, gradient (p - c)/d; the feature's
    normal where |d| < 1e-6 mm.
    """
    qx, qy, qz, feature = closest_on_triangle(x, y, z, corners)
    dx, dy, dz = x - qx, y - qy, z - qz
    n = normals[feature]
    d = sqrt(dx * dx + dy * dy + dz * dz)
    if dx * n[0] + dy * n[1] + dz * n[2] < 0.0:
        d = -d
    if abs(d) < 1e-6:
        return d, n[0], n[1], n[2]
    return d, dx / d, dy / d, dz / d
