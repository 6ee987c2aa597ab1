"""The inflated circular membrane: the ordinary differential equations of an axisymmetric Ogden sheet.

A disc of radius a and thickness t, clamped at its edge, under the pressure p. At the reference radius R the sheet has
moved to (r, z); l1 = ds/dR, l2 = r/R, cos q = dr/ds. With N_i = t P_i(l1, l2) the forces per reference length, balance
along the meridian and of the cap above a parallel circle are

    d(R N1)/dR = N2 cos q,    sin q = p r^2 / (2 R N1),    dr/dR = l1 cos q,    dz/dR = -l1 sin q

from l1 = l2 = l0 at the pole; p is found so that r(a) = a (Adkins and Rivlin 1952, doi 10.1098/rsta.1952.0013).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ddf.materials.ogden import Terms
from ddf.verify.problem import FloatArray

POLE = 1e-4  # part of the radius at which the integration starts


@dataclass(frozen=True)
class Bulge:
    """An inflated membrane."""

    pressure: float  # [MPa]
    height: float  # of the pole [mm]
    edge_stretch: float  # meridional
    r: FloatArray  # its meridian [mm]
    z: FloatArray


def _forces(terms: Terms, l1: float, l2: float) -> tuple[float, float, float, float]:
    """P1, P2 and the derivatives of P1 by l1 and l2 [MPa]."""
    p1 = p2 = d11 = d12 = 0.0
    for mu, a in terms:
        c, third = 2.0 * mu / a, (l1 * l2) ** -a
        p1 += c * (l1**a - third) / l1
        p2 += c * (l2**a - third) / l2
        d11 += c * ((a - 1.0) * l1**a + (a + 1.0) * third) / l1**2
        d12 += c * a * third / (l1 * l2)
    return p1, p2, d11, d12


def bulge(terms: Terms, radius: float, thickness: float, pole_stretch: float) -> Bulge:
    """The membrane inflated to a stretch > 1 at its pole."""

    def slopes(reference, y, load):
        r, l1, _ = y
        l2 = r / reference
        p1, p2, d11, d12 = _forces(terms, l1, l2)
        sine = min(load * r * r / (2.0 * thickness * reference * p1), 1.0)
        cosine = np.sqrt(1.0 - sine * sine)
        drift = (l1 * cosine - l2) / reference
        return [l1 * cosine, ((p2 * cosine - p1) / reference - d12 * drift) / d11, -l1 * sine]

    def shoot(load):
        start = [POLE * radius * pole_stretch, pole_stretch, 0.0]
        reference = np.linspace(POLE, 1.0, 200) * radius
        return solve_ivp(slopes, (reference[0], radius), start, "LSODA", reference, args=(load,), rtol=1e-9, atol=1e-11)

    # a spherical cap without change of stretch: sin q = p R l0 / (2 t P0); 1.3 times its load for a quarter circle
    # is more than any clamped disc needs
    most = 1.3 * 2.0 * thickness * _forces(terms, pole_stretch, pole_stretch)[0] / (radius * pole_stretch)
    load = brentq(lambda p: shoot(p).y[0, -1] - radius, 1e-6 * most, most, rtol=1e-10)
    end = shoot(load)
    return Bulge(float(load), float(-end.y[2, -1]), float(end.y[1, -1]), end.y[0], end.y[2] - end.y[2, -1])
