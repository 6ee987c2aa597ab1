"""A comparison in words and columns."""

from __future__ import annotations

from collections.abc import Iterator

from ddf.compare.runs import Comparison, Measured, PlyComparison
from ddf.compare.sites import REACH_MM


def comparison_lines(result: Comparison) -> Iterator[str]:
    """The comparison as lines: numbers side by side, outlines, shear, wrinkles site by site, what was measured."""
    yield f"a: {result.paths[0]}"
    yield f"b: {result.paths[1]}"
    for ply in result.plies:
        yield ""
        yield from _ply_lines(ply)
    for item in result.measured:
        yield ""
        yield from _measured_lines(item)
    for note in result.notes:
        yield f"note: {note}"


def _ply_lines(ply: PlyComparison) -> Iterator[str]:
    yield f"{ply.ply:<34} {'a':>11} {'b':>11} {'b - a':>11}"
    for key, (a, b) in ply.numbers.items():
        yield f"  {key:<32} {a:>11.5g} {b:>11.5g} {b - a:>+11.4g}"
    if ply.outline is None:
        yield "  outlines: a run has none"
    else:
        x, y = ply.outline.largest_at
        yield (
            f"  outlines apart: {ply.outline.mean_mm:.2f} mm on average, {ply.outline.largest_mm:.2f} mm at most, "
            f"at ({x:.0f}, {y:.0f}) mm"
        )
    kind = "" if ply.shear.signed else " (of sizes: the fibres run otherwise)"
    yield f"  shear apart: {ply.shear.rms_deg:.2f} deg rms, {ply.shear.largest_deg:.1f} deg at most{kind}"
    matched = [site for site in ply.sites if site.distance_mm is not None]
    yield (
        f"  wrinkles: {len(matched)} sites in both (nearer than {REACH_MM:g} mm), "
        f"{sum(s.second is None for s in ply.sites)} in a only, {sum(s.first is None for s in ply.sites)} in b only"
    )
    if ply.sites:
        yield f"  {'a':>4} {'b':>4} {'apart mm':>9} {'length mm a':>12} {'b':>7} {'amplitude mm a':>15} {'b':>6}"
    for site in ply.sites:
        row = site.row()
        yield (
            f"  {_cell(row['number_a'], 4, 0)} {_cell(row['number_b'], 4, 0)} {_cell(row['distance_mm'], 9, 1)} "
            f"{_cell(row['length_a_mm'], 12, 1)} {_cell(row['length_b_mm'], 7, 1)} "
            f"{_cell(row['amplitude_a_mm'], 15, 2)} {_cell(row['amplitude_b_mm'], 6, 2)}"
        )


def _measured_lines(item: Measured) -> Iterator[str]:
    fit = item.fit
    how = "as given" if fit is None else (
        f"after the best rigid fit (turned {fit.turn_deg:.2f} deg, moved {fit.shift_mm[0]:.2f}, "
        f"{fit.shift_mm[1]:.2f} mm)"
    )  # fmt: skip
    yield (
        f"measured outline of {item.ply} to {item.run}, {how}: {item.distances.mean_mm:.2f} mm on average, "
        f"{item.distances.largest_mm:.2f} mm at most"
    )


def _cell(value: float | None, width: int, digits: int) -> str:
    return f"{'-':>{width}}" if value is None else f"{value:>{width}.{digits}f}"
