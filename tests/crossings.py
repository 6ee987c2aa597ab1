"""Where sheets cross each other or themselves: exact tests of edges against triangles, by VTK's cell locator.

Two triangulated surfaces cross if and only if an edge of one passes through a triangle of the other. Each quadrilateral
is split along one diagonal, the same in all sheets. Independent of the solver: it sees positions only.
"""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator


def crossings(points, quads, other=None, other_quads=None):
    """Places (k, 3) where edges of a sheet pass through triangles of another or itself; points (n, 3), quads (q, 4)."""
    own = other is None
    faces = _triangles(quads)
    other, other_faces = (points, faces) if own else (other, _triangles(other_quads))
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


def crossings_of_frame(run, sheets, index=-1):
    """Crossings of each pair of sheets and of each sheet with itself in a frame of a finished run: {(a, b): places}."""
    frames = {name: run.read_frame(name, index) for name in sheets}
    found = {}
    for k, a in enumerate(sheets):
        found[a, a] = crossings(frames[a]["points"], frames[a]["cells"])
        for b in sheets[k + 1 :]:
            one = (frames[a]["points"], frames[a]["cells"])
            two = (frames[b]["points"], frames[b]["cells"])
            found[a, b] = np.concatenate([crossings(*one, *two), crossings(*two, *one)])
    return found


def _triangles(quads):
    """Node triples (2 q, 3) of quadrilaterals (q, 4), split along one diagonal."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


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
