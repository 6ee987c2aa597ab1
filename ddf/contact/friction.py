"""Coulomb friction by an elastic spring that gives way.

The trial traction is  t = k s + c s',  s the slip that the spring holds and s' the slip rate. Where |t| > mu N the
traction is scaled back to mu N and the spring keeps the part of s that carries it. Dissipated is the spring's mean
force in the step times the way that it gave way, and the work of the viscous part.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.jit import INLINE

TANGENTIAL = 0.3
"""Stiffness and damping of the friction spring over those of the normal one. At 1 sticking contacts, a
thickness off the mid-surfaces, chattered at the step's limit. With the default penalty of 3 N/mm3, 0.3 lets
a contact under vacuum give about 0.06 mm before it slides (mu p / (0.3 K))."""


@njit(**INLINE)
def coulomb(trial, limit):
    """Share of the trial force [N] that friction can carry: min(1, limit / trial)."""
    return limit / trial if trial > limit else 1.0


@njit(**INLINE)
def length(x, y, z):
    """Length of a vector."""
    return np.sqrt(x * x + y * y + z * z)
