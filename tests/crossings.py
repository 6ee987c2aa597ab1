"""Where sheets cross each other or themselves: exact tests of edges against triangles.

Two triangulated surfaces cross if and only if an edge of one passes through a triangle of the other. Each quadrilateral
is split along one diagonal, the same in all sheets. Independent of the solver: it sees positions only. Pairs that
can meet are found by trees of the triangles' centres, one for each class of sizes. The cells that a ply's outline cuts
stand in frames as a whole: what crosses beyond the outline is no cloth.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

#: sine of the angle below which an edge lies in a triangle's plane and does not pass it (frames hold 32-bit places)
FLATTEST = 1e-6
#: places of the line in which two triangles meet that are looked at for whether they are cloth
SAMPLES = 17


def crossings(points, quads, other=None, other_quads=None, cloth=None, other_cloth=None):
    """Places (k, 3) where edges of a sheet pass through triangles of another or itself; points (n, 3), quads (q, 4).

    cloth: (places of the nodes when flat (n, 2), loops of the outline (k, 2) there) of a sheet that is less than its
    cells, which its outline cuts: only what crosses inside counts; None: all of the cells is there.
    """
    own = other is None
    faces = _triangles(quads)
    other, other_faces = (points, faces) if own else (other, _triangles(other_quads))
    other_cloth = cloth if own else other_cloth
    hits = _hits(points, faces, other, other_faces, own)
    if not len(hits.edge) or (cloth is None and other_cloth is None):
        return hits.place
    back = hits if own else _hits(other, other_faces, points, faces, own)
    return hits.place[_in_cloth(hits, back, faces, other_faces, cloth, other_cloth, own)]


class Hits(NamedTuple):
    """Edges of one sheet (k, 2), the triangles of another that they pass (k,), and where."""

    edge: np.ndarray
    face: np.ndarray
    place: np.ndarray
    along: np.ndarray
    within: np.ndarray


def _hits(points, faces, other, other_faces, own):
    edges = _edges(faces)
    which, face = _near(points[edges], other[other_faces])
    if own:
        apart = (edges[which][:, :, None] != other_faces[face][:, None, :]).all(axis=(1, 2))
        which, face = which[apart], face[apart]
    place, along, within, meets = _through(points[edges[which]], other[other_faces[face]])
    return Hits(edges[which[meets]], face[meets], place, along, within)


def _in_cloth(hits, back, faces, other_faces, cloth, other_cloth, own):
    """Which hits belong to a line, in which two triangles meet, that lies at least in part inside both cloths.

    The line runs between two hits, of an edge of the one or of the other triangle; SAMPLES places of it are looked at.
    """
    ends = {}  # (triangle of the one, triangle of the other): [(place in one's flat state, in the other's, number)]
    for first, (those, one, one_faces, two, two_faces) in enumerate(
        ((hits, cloth, faces, other_cloth, other_faces), (back, other_cloth, other_faces, cloth, faces))
    ):
        around = _faces_of_edges(one_faces)
        for k, (edge, face) in enumerate(zip(those.edge, those.face, strict=True)):
            mine = _flat(one, edge, [1.0 - those.along[k], those.along[k]])
            theirs = _flat(two, two_faces[face], those.within[k])
            for triangle in around[tuple(edge)]:
                swap = first or (own and face < triangle)
                pair, flat = ((face, triangle), (theirs, mine)) if swap else ((triangle, face), (mine, theirs))
                ends.setdefault(pair, []).append((*flat, None if first and not own else k))
        if own:
            break
    real = np.zeros(len(hits.edge), bool)
    steps = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    for found in ends.values():
        (a, b, _), (c, d, _) = found[0], found[-1]
        if (_inside(cloth, a + steps * (c - a)) & _inside(other_cloth, b + steps * (d - b))).any():
            real[[k for *_, k in found if k is not None]] = True
    return real


def _faces_of_edges(faces):
    """{(a, b), a < b: triangles of that edge}."""
    found = {}
    for number, face in enumerate(faces.tolist()):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            found.setdefault((min(face[a], face[b]), max(face[a], face[b])), []).append(number)
    return found


def _flat(cloth, nodes, weights):
    """Place in the flat state."""
    return np.zeros(2) if cloth is None else np.asarray(weights) @ cloth[0][nodes]


def _inside(cloth, places):
    """Which places (k, 2) in the flat state lie inside the outline: an odd number of its lines is to their right."""
    if cloth is None:
        return np.ones(len(places), bool)
    odd = np.zeros(len(places), bool)
    x, y = places[:, 0, None], places[:, 1, None]
    for loop in cloth[1]:
        ax, ay = loop.T
        bx, by = np.roll(loop, -1, axis=0).T
        with np.errstate(divide="ignore", invalid="ignore"):
            odd ^= (((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))).sum(axis=1) % 2 == 1
    return odd


def crossings_of_frame(run, sheets, index=-1):
    """Crossings of each pair of sheets and of each sheet with itself in a frame of a finished run: {(a, b): places}."""
    frames = {name: run.read_frame(name, index) for name in sheets}
    cloths = {name: cloth_of(run, name) for name in sheets}
    found = {}
    for k, a in enumerate(sheets):
        one = (frames[a]["points"], frames[a]["cells"])
        found[a, a] = crossings(*one, cloth=cloths[a])
        for b in sheets[k + 1 :]:
            two = (frames[b]["points"], frames[b]["cells"])
            found[a, b] = np.concatenate(
                [crossings(*one, *two, cloths[a], cloths[b]), crossings(*two, *one, cloths[b], cloths[a])]
            )
    return found


def cloth_of(run, sheet):
    """Nodes when flat and outline of a ply, None of what is no ply."""
    if not (run.path / "profiles" / f"{sheet}.csv").exists():
        return None
    profile = run.profile(sheet)
    outline = np.stack([profile["x0_mm"], profile["y0_mm"]], axis=1)
    return run.read_frame(sheet, 0)["points"][:, :2], [
        outline[profile["loop"] == k] for k in np.unique(profile["loop"])
    ]


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
    """Where segments (k, 2, 3) pass through their triangles (k, 3, 3) (Moeller and Trumbore, 1997), and which do (k,).

    Of those that do: places (m, 3), part of the segment before it (m,), weights of the triangle's corners (m, 3).
    """
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
    weights = np.stack([1.0 - r - t, r, t], axis=1)
    return start[meets] + w[meets, None] * d[meets], w[meets], weights[meets], meets
