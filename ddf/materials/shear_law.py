"""Trellis shear of a woven ply: the normalised shear force N_s(g), and its table for the kernels.

A law gives N_s(g) [N/mm] over the shear angle g. From a tangent modulus G(g) = sum c_k |g|^k [MPa] and the
thickness h:  N_s = h sum c_k g^(k+1)/(k+1).

A picture frame of side L with F = 2 cos(phi) L N_s, phi = (90 deg - g)/2, opens at L sin(phi) dg/dt, so the
work per reference area is dW/dg = N_s cos g, and dW/ds = N_s over s = sin g.

`published` takes the law as entered. Where N_s cos g falls, homogeneous shear is unstable: it localises into
bands, one element wide where no rigidity in the plane gives them a width. `monotone` is the closest law, in least
squares of M = N_s cos g over g, whose slope dM/dg is nowhere below h times a small floor: M - floor h g is an
isotonic regression. G then is not below the floor either.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.optimize import isotonic_regression

FloatArray = NDArray[np.float64]

LARGEST_SINE = 0.985  # 80 degrees; the last cubic goes on beyond
INTERVALS = 1024
SAMPLES = 4001
TANGENT_SPAN = float(np.deg2rad(80.0))  # of a tangent table [rad]; its last interval goes on beyond


def polynomial_law(coefficients: Sequence[float], thickness_mm: float, angle: FloatArray) -> FloatArray:
    """N_s [N/mm] at shear angles [rad] >= 0 from the tangent modulus' ascending coefficients [MPa]."""
    powers = np.arange(len(coefficients)) + 1
    terms = np.asarray(coefficients) / powers
    return thickness_mm * np.polynomial.polynomial.polyval(angle, np.concatenate([[0.0], terms]))


def table_law(angle_deg: Sequence[float], force_N_mm: Sequence[float], angle: FloatArray) -> FloatArray:
    """N_s [N/mm] at angles [rad] from a measured table, monotone cubic between and linear beyond its points."""
    given = np.deg2rad(np.asarray(angle_deg, dtype=float))
    curve = PchipInterpolator(given, np.asarray(force_N_mm, dtype=float))
    end = given[-1]
    beyond = curve(end) + curve.derivative()(end) * (angle - end)
    return np.where(angle <= end, curve(np.minimum(angle, end)), beyond)


def monotone(angle: FloatArray, force: FloatArray, floor_N_mm: float) -> FloatArray:
    """Closest N_s to `force` over evenly spaced `angle` [rad] with d(N_s cos g)/dg >= `floor_N_mm` [N/mm].

    The regression goes up to 75 deg. Beyond, where cos g must turn any finite force down, the force goes on from there
    by what the law rises, and stays where it falls.
    """
    inside = angle <= np.deg2rad(75.0)
    g, cosine = angle[inside], np.cos(angle[inside])
    tilt = floor_N_mm * g
    kept = force.copy()
    kept[inside] = (isotonic_regression(force[inside] * cosine - tilt).x + tilt) / cosine
    last = np.count_nonzero(inside) - 1
    kept[last:] = kept[last] + np.maximum.accumulate(force[last:] - force[last])
    return kept


def shear_samples(
    law: str,
    thickness_mm: float,
    floor_MPa: float,
    coefficients: Sequence[float] | None,
    table: tuple[Sequence[float], Sequence[float]] | None,
) -> tuple[FloatArray, FloatArray]:
    """Angles [rad], 0 .. asin(LARGEST_SINE), and N_s [N/mm] of the law that will run."""
    angle = np.linspace(0.0, np.arcsin(LARGEST_SINE), SAMPLES)
    if coefficients is not None:
        force = polynomial_law(coefficients, thickness_mm, angle)
    elif table is not None:
        force = table_law(*table, angle)
    else:
        raise ValueError("a shear law needs coefficients or a table")
    if law == "monotone":
        force = monotone(angle, force, floor_MPa * thickness_mm)
    return angle, force - force[0]


def shear_table(angle: FloatArray, force: FloatArray) -> FloatArray:
    """Cubics of dW/ds = N_s over s = sin g, (INTERVALS + 1, 5), from samples of a law.

    Row k holds c0 .. c3 of c0 + c1 u + c2 u^2 + c3 u^3, u = s/width - k, and W at its start [N/mm]; the last
    row holds the width of an interval.
    """
    s = np.linspace(0.0, LARGEST_SINE, INTERVALS + 1)
    g = np.arcsin(s)
    slope = PchipInterpolator(s, PchipInterpolator(angle, force)(g))
    width = s[1]
    table = np.zeros((INTERVALS + 1, 5))
    for k in range(4):
        table[:-1, k] = slope.c[3 - k] * width**k
    table[:-1, 4] = slope.antiderivative()(s[:-1])
    table[-1, 0] = width
    return table


def tangent_table(angle: FloatArray, force: FloatArray) -> FloatArray:
    """Tangents h G = dN_s/dg [N/mm], (INTERVALS,), means over even intervals of the angle from 0 to TANGENT_SPAN."""
    g = np.linspace(0.0, TANGENT_SPAN, INTERVALS + 1)
    return np.diff(np.interp(g, angle, force)) / g[1]


def largest_tangent(angle: FloatArray, force: FloatArray, up_to_deg: float = 60.0) -> float:
    """Largest slope |dN_s/dg| [N/mm] up to an angle, at least that of N_s cos g: what the step must resolve."""
    inside = angle <= np.deg2rad(up_to_deg)
    return float(np.max(np.abs(np.gradient(force[inside], angle[inside]))))
