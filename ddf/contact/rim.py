"""The rim of a ply: nodes beyond its edges that carry its smooth surface on (`patch.py`).

A patch of 3 x 3 nodes wants neighbours on all sides. Beyond an edge there are none, and a surface that goes on there
from the patch beside it jumps wherever that patch changes, along edges that run across the grid in steps. So two rings
of nodes around a ply lie where those within would go on straight,

    x_g = sum w_gp x_p,  v_g = sum w_gp v_p,  sum w_gp = 1,      (from 2 x_1 - x_2 of neighbours in line)

and what contact puts on them goes to those: f_p += sum w_gp f_g. That is exact: the power of the forces is the same,
and so are their sum and their moment.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.contact.layers import touched
from ddf.jit import FAST
from ddf.model import Model


@njit(**FAST)
def extend(quads, entries, first, end):
    """Put nodes of a rim where they belong: quads (4 N,) of all nodes; entries (RIM) first..end-1, by rim nodes."""
    last = np.int64(-1)
    for e in range(first, end):
        entry = entries[e]
        to, other, weight = 4 * entry.node, 4 * entry.parent, entry.weight
        for c in range(3):
            before = quads[to + c] if entry.node == last else 0.0
            quads[to + c] = before + weight * quads[other + c]
        last = entry.node


@njit(**FAST)
def hand_over(f, normal, share, buffer, span, entries, first, end, node):
    """Add to f (3, n, m) what a buffer (n, m, 4) has for the rim, a share of the last to normal forces (n, m).

    entries (RIM) first..end-1, by parents; span (n, 2): columns touched; node: the sheet's first in the pools.
    """
    cols = f.shape[2]
    for e in range(first, end):
        entry = entries[e]
        g = entry.node - node
        i, j = g // cols, g % cols
        a, b = touched(span, i)
        if a <= j < b:
            p = entry.parent - node
            k, l = p // cols, p % cols
            for c in range(3):
                f[c, k, l] += entry.weight * buffer[i, j, c]
            normal[k, l] += share * entry.weight * buffer[i, j, 3]


@njit(**FAST)
def clear_rim(f, normal, entries, first, end, node):
    """Take what was put on rim nodes off them: f (3, n, m), normal forces (n, m); arguments as in `hand_over`."""
    cols = f.shape[2]
    for e in range(first, end):
        g = entries[e].node - node
        i, j = g // cols, g % cols
        normal[i, j] = 0.0
        for c in range(3):
            f[c, i, j] = 0.0


def sheet_rim(model: Model, k: int) -> np.ndarray:
    """RIM records of sheet k, with numbers in the sheet."""
    s = model.sheets[k]
    first, size = int(s["node"]), int(s["rows"] * s["cols"])
    rim: np.ndarray = model.rim[(model.rim["node"] >= first) & (model.rim["node"] < first + size)].copy()
    rim["node"] -= first
    rim["parent"] -= first
    return rim


def with_rim(x: np.ndarray, rim: np.ndarray) -> np.ndarray:
    """Positions (3, n, m) of a sheet with those of its rim in place."""
    y: np.ndarray = x.reshape(3, -1).copy()
    y[:, rim["node"]] = 0.0
    for c in range(3):
        np.add.at(y[c], rim["node"], rim["weight"] * y[c, rim["parent"]])
    return y.reshape(x.shape)
