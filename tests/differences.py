"""Central differences, to check forces against energies."""

from collections.abc import Callable

import numpy as np


def gradient(energy: Callable[[np.ndarray], float], x: np.ndarray, step: float = 1e-4) -> np.ndarray:
    """Gradient of an energy [N mm] at positions x [mm], of fourth order in the step [mm]."""
    g = np.zeros_like(x)
    for k in np.ndindex(x.shape):
        y = x.copy()
        e = []
        for shift in (1.0, -1.0, 2.0, -2.0):
            y[k] = x[k] + shift * step
            e.append(energy(y))
        g[k] = (8.0 * (e[0] - e[1]) - (e[2] - e[3])) / (12.0 * step)
    return g
