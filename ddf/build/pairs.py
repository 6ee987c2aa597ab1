"""Which sheet's nodes meet which sheet, and with what law."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ddf.build.blocks import block_rows
from ddf.build.stack import Stack
from ddf.build.step import own_contact, pair_damping
from ddf.case import Case
from ddf.contact.layers import UNKNOWN
from ddf.mesh.diaphragm import DiaphragmMesh
from ddf.mesh.ply import PlyMesh
from ddf.model import PAIR

FloatArray = NDArray[np.float64]

COVER_MARGIN_MM = 30.0  # nodes nearer than this to the edge of a ply between two sheets are followed


def contact_pairs(case: Case, stack: Stack, masses: list[float], sheets: np.ndarray):
    """PAIR records, which slave nodes each follows, and their first places on the masters."""
    top = len(stack.plies) + 1
    friction = case.friction
    wanted = []
    for k in range(1, top):
        wanted += [(k, 0, 1.0, friction.ply_diaphragm), (k, top, -1.0, friction.ply_diaphragm)]
        wanted += [(k, j, math.copysign(1.0, k - j), friction.ply_ply) for j in range(1, top) if j != k]
    # each diaphragm against the other at half stiffness: one way only, small errors in how a graded grid
    # passes on a pressure push the whole stack to one side
    wanted += [(top, 0, 1.0, friction.diaphragm_diaphragm), (0, top, -1.0, friction.diaphragm_diaphragm)]
    if case.solver.self_contact:
        own = [friction.diaphragm_diaphragm, *[friction.ply_ply] * len(stack.plies), friction.diaphragm_diaphragm]
        wanted += [(k, k, sign, mu) for k, mu in enumerate(own) for sign in (1.0, -1.0)]
    records, exposed, places = [], [], []
    first = buffer = span = 0
    for slave, master, sign, mu in wanted:
        follow, place = _follow(stack, slave, master)
        if slave != master and not follow.any():
            continue
        offset = 0.5 * (stack.thickness[slave] + stack.thickness[master])
        damping = pair_damping(case, masses, slave, master)
        stiffness = case.solver.contact_stiffness_N_mm3
        if slave == master and slave in (0, top):
            stiffness, damping = own_contact(case, masses[slave])
        if (slave in (0, top)) == (master in (0, top)):  # each is slave of the other as well
            stiffness, damping = 0.5 * stiffness, 0.5 * damping
        reduced = masses[slave] * masses[master] / (masses[slave] + masses[master])
        records.append((slave, master, first, buffer, span, sign, offset, mu, stiffness, damping, reduced))
        exposed.append(follow.ravel())
        places.append(first_places(place))
        n, m = int(sheets[master]["rows"]), int(sheets[master]["cols"])
        rows = int(sheets[slave]["rows"])
        blocks = math.ceil(rows / block_rows(rows))
        first += follow.size
        buffer += 4 * n * m * blocks
        span += n * blocks
    return np.array(records, dtype=PAIR), np.concatenate(exposed), np.concatenate(places)


def _follow(stack: Stack, slave: int, master: int) -> tuple[NDArray[np.bool_], FloatArray]:
    """Slave nodes that can meet the master, (n, m), and their places (2, n, m) on its grid; of itself, none yet."""
    top = len(stack.plies) + 1
    mesh = stack.diaphragm if slave in (0, top) else stack.plies[slave - 1]
    points = mesh.x[:2]
    if slave == master:
        return np.zeros(points.shape[1:], bool), np.zeros(points.shape)
    follow = np.ones(points.shape[1:], bool) if isinstance(mesh, DiaphragmMesh) else mesh.active.copy()
    for between in range(min(slave, master) + 1, max(slave, master)):
        follow &= _depth_inside(stack.plies[between - 1], points) < COVER_MARGIN_MM
    if master in (0, top):
        lines = (stack.diaphragm.x_lines, stack.diaphragm.y_lines)
        place = np.array([np.interp(p, line, np.arange(line.size)) for p, line in zip(points, lines, strict=True)])
    else:
        place = np.array(_lattice_place(stack.plies[master - 1], points))
    return follow, place


def _depth_inside(ply: PlyMesh, points: FloatArray) -> FloatArray:
    """How deep points (2, ...) lie inside a ply's fabric [mm]; 0 outside."""
    inner = distance_transform_edt(np.pad(ply.cell_fraction > 0, 1), sampling=ply.spacing)[1:-1, 1:-1]
    u, v = _lattice_place(ply, points)
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    n, m = inner.shape
    inside = (i >= 0) & (j >= 0) & (i < n) & (j < m)
    return np.where(inside, inner[np.clip(i, 0, n - 1), np.clip(j, 0, m - 1)], 0.0)


def _lattice_place(ply: PlyMesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Grid coordinates of points (2, ...) in the flat ply."""
    origin = ply.x[:2, 0, 0]
    a, b = ply.x[:2, 1, 0] - origin, ply.x[:2, 0, 1] - origin
    r = points - origin.reshape(2, *([1] * (points.ndim - 1)))
    return np.tensordot(a, r, 1) / (a @ a), np.tensordot(b, r, 1) / (b @ b)


def first_places(place: FloatArray) -> FloatArray:
    """A pair's entries in the state's `place` before the first step, from grid coordinates (2, n, m) on the master."""
    unknown, zeros = np.full((1, *place.shape[1:]), UNKNOWN), np.zeros((2, *place.shape[1:]))
    return np.concatenate([place, unknown, zeros]).ravel()
