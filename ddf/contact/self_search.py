"""The search for self-contact: nodes of a sheet that are near another part of it, and their places there.

Once a batch of steps, parts of the sheet are taken in pairs from `contact.normal_cones`; for every node of one the node
of the other that is nearest, then the closest point on the surface by Newton's method. Every node nearer than the
contact distance and the way that sheets can go in the batch gets a place; one that touches keeps its own. All of it
follows from the state, so that a run that is resumed finds the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numba import njit

from ddf.contact.friction import length
from ddf.contact.layers import UNKNOWN, pack_rows
from ddf.contact.normal_cones import STACK, TILE, begin, find_boxes, find_cones, tile_count, tile_levels, walk
from ddf.contact.patch import interpolate
from ddf.contact.rim import extend, sheet_rim
from ddf.contact.self_contact import far
from ddf.jit import FAST
from ddf.model import Model, State, sheet_scalars, sheet_vectors
from ddf.quad import part

WIDEST = math.radians(60.0)
"""Half angle of normals up to which a part of a sheet is not searched: its points are then at least pi r/2 apart."""

LEAST = 0.5
"""A place not yet followed has to be this share of the contact distance away: of nearer ones the side is not known."""

NEWTON = 6
LACK = 0.3  # [cells] largest last step of a projection that has converged


@njit(**FAST)
def foot(y, centre, x, y0, z, u, v):
    """Closest point of the surface to (x, y0, z) near (u, v): its place, the height above it, the last step [cells].

    y: packed nodes (4 n m,); centre (n, m, 2) from `patch_centres`. The step is that of `contact.layers`.
    """
    n, m = centre.shape[0], centre.shape[1]
    d, lack = 0.0, UNKNOWN
    for _ in range(NEWTON):
        i = min(max(int(u + 0.5), 0), n - 1)
        j = min(max(int(v + 0.5), 0), m - 1)
        p, q = np.int64(centre[i, j, 0]), np.int64(centre[i, j, 1])
        if p < 0:
            return u, v, d, UNKNOWN
        first = np.uint64(4 * ((p - 1) * m + q - 1))
        s, su, sv, suu, svv = interpolate(y, first, np.uint64(4 * m), u - p, v - q)
        ux, uy, uz, vx, vy, vz = part(su, 0), part(su, 1), part(su, 2), part(sv, 0), part(sv, 1), part(sv, 2)
        rx, ry, rz = x - part(s, 0), y0 - part(s, 1), z - part(s, 2)
        guu, gvv, guv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
        scale = 1.0 / np.sqrt(max(guu * gvv - guv * guv, 1e-30))
        nx, ny, nz = (uy * vz - uz * vy) * scale, (uz * vx - ux * vz) * scale, (ux * vy - uy * vx) * scale
        d = rx * nx + ry * ny + rz * nz
        guu += abs(d * (nx * part(suu, 0) + ny * part(suu, 1) + nz * part(suu, 2)))
        gvv += abs(d * (nx * part(svv, 0) + ny * part(svv, 1) + nz * part(svv, 2)))
        ru, rv = rx * ux + ry * uy + rz * uz, rx * vx + ry * vy + rz * vz
        inverse = 1.0 / (guu * gvv - guv * guv + 1e-30)
        du = min(max((gvv * ru - guv * rv) * inverse, -0.5), 0.5)
        dv = min(max((guu * rv - guv * ru) * inverse, -0.5), 0.5)
        u, v = u + du, v + dv
        lack = max(abs(du), abs(dv))
    return u, v, d, lack


@njit(**FAST)
def forget(place, rest):
    """Follow only nodes that touch. place (5, n, m), rest (n, m)."""
    for i in range(rest.shape[0]):
        for j in range(rest.shape[1]):
            if place[2, i, j] < 0.0:
                rest[i, j] = 0
            else:
                rest[i, j] = -1
                place[2, i, j] = UNKNOWN


@njit(**FAST)
def followed(rest):
    """Whether any node is."""
    most = np.int8(-1)
    for i in range(rest.shape[0]):
        for j in range(rest.shape[1]):
            most = max(most, rest[i, j])
    return most >= 0


@njit(**FAST)
def _longest_bar(x, i, j):
    """Largest distance of a node to its neighbours along the grid [mm]."""
    longest = 0.0
    for k in range(4):
        p = min(max(i + (k == 0) - (k == 1), 0), x.shape[1] - 1)
        q = min(max(j + (k == 2) - (k == 3), 0), x.shape[2] - 1)
        longest = max(longest, length(x[0, p, q] - x[0, i, j], x[1, p, q] - x[1, i, j], x[2, p, q] - x[2, i, j]))
    return longest


@njit(**FAST)
def _nearest(sheet, lines, x, area, tile, i, j, reach):
    """Node of a tile that is nearest to node (i, j) and far along the sheet; (-1, -1) if its cells are out of reach."""
    best, p, q = UNKNOWN, -1, -1
    px, py, pz = x[0, i, j], x[1, i, j], x[2, i, j]
    for k in range(TILE * tile[0], min(TILE * tile[0] + TILE + 1, sheet.rows)):
        for l in range(TILE * tile[1], min(TILE * tile[1] + TILE + 1, sheet.cols)):
            dx, dy, dz = x[0, k, l] - px, x[1, k, l] - py, x[2, k, l] - pz
            square = dx * dx + dy * dy + dz * dz
            if square < best and area[k, l] > 0.0 and far(sheet, lines, i, j, np.float64(k), np.float64(l), 0.75):
                best, p, q = square, k, l
    if p >= 0 and np.sqrt(best) > reach + _longest_bar(x, p, q):
        return -1, -1
    return p, q


@njit(**FAST)
def _outside(box, x, i, j, reach):
    """Whether a node is farther than `reach` from a box."""
    most = -UNKNOWN
    for c in range(3):
        most = max(most, max(box[2 * c] - x[c, i, j], x[c, i, j] - box[2 * c + 1]))
    return most > reach


@njit(**FAST)
def _follow(sheet, lines, grid, tile, i, j, offset, reach, above, below):
    """Follow node (i, j) on a tile if it is near and closer than where it is followed so far."""
    x, y, cell, area, centre = grid
    k, l = _nearest(sheet, lines, x, area, tile, i, j, reach)
    if k < 0:
        return
    u, v, d, step = foot(y, centre, x[0, i, j], x[1, i, j], x[2, i, j], np.float64(k), np.float64(l))
    if not (step < LACK and u >= 0.0 and v >= 0.0 and u < sheet.rows - 1.0 and v < sheet.cols - 1.0):
        return
    k, l = min(max(int(u), 0), sheet.rows - 2), min(max(int(v), 0), sheet.cols - 2)
    if abs(d) > reach or abs(d) < LEAST * offset or cell[k, l] == 0.0:
        return
    if not far(sheet, lines, i, j, u, v, 1.0):
        return
    (place, rest), other = (above, below[0]) if d > 0.0 else (below, above[0])
    if other[2, i, j] < 0.0 and not far(sheet, lines, k, l, other[0, i, j], other[1, i, j], 1.0):
        return  # it touches there from the other side, and has been pressed through
    gap = max(0.0, abs(d) - offset)
    if place[2, i, j] >= 0.0 and gap < place[2, i, j]:
        place[0, i, j], place[1, i, j], place[2, i, j] = u, v, gap
        place[3, i, j] = place[4, i, j] = 0.0
        rest[i, j] = 0


@njit(**FAST)
def _follow_tile(sheet, lines, grid, tile, other, box, offset, reach, above, below):
    """Follow the nodes of a tile on another, which lies in a box."""
    x, area = grid[0], grid[3]
    for i in range(TILE * tile[0], min(TILE * tile[0] + TILE + 1, sheet.rows)):
        for j in range(TILE * tile[1], min(TILE * tile[1] + TILE + 1, sheet.cols)):
            if area[i, j] > 0.0 and not _outside(box, x, i, j, reach):
                _follow(sheet, lines, grid, other, i, j, offset, reach, above, below)


@njit(**FAST)
def seek(sheet, lines, x, cover, packed, rim, cell, area, centre, offset, skin, above, below, tiles):
    """Find the places of a sheet's nodes on itself; returns whether any are followed above, and below.

    x (3, n, m), cover (n, m), packed (n, m, 4), written if anything is searched; rim: RIM of the sheet; offset:
    distance at which the sheet touches itself; skin: way that its parts can approach each other before the next search
    [mm]; above, below: place (5, n, m) and rest (n, m) of the pairs of sign +1, -1; tiles: levels, vectors, cones,
    boxes, stack of `contact.normal_cones`.
    """
    levels, vectors, cones, boxes, stack = tiles
    forget(*above)
    forget(*below)
    if find_cones(x, cell, levels, vectors, cones) > WIDEST:
        reach = offset + min(skin, math.pi * sheet.fold_radius)
        find_boxes(x, cell, levels, boxes)
        pack_rows(x, cover, packed, 0, sheet.rows)
        y = packed.reshape(packed.size)
        extend(y, rim, 0, rim.shape[0])
        grid = (x, y, cell, area, centre)
        top = walk(levels, cones, boxes, WIDEST, reach, stack, begin(levels, stack))
        while top >= 0:
            one, two = stack[top, 1:3], stack[top, 3:5]
            box = boxes[two[0] * levels[0, 1] + two[1]]
            _follow_tile(sheet, lines, grid, one, two, box, offset, reach, above, below)
            if one[0] != two[0] or one[1] != two[1]:
                box = boxes[one[0] * levels[0, 1] + one[1]]
                _follow_tile(sheet, lines, grid, two, one, box, offset, reach, above, below)
            top = walk(levels, cones, boxes, WIDEST, reach, stack, top)
    return followed(above[1]), followed(below[1])


class SelfContact:
    """The search of all sheets that have pairs of self-contact, with its scratch memory."""

    def __init__(self, model: Model, state: State, packed: np.ndarray, rest: np.ndarray, idle: np.ndarray) -> None:
        self._idle = idle
        self._searches: list[tuple[list[int], list[Any], list[Any]]] = []
        own = model.pairs["slave"] == model.pairs["master"]
        for k in np.unique(model.pairs["slave"][own]):
            sheet = model.sheets[k]
            n, m, node = int(sheet["rows"]), int(sheet["cols"]), int(sheet["node"])
            size, pairs, sides = n * m, [], []
            for sign in (1.0, -1.0):
                number = int(np.flatnonzero(own & (model.pairs["slave"] == k) & (model.pairs["sign"] == sign))[0])
                first = int(model.pairs["first"][number])
                pairs.append(number)
                place = state.place[5 * first : 5 * (first + size)].reshape(5, n, m)
                sides.append((place, rest[first : first + size].reshape(n, m)))
            levels = tile_levels(n, m)
            count = tile_count(levels)
            tiles = (
                levels, np.zeros((3, n, m)), np.zeros((count, 4)), np.zeros((count, 6)), np.zeros((STACK, 5), np.int64)
            )  # fmt: skip
            cover, cell, area = (sheet_scalars(model, pool, k) for pool in (model.cover, model.cell, model.area))
            quads = packed[4 * node : 4 * (node + size)].reshape(n, m, 4)
            centre = model.centre[2 * node : 2 * (node + size)].reshape(n, m, 2)
            x, rim = sheet_vectors(model, state.x, k), sheet_rim(model, k)
            fields = [sheet, model.lines, x, cover, quads, rim, cell, area, centre]
            self._searches.append((pairs, [*fields, float(model.pairs["offset"][pairs[0]])], [*sides, tiles]))

    def seek(self, skin: float, each: Callable[[list[Callable[[], Any]]], list[Any]]) -> None:
        """Find the places of all nodes near another part of their sheet; skin: see the function `seek` [mm].

        each: calls functions, one a sheet, and returns what they return.
        """
        found = each([partial(seek, *fields, skin, *rest) for _, fields, rest in self._searches])
        for (pairs, _, _), any_node in zip(self._searches, found, strict=True):
            self._idle[pairs] = [not node for node in any_node]
