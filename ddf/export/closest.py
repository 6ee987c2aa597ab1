"""The point of tool and platform that is closest to a point of the ply, on the tool's triangles themselves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ddf.mesh.closest import pseudo_normals, signed_distance
from ddf.mesh.triangles import TriangleMesh

Array = NDArray[np.float64]


class Closest(NamedTuple):
    """Closest points of the surface, with its normal there."""

    point: Array  # (k, 3) [mm]
    normal: Array  # (k, 3) unit, outward
    distance: Array  # (k,) [mm], negative inside
    on_tool: NDArray[np.bool_]  # (k,); else on the platform


def closest_on_tool(tool: TriangleMesh | None, points: Array) -> Closest:
    """For points (k, 3) in the tool's frame [mm]; without a tool the platform z = 0 alone."""
    down = points * [1.0, 1.0, 0.0]
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    platform = Closest(down, up, points[:, 2].copy(), np.zeros(len(points), bool))
    if tool is None:
        return platform
    corners, normals = np.ascontiguousarray(tool.points[tool.triangles]), pseudo_normals(tool)
    owner = nearest_triangles(tool.points, tool.triangles, points)
    found = np.array(
        [signed_distance(p[0], p[1], p[2], corners[q], normals[q]) for p, q in zip(points, owner, strict=True)]
    )
    distance, gradient = found[:, 0], found[:, 1:]
    on_tool = distance <= points[:, 2]
    choose = on_tool[:, None]
    return Closest(
        np.where(choose, points - distance[:, None] * gradient, down), np.where(choose, gradient, up),
        np.where(on_tool, distance, points[:, 2]), on_tool,
    )  # fmt: skip


def nearest_triangles(vertices: Array, triangles: NDArray[np.int64], points: Array) -> NDArray[np.int64]:
    """Number of the triangle (q, 3) nearest to each point (k, 3), by VTK's cell tree."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import reference, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator

    nodes, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    nodes.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, dtype=np.float64), deep=True))
    starts = np.arange(0, triangles.size + 1, 3, dtype=np.int64)
    corners = np.ascontiguousarray(triangles.ravel(), dtype=np.int64)
    cells.SetData(numpy_to_vtkIdTypeArray(starts, deep=True), numpy_to_vtkIdTypeArray(corners, deep=True))
    surface.SetPoints(nodes)
    surface.SetPolys(cells)
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    owner = np.empty(len(points), np.int64)
    place, cell, sub, square = [0.0, 0.0, 0.0], reference(0), reference(0), reference(0.0)
    for k, point in enumerate(points.tolist()):
        locator.FindClosestPoint(point, place, cell, sub, square)  # type: ignore[call-overload]
        owner[k] = int(cell)
    return owner
