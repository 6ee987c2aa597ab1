"""Wrinkles of a formed ply: found, traced and measured one by one (definitions: docs/metrics.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddf.metrics.base import height_field
from ddf.metrics.crests import Crest, select_crests
from ddf.metrics.linking import join_lines
from ddf.metrics.profiles import AMPLITUDE, ARC, AREA, WIDTH, Sections, cut_sections
from ddf.metrics.ridges import trace_ridges
from ddf.metrics.surface import Array, Mask, PlySurface, cell_area

SMOOTHING_MM = 2.5  # Gaussian of the height in which ridges are looked for
NARROW_MM = 1.5  # and again, for narrow folds side by side, where elements are no larger than this
WIDE_MM = 5.0  # and for folds that are flat on top or have two crests: their middles
WIDE_WINDOW_MM = 6.0  # how far from the middle of such a fold its summits may be
TRUST = 0.8  # strength of lines found in these, which are taken where the first has no better one
REACH_MM = 30.0  # half-length of the sections: flanks of wider folds are cut off there
GAP_MM = 6.0  # longest interruption of a crest
CURVATURE_PER_THRESHOLD = 0.006  # [1/mm2] least curvature of a ridge per mm of threshold


@dataclass(frozen=True)
class Wrinkle:
    """One wrinkle. Angles 0..90 deg unless stated; the start is the end nearer to the tool's axis."""

    ply: str
    start: Array  # [mm] (3,)
    end: Array  # [mm] (3,)
    length_mm: float  # arc length of the crest
    amplitude_mm: float  # largest height of the crest over its local base
    mean_amplitude_mm: float  # mean along the crest
    width_mm: float  # full width at half height in space, median along the crest
    arc_mm: float  # material length over the fold between the points at half height, median
    elements_across: float  # arc_mm in elements, median
    section_area_mm2: float  # area between the fold and its base, mean along the crest
    volume_mm3: float  # section area times length
    direction_deg: float  # direction in plan from start to end, from x towards y, -180..180
    angle_to_family_1_deg: float  # between crest and local fibre, on the deformed sheet
    angle_to_family_2_deg: float
    angle_to_radial_deg: float  # in plan, between start-end and the radius from the axis to the middle
    start_radius_mm: float  # distance in plan of the start from the axis
    crest: Array  # [mm] (k, 3)


@dataclass(frozen=True)
class WrinkleResult:
    """All wrinkles of a ply, largest amplitude first."""

    wrinkles: list[Wrinkle]
    mask: Mask  # (n-1, m-1) cells higher than the threshold over the base of their wrinkle
    height: Array  # [mm] (n, m) height over the base of the wrinkle a node belongs to; 0 elsewhere
    area_percent: float  # [%] share of the ply's initial area in `mask`

    @property
    def count(self) -> int:
        """Number of wrinkles."""
        return len(self.wrinkles)

    @property
    def total_length_mm(self) -> float:
        """Sum of the lengths."""
        return float(sum(w.length_mm for w in self.wrinkles))

    @property
    def largest_amplitude_mm(self) -> float:
        """Largest amplitude; 0 without wrinkles."""
        return max((w.amplitude_mm for w in self.wrinkles), default=0.0)

    @property
    def smallest_elements_across(self) -> float:
        """Elements over the narrowest wrinkle; NaN without wrinkles."""
        return min((w.elements_across for w in self.wrinkles), default=float("nan"))

    @property
    def median_elements_across(self) -> float:
        """Median over the wrinkles of the elements over each; NaN without wrinkles."""
        return float(np.median([w.elements_across for w in self.wrinkles])) if self.wrinkles else float("nan")


