"""What the cells of the shell-membrane formulation store, from their stresses.

A rate law has no stored energy of its own. Taken as stored is what unloading at the present shear gives back:
J A s^2/(2 E h) of tensions and J A m^2/(2 D) of moments; of shear A W(sin g), g accumulated. The work of the stresses
(in the ledger) less this is what the law and the fibres' damping kept for good, or gave: stretching, shearing,
unstretching and unshearing a cell is a closed way on which the work is not zero (J changes with the shear between).
"""

from __future__ import annotations

import numpy as np

from ddf.elements.shear import table_energy
from ddf.elements.shell_membrane import history as h


def stored_energies(history: np.ndarray, cell: np.ndarray, table: np.ndarray, sheet: np.void) -> dict[str, float]:
    """Energies [N mm] of tension, shear and bending; history (HISTORY, n, m), cell (n, m), shear table (K, 5)."""
    area = cell * np.sqrt(np.maximum(history[h.M_C11] * history[h.M_C22] - history[h.M_C12] ** 2, h.SMALLEST))
    tension = bending = 0.0
    for family, force, push, moment in (
        (1, h.M_TENSION1, h.S_TENSION1, h.S_MOMENT1),
        (2, h.M_TENSION2, h.S_TENSION2, h.S_MOMENT2),
    ):
        rigidity = float(sheet[f"bend{family}"])
        tension += float(np.sum(area * history[force] ** 2)) / (2.0 * float(sheet[f"eh{family}"]))
        if rigidity > 0.0:
            flexural = 12.0 * rigidity / float(sheet["thickness"]) ** 2
            tension += float(np.sum(area * history[push] ** 2)) / (2.0 * flexural)
            bending += float(np.sum(area * history[moment] ** 2)) / (2.0 * rigidity)
    angle = history[h.M_E1] + history[h.M_E2]
    return {"fibre_tension": tension, "shear": table_energy(np.sin(angle), cell, table), "bending": bending}


def elastic_energies(x: np.ndarray, director: np.ndarray, cell: np.ndarray, sheet: np.void) -> dict[str, float]:
    """Energies [N mm] of transverse shear and of both hourglass controls, from places and directors (3, n, m)."""
    a1, a2 = float(sheet["a1"]), float(sheet["a2"])
    area = cell[:-1, :-1]
    p, q = x[:, 1:, 1:] - x[:, :-1, :-1], x[:, 1:, :-1] - x[:, :-1, 1:]
    normal = np.cross((p + q) / (2.0 * a1), (p - q) / (2.0 * a2), axis=0)
    normal = normal / np.sqrt(np.maximum((normal * normal).sum(axis=0), h.SMALLEST))
    scale = float(sheet["glass"]) * (2.0 / 3.0) * (a1**-2 + a2**-2)
    pattern = _pattern(x)
    flat = (pattern**2).sum(axis=0) - (pattern * normal).sum(axis=0) ** 2
    glass = 0.5 * scale * max(float(sheet["eh1"]), float(sheet["eh2"])) * float(np.sum(area * flat))
    shear = 0.0
    rigidity = max(float(sheet["bend1"]), float(sheet["bend2"]))
    if rigidity > 0.0:
        glass += 0.5 * scale * rigidity * float(np.sum(area * (_pattern(director) ** 2).sum(axis=0)))
        for axis, a in ((1, a1), (2, a2)):
            y, d = np.moveaxis(x, axis, 1), np.moveaxis(director, axis, 1)
            s = (np.diff(y, axis=1) / a * 0.5 * (d[:, 1:] + d[:, :-1])).sum(axis=0)
            mean, half = 0.5 * (s[:, 1:] + s[:, :-1]), 0.5 * (s[:, 1:] - s[:, :-1])
            square = np.moveaxis(mean**2 + half**2 / 3.0, 0, axis - 1)
            shear += 0.5 * float(sheet["transverse"]) * float(np.sum(area * square))
    return {"transverse_shear": shear, "hourglass": glass}


def _pattern(x: np.ndarray) -> np.ndarray:
    """The hourglass pattern (x00 - x10 + x11 - x01)/4 of all cells, (3, n-1, m-1)."""
    return np.asarray(0.25 * (x[:, :-1, :-1] - x[:, 1:, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:]))
