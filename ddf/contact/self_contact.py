"""Self-contact of folding sheets: what a node of a sheet may touch.

The forces are those of `contact.layers`: a sheet has two pairs in which it is slave and master, for nodes above
(sign +1) and below (-1) the part that they meet, at the sheet's own thickness. That is enough for all folds: where a
face carries other layers these lie between, and hold their own thickness by their own self-contact and by their contact
with this sheet. `contact.self_search` finds, once a batch of steps, which nodes are near another part and where; a node
is followed by at most one place on each side.

Struts (`elements.fold`) keep a fold's radius above r, more than half the contact distance: points less than a half
turn, pi r, apart along the sheet cannot touch, and around it they are 2 r apart. So places nearer than pi r along the
sheet, or two cells, are not taken; a place that touches may come half as near, before which it has opened.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ddf.contact.layers import UNKNOWN
from ddf.jit import FAST, INLINE
from ddf.model import DIAPHRAGM

CELLS = 2.0
"""Least way along the sheet in cells: a node is no part of the surface that it touches."""


@njit(**INLINE)
def apart(sheet, lines, i, j, u, v):
    """Way along the reference sheet from node (i, j) to a place, in the cell sizes there [mm], and in cells."""
    if sheet.kind == DIAPHRAGM:
        a = lines[sheet.line + min(i, sheet.rows - 2)]
        b = lines[sheet.line + sheet.rows - 1 + min(j, sheet.cols - 2)]
    else:
        a, b = sheet.a1, sheet.a2
    p, q = u - i, v - j
    return np.sqrt(p * p * a * a + q * q * b * b), max(abs(p), abs(q))


@njit(**INLINE)
def far(sheet, lines, i, j, u, v, share):
    """Whether a place lies beyond `share` of what the struts take care of."""
    way, cells = apart(sheet, lines, i, j, u, v)
    return way >= share * math.pi * sheet.fold_radius and cells >= share * CELLS


@njit(**FAST)
def drop_near(sheet, lines, place, slip, rest, low, high):
    """No longer follow nodes of rows low..high-1 whose places have come too near to them along the sheet."""
    for i in range(low, high):
        for j in range(sheet.cols):
            if rest[i, j] == 0:
                share = 1.0 if place[2, i, j] >= 0.0 else 0.5
                if not far(sheet, lines, i, j, place[0, i, j], place[1, i, j], share):
                    rest[i, j] = -1
                    place[2, i, j] = UNKNOWN
                    slip[0, i, j] = slip[1, i, j] = 0.0
