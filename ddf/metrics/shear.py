"""Shear angle of each cell and strain of each fibre edge, with area-weighted statistics."""

from __future__ import annotations

import numpy as np

from ddf.metrics.surface import Array, PlySurface, cell_area


def shear_angle(surface: PlySurface, *, blank: float = 0.0) -> Array:
    """Shear angle of each cell [deg], (n-1, m-1): g = asin(t1.t2 / |t1||t2|).

    t1, t2 are the means of the cell's opposite edges. Cells outside the outline get `blank` (0, or NaN to
    leave them out of a picture).
    """
    x = surface.x
    t1 = x[:, 1:, :-1] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:]
    t2 = x[:, :-1, 1:] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, 1:, :-1]
    inside = surface.cell_fraction > 0
    norms = np.sqrt((t1 * t1).sum(axis=0) * (t2 * t2).sum(axis=0))
    with np.errstate(invalid="ignore", divide="ignore"):
        sine = np.clip((t1 * t2).sum(axis=0) / norms, -1.0, 1.0)
    return np.where(inside, np.degrees(np.arcsin(np.where(inside, sine, 0.0))), blank)


def weighted_percentile(values: Array, weights: Array, percent: float) -> float:
    """Smallest value below or at which `percent` of the weight lies."""
    order = np.argsort(values)
    share = np.cumsum(weights[order])
    if not len(share) or share[-1] <= 0:
        return 0.0
    # the relative slack keeps the round-off of the sum from choosing the next value
    k = int(np.searchsorted(share, percent / 100 * share[-1] * (1 - 1e-12)))
    return float(values[order][min(k, len(share) - 1)])


def shear_statistics(surface: PlySurface) -> dict[str, float]:
    """Area-weighted statistics of |g| [deg]: mean, rms, 95th and 99th percentile, largest."""
    inside = surface.cell_fraction > 0
    size = np.abs(shear_angle(surface))[inside]
    area = cell_area(surface)[inside]
    total = float(area.sum()) or 1.0
    return {
        "shear_mean_deg": float((size * area).sum() / total),
        "shear_rms_deg": float(np.sqrt((size**2 * area).sum() / total)),
        "shear_p95_deg": weighted_percentile(size, area, 95),
        "shear_p99_deg": weighted_percentile(size, area, 99),
        "shear_max_deg": float(size.max(initial=0.0)),
    }


def fibre_strain(surface: PlySurface) -> tuple[Array, Array]:
    """Strain ln(L / a) of the edges of family 1, (n-1, m), and 2, (n, m-1); NaN for edges not in the ply."""
    x, active = surface.x, surface.active
    inside = np.pad(surface.cell_fraction > 0, 1)
    present_1 = active[1:] & active[:-1] & (inside[1:-1, 1:] | inside[1:-1, :-1])
    present_2 = active[:, 1:] & active[:, :-1] & (inside[1:, 1:-1] | inside[:-1, 1:-1])
    length_1 = np.linalg.norm(np.diff(x, axis=1), axis=0)
    length_2 = np.linalg.norm(np.diff(x, axis=2), axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        strain_1 = np.where(present_1, np.log(length_1 / surface.spacing[0]), np.nan)
        strain_2 = np.where(present_2, np.log(length_2 / surface.spacing[1]), np.nan)
    return strain_1, strain_2


def fibre_strain_range(surface: PlySurface) -> tuple[float, float]:
    """Least and largest fibre strain [-] of both families; (0, 0) for a ply with no edge."""
    strain = np.concatenate([part.ravel() for part in fibre_strain(surface)])
    strain = strain[np.isfinite(strain)]
    return (float(strain.min()), float(strain.max())) if len(strain) else (0.0, 0.0)
