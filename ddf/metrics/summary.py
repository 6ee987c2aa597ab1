"""All metrics of a ply as one flat table of plain numbers, units in the keys."""

from __future__ import annotations

from typing import Any

from ddf.metrics.boundary import boundary_profile, draw_in, outline_area, outline_length
from ddf.metrics.bridging import Bridging, find_bridging
from ddf.metrics.shear import fibre_strain_range, shear_statistics
from ddf.metrics.surface import PlySurface
from ddf.metrics.wrinkles import Wrinkle, WrinkleResult, find_wrinkles


def ply_metrics(
    surface: PlySurface,
    axis_xy: tuple[float, float] = (0.0, 0.0),
    threshold_mm: float = 0.4,
    min_length_mm: float = 8.0,
    bridging_threshold_mm: float = 0.5,
    wrinkles: WrinkleResult | None = None,
    bridging: Bridging | None = None,
) -> dict[str, Any]:
    """Every metric of a ply, ready for JSON: floats, ints, text and tables of floats; None where not known.

    Pass `wrinkles` and `bridging` where they have been found already.
    """
    found = wrinkles or find_wrinkles(surface, axis_xy, threshold_mm, min_length_mm)
    spans = bridging or find_bridging(surface, found.mask, bridging_threshold_mm)
    low, high = fibre_strain_range(surface)
    return {
        "ply": surface.name,
        **outline_numbers(surface),
        **shear_statistics(surface),
        "fibre_strain_min": low,
        "fibre_strain_max": high,
        "gap_largest_mm": _known(spans.largest_anywhere_mm),
        "gap_area_percent": _known(spans.open_area_percent),
        "bridging_largest_mm": _known(spans.largest_mm),
        "bridging_mean_mm": _known(spans.mean_mm),
        "bridging_mean_outside_wrinkles_mm": _known(spans.mean_outside_wrinkles_mm),
        "bridged_area_percent": _known(spans.area_percent),
        "wrinkle_count": found.count,
        "wrinkle_total_length_mm": found.total_length_mm,
        "wrinkle_largest_amplitude_mm": found.largest_amplitude_mm,
        "wrinkled_area_percent": found.area_percent,
        "elements_per_wrinkle_smallest": _known(found.smallest_elements_across),
        "elements_per_wrinkle_median": _known(found.median_elements_across),
        "wrinkles": [wrinkle_row(w) for w in found.wrinkles],
    }


def wrinkle_row(wrinkle: Wrinkle) -> dict[str, Any]:
    """One wrinkle as a row of plain numbers (the crest's points left out)."""
    row: dict[str, Any] = {"ply": wrinkle.ply}
    for end, point in (("start", wrinkle.start), ("end", wrinkle.end)):
        row.update({f"{end}_{axis}_mm": float(value) for axis, value in zip("xyz", point, strict=True)})
    skip = {"ply", "start", "end", "crest"}
    row.update({key: float(value) for key, value in vars(wrinkle).items() if key not in skip})
    return row


def outline_numbers(surface: PlySurface) -> dict[str, Any]:
    """Area, length and draw-in of the outline."""
    profile = boundary_profile(surface)
    inward = draw_in(surface)
    return {
        "outline_area_mm2": outline_area(profile.deformed),
        "outline_initial_area_mm2": outline_area(profile.initial),
        "outline_length_mm": outline_length(profile.deformed),
        "outline_initial_length_mm": outline_length(profile.initial),
        "draw_in_mid_side_mm": inward["mid_side"],
        "draw_in_corner_mm": inward["corner"],
    }


def _known(value: float) -> float | None:
    """None for NaN: JSON has no NaN."""
    return None if value != value else float(value)
