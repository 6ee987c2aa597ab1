"""Cross-sections of the sheet over ridge points: base between the feet, height, width, area.

Each section follows a straight material line across the crest, so that an overhanging or closed fold is
single-valued along it; widths and areas are measured in space, in the plane across the crest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy import ndimage

from ddf.metrics.base import HeightField
from ddf.metrics.surface import Array, PlySurface, inside_outline

AMPLITUDE, WIDTH, ARC, AREA, SHIFT = range(5)
METRIC_SMOOTHING_MM = 2.0
BROAD = 2.0
"""Thresholds that a fold has to be high which is broad on top: lower ones are as well a ply that is not quite flat."""
TWIN_MM, DIP = 15.0, 0.4
"""A dip is between two crests of one fold, and no foot, where it is less deep than DIP of what the sheet falls within
TWIN_MM beyond."""


@dataclass(frozen=True)
class Sections:
    """Sections over k crest points, sampled at p places."""

    places: Array  # [mm] (p,) distance along the material line from the crest
    uv: Array  # (k, p, 2) grid coordinates of the samples
    height: Array  # [mm] (k, p) height over the base line between the feet; 0 beyond them
    values: Array  # (k, 5) columns AMPLITUDE.. [mm], [mm2]; 0 where there is no fold
    tangent: Array  # (k, 3) unit crest direction in space
    grid_direction: Array  # (k, 2) grid direction per mm across
    fibre_angles: Array  # [rad] (k, 2) signed angle from each family to the crest, in (-pi/2, pi/2]


def cut_sections(
    surface: PlySurface, field: HeightField, lines: list[Array], windows_mm: list[float], reach_mm: float,
    threshold_mm: float,
) -> Sections:  # fmt: skip
    """Sections over all points of the ridge lines (k, 2), half-length `reach_mm`.

    windows_mm: how far from each line its summits may be. Where that is more than two elements, the line is in the
    middle of a fold that may have several, and stands for its crest as it is; it has to be above half their height, and
    these above BROAD thresholds.
    """
    uv = np.vstack(lines)
    spacing = np.array(surface.spacing)
    along = np.vstack([_gradient(line) for line in lines])
    metric = _metric(field.x, spacing, uv)
    along_mm = along * spacing
    across, tilt = _perpendicular(metric, along_mm)
    count = int(np.ceil(4 * reach_mm / min(surface.spacing)))
    places = np.linspace(-reach_mm, reach_mm, 2 * count + 1)
    grid_direction = across / spacing
    samples = uv[:, None, :] + places[None, :, None] * grid_direction[:, None, :]
    valid = inside_outline(surface, samples.reshape(-1, 2)).reshape(samples.shape[:2])
    heights = sample_cubic(field.h[None], samples)[..., 0]
    points = np.ascontiguousarray(sample_cubic(field.x, samples))
    tangent = np.vstack([_unit_rows(_gradient(p)) for p in _split(points[:, count], lines)])
    i, j = np.rint(uv).astype(int).T
    normal = field.normal[:, i, j].T
    normal = _unit_rows(normal - (normal * tangent).sum(axis=1)[:, None] * tangent)
    sizes = [len(line) for line in lines]
    window = np.repeat([max(round(width / (places[1] - places[0])), 2) for width in windows_mm], sizes)
    height, values = _measure(places, heights, points, valid, tangent, normal, window, threshold_mm)
    middles = np.repeat([width > 2.0 * min(surface.spacing) for width in windows_mm], sizes)
    values[middles, SHIFT] = 0.0
    values[middles & (height[:, count] < 0.5 * values[:, AMPLITUDE])] = 0.0  # between two folds
    values[middles & (values[:, AMPLITUDE] < BROAD * threshold_mm)] = 0.0
    return Sections(places, samples, height, values, tangent, grid_direction, tilt)


@njit(cache=True)
def _measure(
    places: Array,
    heights: Array,
    points: Array,
    valid: np.ndarray,
    tangent: Array,
    normal: Array,
    window: np.ndarray,
    threshold: float,
) -> tuple[Array, Array]:
    """Measure every section: (k, p) heights over its base and (k, 5) values; 0 where there is no fold.

    Amplitude: the less of two reliefs, of the height over the tool and of the sheet itself along its normal.
    A sheet that follows a convex tool has no relief in the first, one that spans a hollow none in the second.
    """
    above = np.zeros(heights.shape)
    values = np.zeros((len(heights), 5))
    for k in range(len(heights)):
        own = np.empty(len(places))
        for p in range(len(places)):
            own[p] = _dot(points[k, p], normal[k])
        crest, over = _relief(places, heights[k], valid[k], window[k], threshold)
        crest_own, over_own = _relief(places, own, valid[k], window[k], threshold)
        if crest < 0 or crest_own < 0:
            continue
        if over_own[crest_own] < over[crest]:
            crest, over = crest_own, over_own
        for p in range(len(places)):
            above[k, p] = over[p]
        values[k, 0] = over[crest]
        values[k, 4] = places[crest]
        _span(over, crest, points[k], tangent[k], normal[k], values[k])
    return above, values


@njit(cache=True)
def _dot(a: Array, b: Array) -> float:
    """Product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _relief(places: Array, h: Array, valid: np.ndarray, window: int, threshold: float) -> tuple[int, Array]:
    """Sample of the crest (-1: none) and heights (p,) over the base line between the feet, 0 beyond them."""
    above = np.zeros(len(h))
    crest = _summit(h, valid, window)
    if crest < 0:
        return -1, above
    twin = round(TWIN_MM / (places[1] - places[0]))
    first, last = _flank(h, valid, crest, -1, threshold, twin), _flank(h, valid, crest, 1, threshold, twin)
    left, right = _feet(places, h, first, crest, last)
    if left == crest or right == crest:
        return -1, above
    slope = (h[right] - h[left]) / (places[right] - places[left])
    for k in range(left, right + 1):
        above[k] = max(h[k] - h[left] - slope * (places[k] - places[left]), 0.0)
    return (crest if above[crest] > 0.0 else -1), above


