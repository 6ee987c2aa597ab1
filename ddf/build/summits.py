"""The tool's sharp vertices as the solver takes them, and where on the flat sheet each begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.contact.summit import SPOT, SUMMIT
from ddf.contact.tool_point import FREE
from ddf.mesh.diaphragm import DiaphragmMesh
from ddf.mesh.summits import summits
from ddf.mesh.tool import TriangleMesh

FloatArray = NDArray[np.float64]

BLIND = 0.4
"""How near to a vertex the sheet may have no point of contact, in cells: its points are 0.35 away at most."""
NO_SPOTS: FloatArray = np.zeros((0, SPOT))


def summit_records(mesh: TriangleMesh | None, element_mm: float, offset_mm: float) -> FloatArray:
    """Columns of `contact.summit` (k, SUMMIT) for a sheet with such elements and its mid-surface so far off."""
    if mesh is None:
        return np.zeros((0, SUMMIT))
    places, axes = summits(mesh, BLIND * element_mm)
    return np.concatenate([places + offset_mm * axes, axes], axis=1)


def first_spots(peaks: FloatArray, diaphragm: DiaphragmMesh) -> FloatArray:
    """Places above the summits on the flat diaphragm, (k, SPOT)."""
    spots = np.zeros((len(peaks), SPOT))
    for axis, lines in enumerate((diaphragm.x_lines, diaphragm.y_lines)):
        spots[:, axis] = np.interp(peaks[:, axis], lines, np.arange(lines.size))
    spots[:, 2] = FREE
    return spots
