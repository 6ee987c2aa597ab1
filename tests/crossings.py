"""Where sheets cross each other or themselves: exact tests of edges against triangles.

Two triangulated surfaces cross if and only if an edge of one passes through a triangle of the other. Each quadrilateral
is split along one diagonal, the same in all sheets. Independent of the solver: it sees positions only. Pairs that
can meet are found by trees of the triangles' centres, one for each class of sizes.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

#: sine of the angle below which an edge lies in a triangle's plane and does not pass it (frames hold 32-bit places)
FLATTEST = 1e-6


def crossings(points, quads, other=None, other_quads=None):
    """Places (k, 3) where edges of a sheet pass through triangles of another or itself; points (n, 3), quads (q, 4)."""
    own = other is None
    faces = _triangles(quads)
    other, other_faces = (points, faces) if own else (other, _triangles(other_quads))
    edges = _edges(faces)
    which, face = _near(points[edges], other[other_faces])
    if own:
        apart = (edges[which][:, :, None] != other_faces[face][:, None, :]).all(axis=(1, 2))
        which, face = which[apart], face[apart]
    return _through(points[edges[which]], other[other_faces[face]])


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


def _edges(faces):
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _near(segments, corners):
    """Numbers of all segments (k, 2, 3) and triangles (q, 3, 3) whose boxes meet."""
    middle, half = segments.mean(axis=1), 0.5 * np.linalg.norm(np.diff(segments, axis=1)[:, 0], axis=1)
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    boxes = (segments.min(axis=1), segments.max(axis=1)), (corners.min(axis=1), corners.max(axis=1))
    found = [np.zeros((2, 0), int)]
    for some in _by_size(half):
        tree = cKDTree(middle[some])
        for others in _by_size(radius):
            reach = half[some].max() + radius[others].max() + 1e-9
            near = tree.sparse_distance_matrix(cKDTree(centre[others]), reach, output_type="ndarray")
            i, j = some[near["i"]], others[near["j"]]
            meet = np.ones(i.size, bool)
            for axis in range(3):
                meet &= boxes[0][0][i, axis] <= boxes[1][1][j, axis]
                meet &= boxes[1][0][j, axis] <= boxes[0][1][i, axis]
            found.append(np.array([i[meet], j[meet]]))
    which, face = np.concatenate(found, axis=1)
    order = np.lexsort((face, which))
    return which[order], face[order]


def _by_size(sizes):
    """Numbers of the items of each class of sizes, a factor of two wide."""
    classes = np.ceil(np.log2(np.maximum(sizes, 1e-9))).astype(int)
    return [np.flatnonzero(classes == k) for k in np.unique(classes)]


def _through(segments, corners):
    """Places where segments (k, 2, 3) pass through their triangles (k, 3, 3) (Moeller and Trumbore, 1997)."""
    start, d = segments[:, 0], segments[:, 1] - segments[:, 0]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    h = np.cross(d, v)
    det = (u * h).sum(axis=1)
    s = start - corners[:, 0]
    q = np.cross(s, u)
    size = np.linalg.norm(d, axis=1) * np.linalg.norm(np.cross(u, v), axis=1)
    along = np.where(np.abs(det) < FLATTEST * size, np.inf, det)
    r, t, w = ((a * b).sum(axis=1) / along for a, b in ((s, h), (d, q), (v, q)))
    meets = np.isfinite(along) & (r >= 0.0) & (t >= 0.0) & (r + t <= 1.0) & (w >= 0.0) & (w <= 1.0)
    return start[meets] + w[meets, None] * d[meets]