@njit(cache=True)
def _span(above: Array, crest: int, points: Array, tangent: Array, normal: Array, values: Array) -> None:
    """Width, arc and area of a section into values[1:4].

    Width and arc between the first points at half height on either flank, in space less what lies along the
    crest; area = integral of height by travel in space across the crest.
    """
    low, high, chord, side = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    arc_low = _half_point(above, points, tangent, crest, -1, 0.5 * above[crest], low)
    arc_high = _half_point(above, points, tangent, crest, 1, 0.5 * above[crest], high)
    for c in range(3):
        chord[c] = high[c] - low[c]
        a, b = (c + 1) % 3, (c + 2) % 3
        side[c] = normal[a] * tangent[b] - normal[b] * tangent[a]
    values[1] = np.sqrt(max(_dot(chord, chord) - _dot(chord, tangent) ** 2, 0.0))
    values[2] = arc_low + arc_high
    area = 0.0
    for k in range(len(above) - 1):
        area += 0.5 * (above[k] + above[k + 1]) * (_dot(points[k + 1], side) - _dot(points[k], side))
    values[3] = abs(area)


@njit(cache=True)
def _summit(h: Array, valid: np.ndarray, window: int) -> int:
    """Highest local maximum within `window` samples of the middle; -1 if there is none."""
    middle = len(h) // 2
    best = -1
    if not valid[middle]:
        return best
    for k in range(max(middle - window, 1), min(middle + window, len(h) - 2) + 1):
        peak = valid[k] and h[k] >= h[k - 1] and h[k] >= h[k + 1]
        if peak and (best < 0 or h[k] > h[best]):
            best = k
    return best


@njit(cache=True)
def _flank(h: Array, valid: np.ndarray, crest: int, way: int, threshold: float, twin: int) -> int:
    """Last sample of the flank: its lowest before the sheet rises again by more than the tolerance.

    Dips between two crests of a fold (the next `twin` samples fall much lower) are passed over.
    """
    lowest = crest
    near = crest + way
    fall = 0.0
    while 0 <= near < len(h) and valid[near] and abs(near - crest) <= twin:
        fall = max(fall, h[crest] - h[near])
        near += way
    k = crest + way
    while 0 <= k < len(h) and valid[k]:
        if h[k] < h[lowest]:
            lowest = k
        elif h[k] - h[lowest] > max(0.5 * threshold, 0.1 * (h[crest] - h[lowest])):
            twins = abs(k - crest) <= twin and h[crest] - h[lowest] <= DIP * fall
            if not twins:
                break
        k += way
    return lowest


@njit(cache=True)
def _feet(places: Array, h: Array, first: int, crest: int, last: int) -> tuple[int, int]:
    """Feet of the chord under the crest: of all chords from flank to flank the lowest at the crest.

    This is the edge of the section's lower convex hull ("rubber band") that spans the crest.
    """
    left, right, lowest = crest, crest, h[crest]
    for i in range(first, crest):
        for j in range(crest + 1, last + 1):
            share = (places[crest] - places[i]) / (places[j] - places[i])
            base = (1.0 - share) * h[i] + share * h[j]
            if base < lowest:
                left, right, lowest = i, j, base
    return left, right


