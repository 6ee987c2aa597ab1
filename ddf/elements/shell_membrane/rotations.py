"""Motion of the directors: nodes turn with their angular velocity, an isotropic rotary inertia resists.

    J dw/dt = d X pull,   dd/dt = w X d,   J = m r^2

r^2 (`gyration`) is the same for the whole sheet: h^2/12 of a plate, or more, so that the rotations' frequencies
stay under those of the fibres (`timestep.shell_gyration`). Nodes that are held keep their angular velocity.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import FAST


@njit(**FAST)
def turn_row(d, spin, pull, mass, inverse_mass, gyration, keep, dt):
    """One step of a row, arrays (3, m): spin <- keep spin + dt d X pull / J, then d <- d + dt spin X d, of unit length.

    Returns sum of J spin^2 before.
    """
    square = 0.0
    for j in range(mass.shape[0]):
        dx, dy, dz = d[0, j], d[1, j], d[2, j]
        px, py, pz = pull[0, j], pull[1, j], pull[2, j]
        wx, wy, wz = spin[0, j], spin[1, j], spin[2, j]
        square += mass[j] * gyration * (wx * wx + wy * wy + wz * wz)
        rate = dt * inverse_mass[j] / gyration
        held = keep if inverse_mass[j] > 0.0 else 1.0
        wx, wy, wz = (
            held * wx + rate * (dy * pz - dz * py), held * wy + rate * (dz * px - dx * pz),
            held * wz + rate * (dx * py - dy * px),
        )  # fmt: skip
        spin[0, j], spin[1, j], spin[2, j] = wx, wy, wz
        ax, ay, az = dx + dt * (wy * dz - wz * dy), dy + dt * (wz * dx - wx * dz), dz + dt * (wx * dy - wy * dx)
        one = 1.0 / np.sqrt(ax * ax + ay * ay + az * az)
        d[0, j], d[1, j], d[2, j] = one * ax, one * ay, one * az
    return square


def normals(x: np.ndarray) -> np.ndarray:
    """Unit normals (3, n, m) at the nodes of a sheet x (3, n, m): directors of a sheet without transverse shear."""
    normal = np.cross(np.gradient(x, axis=1), np.gradient(x, axis=2), axis=0)
    return np.asarray(normal / np.sqrt((normal * normal).sum(axis=0)))
