"""What each node, bar and cell of a model carries: masses, areas, widths."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.build.rim import ply_cover, rim_nodes
from ddf.build.stack import Stack
from ddf.contact.patch import patch_centres
from ddf.elements.bending import tangent_weights
from ddf.mesh.ply import PlyMesh
from ddf.model import DIAPHRAGM

FloatArray = NDArray[np.float64]

LEAST_NODE = 0.25
"""Least share of a cell whose mass a node of a ply carries. A cut leaves slivers, and a sheet that lies on one
pushes its nodes with far more than the sliver's own stiffness: at their own mass they were shot away."""


def node_pools(stack: Stack, sheets: np.ndarray, masses: list[float], rims: list[np.ndarray]) -> dict[str, Any]:
    """Node pools of the model: masses, areas, bars, cells, triples; rims: RIM records of each sheet."""
    names = ("mass", "inverse_mass", "area", "inverse_area", "bar1", "bar2", "cell", "triple1", "triple2", "cover")
    parts: dict[str, list[FloatArray]] = {name: [] for name in names}
    centres, weights = [], []
    for k, s in enumerate(sheets):
        n, m = int(s["rows"]), int(s["cols"])
        zero = np.zeros((n, m))
        values = dict.fromkeys(names, zero)
        if s["kind"] != DIAPHRAGM:
            ply = stack.plies[k - 1]
            values |= _lattice(ply)
            values["cover"] = ply_cover(ply)
            held, exists = np.zeros((n, m), bool), ply.active | rim_nodes(rims[k], (n, m))
        else:
            dx, dy = np.diff(stack.diaphragm.x_lines), np.diff(stack.diaphragm.y_lines)
            cells = dx[:, None] * dy[None, :]
            values["area"], values["cell"] = corner_sum(cells), np.pad(cells, ((0, 1), (0, 1)))
            values["cover"] = np.ones((n, m))
            held, exists = np.ones((n, m), bool), np.ones((n, m), bool)
            held[1:-1, 1:-1] = False
        area = values["area"]
        # of what presses on nodes in the frame it takes its part, as cells beyond them would
        taken = corner_sum(np.ones((n - 1, m - 1))) if s["kind"] == DIAPHRAGM else 1.0
        values["inverse_area"] = np.where(area > 0.0, taken / np.where(area > 0.0, area, 1.0), 0.0)
        if s["kind"] != DIAPHRAGM:
            area = np.where(area > 0.0, np.maximum(area, LEAST_NODE * s["a1"] * s["a2"]), 0.0)
        mass = masses[k] * area
        values["mass"] = np.where(held, 0.0, mass)
        values["inverse_mass"] = np.where(held | (mass <= 0), 0.0, 1.0 / np.where(mass > 0, mass, 1.0))
        for name in names:
            parts[name].append(values[name].ravel())
        centres.append(patch_centres(exists).ravel())
        weights.append(tangent_weights(values["bar1"], values["bar2"]).ravel())
    pools: dict[str, Any] = {name: np.ascontiguousarray(np.concatenate(part)) for name, part in parts.items()}
    pools["centre"] = np.concatenate(centres)
    pools["weight"] = np.concatenate(weights)
    return pools


def _lattice(ply: PlyMesh) -> dict[str, FloatArray]:
    """Areas of a ply's nodes and cells, widths of its bars, areas of its bending triples; all (n, m)."""
    a1, a2 = ply.spacing
    share = ply.cell_fraction
    p = np.pad(share, 1)
    bar1 = np.pad(0.5 * a2 * (p[1:-1, 1:] + p[1:-1, :-1]), ((0, 1), (0, 0)))
    bar2 = np.pad(0.5 * a1 * (p[1:, 1:-1] + p[:-1, 1:-1]), ((0, 0), (0, 1)))
    triple1, triple2 = np.zeros_like(bar1), np.zeros_like(bar2)
    triple1[1:] = a1 * np.minimum(bar1[1:], bar1[:-1])
    triple2[:, 1:] = a2 * np.minimum(bar2[:, 1:], bar2[:, :-1])
    return {
        "area": a1 * a2 * corner_sum(share), "cell": a1 * a2 * np.pad(share, ((0, 1), (0, 1))),
        "bar1": bar1, "bar2": bar2, "triple1": triple1, "triple2": triple2,
    }  # fmt: skip


def corner_sum(cells: FloatArray) -> FloatArray:
    """Quarter of the cells around each node, (n, m) from (n-1, m-1)."""
    p = np.pad(cells, 1)
    return 0.25 * (p[1:, 1:] + p[:-1, 1:] + p[1:, :-1] + p[:-1, :-1])