@njit(cache=True)
def _half_point(above: Array, points: Array, tangent: Array, crest: int, way: int, level: float, place: Array) -> float:
    """Point in space where the flank first falls to `level`, into `place`; returns the arc to it across the crest."""
    arc, share = 0.0, 0.0
    k = crest
    step = np.zeros(3)
    while 0 < k < len(above) - 1:
        for c in range(3):
            step[c] = points[k + way, c] - points[k, c]
        length = np.sqrt(max(_dot(step, step) - _dot(step, tangent) ** 2, 0.0))
        if above[k + way] <= level:
            share = (above[k] - level) / (above[k] - above[k + way])
            arc += share * length
            break
        arc += length
        k += way
    for c in range(3):
        place[c] = points[k, c] + share * step[c]
    return arc


def sample_cubic(values: Array, samples: Array) -> Array:
    """Cubic-spline values of (c, n, m) at grid coordinates (..., 2), as (..., c)."""
    places = [np.ravel(samples[..., 0]), np.ravel(samples[..., 1])]
    out = [ndimage.map_coordinates(part, places, order=3, mode="mirror") for part in values]
    return np.stack(out, axis=-1).reshape(*samples.shape[:-1], len(values))


def _metric(x: Array, spacing: Array, uv: Array) -> Array:
    """Metric G_ab = x_a.x_b per mm of fibre at grid coordinates uv (k, 2); (k, 2, 2).

    From each cell's edges, whose lengths stay true in a sharp fold, lightly smoothed.
    """
    edge1, edge2 = np.diff(x, axis=1) / spacing[0], np.diff(x, axis=2) / spacing[1]
    square1, square2 = (edge1 * edge1).sum(axis=0), (edge2 * edge2).sum(axis=0)
    mean1, mean2 = 0.5 * (edge1[:, :, 1:] + edge1[:, :, :-1]), 0.5 * (edge2[:, 1:] + edge2[:, :-1])
    g11 = 0.5 * (square1[:, 1:] + square1[:, :-1])
    g22 = 0.5 * (square2[1:] + square2[:-1])
    # the means of opposite edges are shorter where the cell is bent: their cosine, with the edges' lengths
    lengths = np.maximum((mean1**2).sum(axis=0) * (mean2**2).sum(axis=0), 1e-300)
    g12 = (mean1 * mean2).sum(axis=0) / np.sqrt(lengths) * np.sqrt(g11 * g22)
    sigma = list(METRIC_SMOOTHING_MM / spacing)
    i = np.clip(uv[:, 0].astype(int), 0, g11.shape[0] - 1)
    j = np.clip(uv[:, 1].astype(int), 0, g11.shape[1] - 1)
    g11, g12, g22 = (ndimage.gaussian_filter(g, sigma, mode="nearest")[i, j] for g in (g11, g12, g22))
    return np.stack([np.stack([g11, g12], axis=1), np.stack([g12, g22], axis=1)], axis=1)


def _perpendicular(metric: Array, along: Array) -> tuple[Array, Array]:
    """Material direction across a crest, (k, 2) per mm in space, and the crest's angles to the fibres.

    Across: d with along.G.d = 0, |d|_G = 1 (kept within a factor 2 of unit material length). Angles:
    tan phi_a = sqrt(det G) (e_a x along) / (e_a.G.along), e_a the fibre direction.
    """
    covector = np.einsum("kab,kb->ka", metric, along)
    across = np.stack([-covector[:, 1], covector[:, 0]], axis=1)
    across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
    stretch = np.sqrt(np.einsum("ka,kab,kb->k", across, metric, across))
    across /= np.clip(stretch, 0.5, 2.0)[:, None]
    root = np.sqrt(np.maximum(metric[:, 0, 0] * metric[:, 1, 1] - metric[:, 0, 1] ** 2, 0.0))
    angles = np.stack(
        [np.arctan2(root * along[:, 1], covector[:, 0]), np.arctan2(-root * along[:, 0], covector[:, 1])],
        axis=1,
    )
    return across, (angles + np.pi / 2) % np.pi - np.pi / 2


def _gradient(line: Array) -> Array:
    return np.asarray(np.gradient(line, axis=0))


def _split(values: Array, lines: list[Array]) -> list[Array]:
    return np.split(values, np.cumsum([len(line) for line in lines])[:-1])


def _unit_rows(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)[:, None])
