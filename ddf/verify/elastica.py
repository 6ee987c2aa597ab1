r"""The heavy elastica: a clamped strip under its own weight, bent as far as it likes.

With s the arc length over the strip's length L, theta(s) the angle below the horizontal and
Gamma = w L^3 / B (w weight per length and width, B bending rigidity per width) the moment of the part beyond s
about s gives

    theta'' = -Gamma (1 - s) cos theta,   theta(0) = 0,   theta'(1) = 0,
    x(s) = int cos theta,   drop(s) = int sin theta

(F. T. Peirce, J. Textile Inst. 21 (1930) T377; W. G. Bickley, Phil. Mag. 17 (1934) 603). Peirce's formula takes the
chord angle th = atan(drop/x) of the tip: B = w (L f)^3, f^3 = cos(th/2) / (8 tan th).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_bvp

from ddf.errors import DdfError
from ddf.verify.problem import FloatArray

POINTS = 201


class Elastica(NamedTuple):
    """A bent strip over its length: arc length, position ahead and drop, (POINTS,) each."""

    s: FloatArray
    x: FloatArray
    drop: FloatArray


def heavy_elastica(gamma: float) -> Elastica:
    """Shape at Gamma, reached from a straight strip over smaller loads."""
    s = np.linspace(0.0, 1.0, POINTS)
    y = np.zeros((4, POINTS))
    loads = [load for load in (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0) if load < gamma] + [gamma]
    grid = s
    for load in loads:

        def slope(s: FloatArray, y: FloatArray, load: float = load) -> FloatArray:
            return np.array([y[1], -load * (1.0 - s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

        def ends(a: FloatArray, b: FloatArray) -> FloatArray:
            return np.array([a[0], b[1], a[2], a[3]])

        solution = solve_bvp(slope, ends, grid, y, tol=1e-8, max_nodes=20_000)
        if not solution.success:
            raise DdfError(f"heavy elastica at Gamma = {load}: {solution.message}")
        grid, y = solution.x, solution.y
    _, _, x, drop = solution.sol(s)
    return Elastica(s, x, drop)


def peirce_rigidity(weight: float, length: float, ahead: float, drop: float) -> float:
    """Peirce's bending rigidity [N mm] from weight [N/mm2], length, and the tip's place ahead and below [mm]."""
    chord = np.arctan2(drop, ahead)
    return float(weight * length**3 * np.cos(0.5 * chord) / (8.0 * np.tan(chord)))