def find_wrinkles(
    surface: PlySurface,
    axis_xy: tuple[float, float] = (0.0, 0.0),
    threshold_mm: float = 0.4,
    min_length_mm: float = 8.0,
) -> WrinkleResult:
    """Find and measure the wrinkles of a ply.

    A wrinkle is a ridge along which, for at least `min_length_mm`, a section across rises by more than
    `threshold_mm` over the base between its feet, in its height over the tool and in its own shape.
    """
    field = height_field(surface)
    spacing = surface.spacing
    domain = surface.cell_fraction > 0
    curvature, element = CURVATURE_PER_THRESHOLD * threshold_mm, min(spacing)
    usual, narrow, wide = (
        join_lines(trace_ridges(field, domain, spacing, smoothing, curvature), spacing, GAP_MM)
        if smoothing >= element
        else []
        for smoothing in (max(SMOOTHING_MM, element), NARROW_MM, max(WIDE_MM, element))
    )
    lines = usual + narrow + wide
    if not lines:
        return WrinkleResult([], np.zeros(domain.shape, bool), np.zeros(surface.shape), 0.0)
    windows = [1.5 * element] * len(usual + narrow) + [max(WIDE_WINDOW_MM, 2.5 * element)] * len(wide)
    sections = cut_sections(surface, field, lines, windows, REACH_MM, threshold_mm)
    crests, height = select_crests(
        lines,
        sections,
        field.x,
        [1.0] * len(usual) + [TRUST] * len(narrow + wide),
        step_mm=0.5 * min(spacing),
        gap_mm=GAP_MM,
        threshold_mm=threshold_mm,
        min_length_mm=min_length_mm,
    )
    wrinkles = [_measure(surface, crest, sections, np.asarray(axis_xy)) for crest in crests]
    wrinkles.sort(key=lambda w: -w.amplitude_mm)
    corners = height[1:, 1:] + height[:-1, 1:] + height[1:, :-1] + height[:-1, :-1]
    mask = domain & (0.25 * corners > threshold_mm)
    area = cell_area(surface)
    share = 100 * float(area[mask].sum() / area.sum()) if area.sum() > 0 else 0.0
    return WrinkleResult(wrinkles, mask, height, share)


def _measure(surface: PlySurface, crest: Crest, sections: Sections, axis: NDArray[np.float64]) -> Wrinkle:
    """The numbers of one wrinkle from its crest and sections."""
    values = sections.values[crest.rows]
    radii = np.linalg.norm(crest.points[[0, -1], :2] - axis, axis=1)
    points = crest.points if radii[0] <= radii[1] else crest.points[::-1]
    chord = points[-1, :2] - points[0, :2]
    across = sections.grid_direction[crest.rows]
    element = np.linalg.norm(across * np.square(surface.spacing), axis=1)
    element /= np.linalg.norm(across * surface.spacing, axis=1)
    area = float(values[:, AREA].mean())
    family_1, family_2 = (_axial_mean(angles) for angles in sections.fibre_angles[crest.rows].T)
    return Wrinkle(
        ply=surface.name,
        start=points[0],
        end=points[-1],
        length_mm=crest.length_mm,
        amplitude_mm=float(values[:, AMPLITUDE].max()),
        mean_amplitude_mm=float(values[:, AMPLITUDE].mean()),
        width_mm=float(np.median(values[:, WIDTH])),
        arc_mm=float(np.median(values[:, ARC])),
        elements_across=float(np.median(values[:, ARC] / element)),
        section_area_mm2=area,
        volume_mm3=area * crest.length_mm,
        direction_deg=float(np.degrees(np.arctan2(chord[1], chord[0]))),
        angle_to_family_1_deg=family_1,
        angle_to_family_2_deg=family_2,
        angle_to_radial_deg=_angle_to_radius(chord, _middle(points)[:2] - axis),
        start_radius_mm=float(radii.min()),
        crest=np.ascontiguousarray(points),
    )


def _middle(points: Array) -> Array:
    """The point half-way along a polyline."""
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return np.array([np.interp(0.5 * arc[-1], arc, part) for part in points.T])


def _axial_mean(angles: Array) -> float:
    """Mean of angles of undirected lines [rad], as 0..90 deg: half the angle of sum exp(2 i phi)."""
    return abs(0.5 * float(np.degrees(np.angle(np.exp(2j * angles).sum()))))


def _angle_to_radius(chord: Array, radius: Array) -> float:
    """Angle in plan, 0..90 deg, between the chord and the radius of its middle; 0 where the axis is there."""
    if np.linalg.norm(radius) < 0.05 * np.linalg.norm(chord):
        return 0.0
    cross = chord[0] * radius[1] - chord[1] * radius[0]
    return float(np.degrees(np.arctan2(abs(cross), abs(chord @ radius))))
