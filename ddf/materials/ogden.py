"""Ogden's incompressible rubber in the Abaqus form, as closed forms for checks and for the step.

W = sum 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3),  l1 l2 l3 = 1;  mu0 = sum mu,  E0 = 3 mu0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Terms = Sequence[tuple[float, float]]


def initial_shear_modulus(terms: Terms) -> float:
    """mu0 [MPa]."""
    return float(sum(mu for mu, _ in terms))


def bending_rigidity(terms: Terms, thickness_mm: float) -> float:
    """Plate rigidity E0 t^3 / (12 (1 - 1/4)) [N mm]."""
    return 3.0 * initial_shear_modulus(terms) * thickness_mm**3 / 9.0


def biot_stress(terms: Terms, stretch: ArrayLike, mode: str) -> NDArray[np.float64]:
    """Force per reference area [MPa] at a stretch in `uniaxial`, `planar` or `equibiaxial` tension.

    sum 2 mu/alpha (l^(alpha-1) - l^(q alpha - 1)) with q = -1/2, -1, -2.
    """
    q = {"uniaxial": -0.5, "planar": -1.0, "equibiaxial": -2.0}[mode]
    stretch = np.asarray(stretch, dtype=float)
    total = np.zeros_like(stretch)
    for mu, alpha in terms:
        total = total + 2 * mu / alpha * (stretch ** (alpha - 1) - stretch ** (q * alpha - 1))
    return total
