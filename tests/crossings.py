"""Where sheets cross each other or themselves: exact tests of edges against triangles, by VTK's cell locator.

Two triangulated surfaces cross if and only if an edge of one passes through a triangle of the other. Each quadrilateral
is split along one diagonal, the same in all sheets. Independent of the solver: it sees positions only.
"""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator

from ddf.model import sheet_scalars, sheet_vectors


def crossings(a, exists_a, b=None, exists_b=None):
    """Places (k, 3) where edges of sheet a (3, n, m) pass through triangles of b, or of a itself; cells (n-1, m-1)."""
    own = b is None
    points, faces = a.reshape(3, -1).T, _triangles(exists_a)
    other, other_faces = (points, faces) if own else (b.reshape(3, -1).T, _triangles(exists_b))
    locator, keep = _locator(other, other_faces)
    hits, found = vtkIdList(), []
    for p, q in _edges(faces):
        start, end = points[p], points[q]
        locator.FindCellsAlongLine(start, end, 0.0, hits)
        for k in range(hits.GetNumberOfIds()):
            face = other_faces[hits.GetId(k)]
            if own and (p in face or q in face):
                continue
            place = _through(start, end, *other[face])
            if place is not None:
                found.append(place)
    del keep
    return np.array(found).reshape(-1, 3)


def crossings_of_scene(scene):
    """Number of crossings of each pair of sheets, and of each sheet with itself, by the sheets' names."""
    model, count = scene.model, {}
    sheets = [
        (info.name, sheet_vectors(model, scene.state.x, k), sheet_scalars(model, model.cell, k)[:-1, :-1] > 0.0)
        for k, info in enumerate(scene.sheets)
    ]
    for k, (name, x, exists) in enumerate(sheets):
        count[name, name] = len(crossings(x, exists))
        for other, y, there in sheets[k + 1 :]:
            count[name, other] = len(crossings(x, exists, y, there)) + len(crossings(y, there, x, exists))
    return count


def _triangles(exists):
    """Node triples (k, 3) of a grid's cells (n-1, m-1) that exist."""
    n, m = exists.shape[0] + 1, exists.shape[1] + 1
    number = np.arange(n * m).reshape(n, m)
    a, b, c, d = (number[i : n - 1 + i, j : m - 1 + j][exists] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _locator(points, faces):
    cells, grid, where = vtkCellArray(), vtkPolyData(), vtkPoints()
    flat = np.column_stack([np.full(len(faces), 3), faces]).ravel().astype(np.int64)
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(flat, deep=True))
    where.SetDataTypeToDouble()
    where.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    grid.SetPoints(where)
    grid.SetPolys(cells)
    locator = vtkStaticCellLocator()
    locator.SetDataSet(grid)
    locator.BuildLocator()
    return locator, grid


def _edges(faces):
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _through(start, end, a, b, c):
    """Where a segment passes through a triangle (Moeller and Trumbore, 1997), else None."""
    d, u, v = end - start, b - a, c - a
    h = np.cross(d, v)
    det = u @ h
    if abs(det) < 1e-14:
        return None
    s = start - a
    q = np.cross(s, u)
    r, t, w = s @ h / det, d @ q / det, v @ q / det
    if r < 0.0 or t < 0.0 or r + t > 1.0 or w < 0.0 or w > 1.0:
        return None
    return start + w * d
