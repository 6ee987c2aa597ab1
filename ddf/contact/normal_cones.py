"""Where a sheet can touch itself: nowhere that its normals stay within a narrow cone.

A part of a sheet whose normals all lie within an angle c of one direction is the graph of a height over the plane
normal to it: two of its points that are s apart along the sheet are at least s cos(c) apart in space. Only parts with
a wider cone have to be searched (P. Volino, N. Magnenat Thalmann, Efficient self-collision detection on smoothly
discretized surface animations using geometrical shape regularity, Computer Graphics Forum 13 (1994) C155; cones from
X. Provot, Collision and self-collision handling in cloth model dedicated to design garments, 1997). As there, the
outline is taken to be without overlap: lips of a slit that slide over each other flat are not found.

The sheet's cells are put into tiles of TILE x TILE, four tiles into one of the next level, up to one for all. A level
is (rows, columns, first tile) in `levels`; cones (tiles, 4): axis and half angle [rad], -1 without cells; boxes
(tiles, 6): least and greatest x, y, z of the cells' nodes [mm]. `walk` goes down from the whole sheet: a tile with
itself and with others, as long as cones are wide and boxes near.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ddf.jit import FAST, INLINE

TILE = 4
FAR = 1e30
STACK = 512
"""Pairs of tiles that can wait: at most 15 a level, for 30 levels."""


def tile_levels(rows: int, cols: int) -> NDArray[np.int64]:
    """The levels (k, 3) over a sheet of rows x cols nodes, finest first."""
    n, m = math.ceil((rows - 1) / TILE), math.ceil((cols - 1) / TILE)
    levels = [(n, m, 0)]
    while n * m > 1:
        first = levels[-1][2] + n * m
        n, m = (n + 1) // 2, (m + 1) // 2
        levels.append((n, m, first))
    return np.array(levels, np.int64)


def tile_count(levels: NDArray[np.int64]) -> int:
    """Tiles of all levels."""
    return int(levels[-1, 2] + levels[-1, 0] * levels[-1, 1])


@njit(**FAST)
def _vector_row(x0, y0, z0, x1, y1, z1, ax, ay, az):
    """Area vectors of a row of cells [mm2]: half the cross product of their diagonals."""
    for j in range(x0.shape[0] - 1):
        px, py, pz = x1[j + 1] - x0[j], y1[j + 1] - y0[j], z1[j + 1] - z0[j]
        qx, qy, qz = x0[j + 1] - x1[j], y0[j + 1] - y1[j], z0[j + 1] - z1[j]
        ax[j] = 0.5 * (py * qz - pz * qy)
        ay[j] = 0.5 * (pz * qx - px * qz)
        az[j] = 0.5 * (px * qy - py * qx)


@njit(**FAST)
def _tile_cone(vectors, cell, i0, i1, j0, j1, cone):
    """Cone of the cells of rows i0..i1-1, columns j0..j1-1 that exist."""
    sx = sy = sz = 0.0
    some = False
    for i in range(i0, i1):
        for j in range(j0, j1):
            if cell[i, j] > 0.0:
                some = True
                sx, sy, sz = sx + vectors[0, i, j], sy + vectors[1, i, j], sz + vectors[2, i, j]
    if not some:
        cone[3] = -1.0
        return
    inverse = 1.0 / np.sqrt(sx * sx + sy * sy + sz * sz + 1e-300)
    sx, sy, sz = inverse * sx, inverse * sy, inverse * sz
    least = 1.0  # signed square of the least cosine
    for i in range(i0, i1):
        for j in range(j0, j1):
            if cell[i, j] > 0.0:
                ax, ay, az = vectors[0, i, j], vectors[1, i, j], vectors[2, i, j]
                c = sx * ax + sy * ay + sz * az
                least = min(least, c * abs(c) / (ax * ax + ay * ay + az * az + 1e-300))
    cone[0], cone[1], cone[2] = sx, sy, sz
    cone[3] = math.acos(np.sqrt(least)) if least > 0.0 else math.pi


@njit(**FAST)
def _angle(a, b):
    """Angle between the axes of two cones [rad]."""
    return math.acos(min(1.0, max(-1.0, a[0] * b[0] + a[1] * b[1] + a[2] * b[2])))


@njit(**FAST)
def _merge(cones, levels, k):
    """Cones of level k from those of the level below."""
    for p in range(levels[k, 0]):
        for q in range(levels[k, 1]):
            cone = cones[levels[k, 2] + p * levels[k, 1] + q]
            cone[:] = 0.0
            cone[3] = -1.0
            for half in range(2):  # the axis, then the angle
                for a in range(2 * p, min(2 * p + 2, levels[k - 1, 0])):
                    for b in range(2 * q, min(2 * q + 2, levels[k - 1, 1])):
                        child = cones[levels[k - 1, 2] + a * levels[k - 1, 1] + b]
                        if child[3] < 0.0:
                            continue
                        if half == 0:
                            for c in range(3):
                                cone[c] += child[c]
                        else:
                            cone[3] = max(cone[3], min(math.pi, _angle(cone, child) + child[3]))
                inverse = 1.0 / np.sqrt(cone[0] ** 2 + cone[1] ** 2 + cone[2] ** 2 + 1e-300)
                for c in range(3):
                    cone[c] *= inverse


@njit(**FAST)
def find_cones(x, cell, levels, vectors, cones):
    """Cones of all tiles; returns the half angle of the whole sheet's [rad].

    x (3, n, m), cell (n, m) areas, vectors (3, n, m) scratch.
    """
    n, m = x.shape[1] - 1, x.shape[2] - 1
    for i in range(n):
        _vector_row(
            x[0, i], x[1, i], x[2, i], x[0, i + 1], x[1, i + 1], x[2, i + 1],
            vectors[0, i], vectors[1, i], vectors[2, i],
        )  # fmt: skip
    for p in range(levels[0, 0]):
        for q in range(levels[0, 1]):
            i, j = TILE * p, TILE * q
            _tile_cone(vectors, cell, i, min(i + TILE, n), j, min(j + TILE, m), cones[p * levels[0, 1] + q])
    for k in range(1, levels.shape[0]):
        _merge(cones, levels, k)
    return cones[levels[-1, 2], 3]


@njit(**FAST)
def find_boxes(x, cell, levels, boxes):
    """Boxes of all tiles."""
    n, m = x.shape[1] - 1, x.shape[2] - 1
    boxes[:, 0::2] = FAR
    boxes[:, 1::2] = -FAR
    for i in range(n):
        for j in range(m):
            if cell[i, j] > 0.0:
                box = boxes[i // TILE * levels[0, 1] + j // TILE]
                for c in range(3):
                    a, b, d, e = x[c, i, j], x[c, i + 1, j], x[c, i, j + 1], x[c, i + 1, j + 1]
                    box[2 * c] = min(box[2 * c], min(min(a, b), min(d, e)))
                    box[2 * c + 1] = max(box[2 * c + 1], max(max(a, b), max(d, e)))
    for k in range(1, levels.shape[0]):
        for a in range(levels[k - 1, 0]):
            for b in range(levels[k - 1, 1]):
                child = boxes[levels[k - 1, 2] + a * levels[k - 1, 1] + b]
                box = boxes[levels[k, 2] + a // 2 * levels[k, 1] + b // 2]
                for c in range(3):
                    box[2 * c] = min(box[2 * c], child[2 * c])
                    box[2 * c + 1] = max(box[2 * c + 1], child[2 * c + 1])


@njit(**FAST)
def _near(a, b, reach):
    """Whether two boxes come within a distance [mm] along every axis."""
    return (
        a[0] <= b[1] + reach and b[0] <= a[1] + reach
        and a[2] <= b[3] + reach and b[2] <= a[3] + reach
        and a[4] <= b[5] + reach and b[4] <= a[5] + reach
    )  # fmt: skip


@njit(**FAST)
def _together(a, b):
    """Half angle of the cone about the mean axis that holds two cones."""
    return 0.5 * _angle(a, b) + max(a[3], b[3])


@njit(**FAST)
def walk(levels, cones, boxes, widest, reach, stack, top):
    """Go on from the `top` pairs on the stack to the next pair of finest tiles that may touch.

    Returns how many pairs are left on the stack; the pair found, (0, row, column, row, column), stands above them. -1:
    there is none any more. Start with `begin`. widest: half angle [rad] up to which neighbours cannot touch; reach
    [mm]: distance up to which others can.
    """
    while top > 0:
        top -= 1
        k, p, q, r, s = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3], stack[top, 4]
        first, cols = levels[k, 2], levels[k, 1]
        a, b = first + p * cols + q, first + r * cols + s
        if cones[a, 3] < 0.0 or cones[b, 3] < 0.0:
            continue
        if abs(p - r) <= 1 and abs(q - s) <= 1 and _together(cones[a], cones[b]) <= widest:
            continue
        if not _near(boxes[a], boxes[b], reach):
            continue
        if k == 0:
            return top
        top = _split(levels[k - 1, 0], levels[k - 1, 1], k, p, q, r, s, stack, top)
    return -1


@njit(**INLINE)
def _put(stack, top, k, a, b, c, d):
    """Write a row of the stack number by number (numba compiles seconds of messages for a row at once)."""
    stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3], stack[top, 4] = k, a, b, c, d


@njit(**FAST)
def _split(rows, cols, k, p, q, r, s, stack, top):
    """Put the pairs of the four children of two tiles, or of one with itself, on the stack."""
    same = p == r and q == s
    for g in range(4):
        a, b = 2 * p + g // 2, 2 * q + g % 2
        for h in range(g if same else 0, 4):
            c, d = 2 * r + h // 2, 2 * s + h % 2
            if a < rows and b < cols and c < rows and d < cols:
                _put(stack, top, k - 1, a, b, c, d)
                top += 1
    return top


@njit(**FAST)
def begin(levels, stack):
    """Put the whole sheet with itself on the stack (STACK, 5); returns 1, for `walk`."""
    _put(stack, 0, levels.shape[0] - 1, 0, 0, 0, 0)
    return 1
