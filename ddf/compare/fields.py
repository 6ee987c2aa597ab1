"""Difference of the shear angles of two formed plies at the same material points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

from ddf.metrics import PlySurface, shear_angle
from ddf.metrics.surface import cell_area

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ShearDifference:
    """Shear angle of the second run less that of the first, on the first run's cells."""

    map_deg: Array  # (n-1, m-1), NaN where either has no fabric
    rms_deg: float  # weighted by area; NaN where the plies share no place
    largest_deg: float
    signed: bool  # False: the fibres run otherwise in the second run, so only sizes are compared


def flat_centres(surface: PlySurface) -> Array:
    """Places of the cells on the flat ply in plan, (n-1, m-1, 2) [mm]."""
    x = surface.x0[:2]
    return 0.25 * np.moveaxis(x[:, 1:, 1:] + x[:, :-1, 1:] + x[:, 1:, :-1] + x[:, :-1, :-1], 0, -1)


def shear_difference(first: PlySurface, second: PlySurface) -> ShearDifference:
    """Compare two plies' shear: the second interpolated linearly on the first's cells (on the flat plies)."""
    signed = _same_fibres(first, second)
    a, b = shear_angle(first, blank=np.nan), shear_angle(second, blank=np.nan)
    if not signed:
        a, b = np.abs(a), np.abs(b)
    at, places = flat_centres(first), flat_centres(second)
    there = np.isfinite(b) & np.isfinite(places).all(axis=-1)
    asked = np.isfinite(a) & np.isfinite(at).all(axis=-1)
    difference = np.full(a.shape, np.nan)
    if there.sum() > 3 and asked.any():
        difference[asked] = LinearNDInterpolator(places[there], b[there])(at[asked]) - a[asked]
        far = cKDTree(places[there]).query(at[asked])[0] > 1.5 * max(second.spacing)  # over a hole of the second
        difference[asked] = np.where(far, np.nan, difference[asked])
    known = np.isfinite(difference)
    if not known.any():
        return ShearDifference(difference, float("nan"), float("nan"), signed)
    area, values = cell_area(first)[known], difference[known]
    rms = float(np.sqrt((values**2 * area).sum() / area.sum()))
    return ShearDifference(difference, rms, float(np.abs(values).max()), signed)


def _same_fibres(first: PlySurface, second: PlySurface) -> bool:
    """Whether family 1 runs along the same line on both flat plies, so that signs of shear mean the same."""
    directions = []
    for surface in (first, second):
        steps = np.diff(surface.x0[:2], axis=1).reshape(2, -1)
        mean = np.nanmean(steps, axis=1)
        directions.append(mean / np.linalg.norm(mean))
    return bool(abs(directions[0] @ directions[1]) > np.cos(np.radians(1.0)))
