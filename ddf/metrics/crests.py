"""From measured ridge lines to crests: the stretches that are wrinkles, each counted once, ends trimmed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ddf.metrics.profiles import AMPLITUDE, SHIFT, Sections, sample_cubic
from ddf.metrics.surface import Array, Mask

SHIFT_SMOOTHING = 2.0  # points


@dataclass(frozen=True)
class Crest:
    """One wrinkle's crest: its points in space and the sections behind it."""

    points: Array  # [mm] (q, 3) in order, ends where the amplitude falls to the threshold
    rows: NDArray[np.int64]  # sections that count as wrinkle
    length_mm: float


def select_crests(
    lines: list[Array],
    sections: Sections,
    x: Array,
    trust: list[float],
    *,
    step_mm: float,
    gap_mm: float,
    threshold_mm: float,
    min_length_mm: float,
) -> tuple[list[Crest], Array]:
    """Crests of at least the least length, and the heights of their sections on the nodes (n, m) [mm].

    A section counts where its amplitude exceeds the threshold. Lines are taken in the order of their
    strength, the sum of their amplitudes times the trust in each. A stretch within the half-height zone of a wrinkle
    already taken belongs to that wrinkle. Faults no longer than `gap_mm` do not interrupt a crest.
    """
    starts = np.concatenate([[0], np.cumsum([len(line) for line in lines])])
    good = sections.values[:, AMPLITUDE] > threshold_mm
    weight = np.where(good, sections.values[:, AMPLITUDE], 0.0)
    strength = np.add.reduceat(weight, starts[:-1]) * trust
    height = np.zeros(x.shape[1:])
    owned = np.zeros(x.shape[1:], dtype=bool)
    crests: list[Crest] = []
    for k in np.argsort(-strength, kind="stable"):
        i, j = np.rint(lines[k]).astype(int).T
        free = good[starts[k] : starts[k + 1]] & ~owned[i, j]
        for first, last in _runs(free, round(gap_mm / step_mm)):
            rows = starts[k] + np.arange(first, last + 1)
            points = _crest_points(sections, rows, free[first : last + 1], starts[k], starts[k + 1], x, threshold_mm)
            length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
            if length < min_length_mm:
                continue
            rows = rows[free[first : last + 1]]
            crests.append(Crest(points, rows, length))
            _stamp(sections, rows, height, owned)
    return crests, height


def _runs(good: Mask, gap: int) -> list[tuple[int, int]]:
    """First and last of each stretch of good points, interruptions of up to `gap` points included."""
    places = np.nonzero(good)[0]
    if not len(places):
        return []
    breaks = np.nonzero(np.diff(places) > gap + 1)[0]
    firsts = places[np.concatenate([[0], breaks + 1])]
    lasts = places[np.concatenate([breaks, [len(places) - 1]])]
    return [(int(a), int(b)) for a, b in zip(firsts, lasts, strict=True) if b > a]


def _crest_points(
    sections: Sections, rows: NDArray[np.int64], good: Mask, begin: int, end: int, x: Array, threshold: float
) -> Array:
    """Crest in space (q, 3), moved across to the summits; ends interpolated to A = threshold."""
    low, high = max(rows[0] - 1, begin), min(rows[-1] + 1, end - 1)
    wide = np.arange(low, high + 1)
    shift = np.interp(wide, rows[good], sections.values[rows[good], SHIFT])
    shift = ndimage.gaussian_filter1d(shift, SHIFT_SMOOTHING, mode="nearest")
    middle = sections.uv.shape[1] // 2
    uv = sections.uv[wide, middle] + shift[:, None] * sections.grid_direction[wide]
    points = sample_cubic(x, uv)
    amplitude = sections.values[wide, AMPLITUDE]
    if low < rows[0]:
        points[0] = _where(threshold, amplitude[1], amplitude[0], points[1], points[0])
    if high > rows[-1]:
        points[-1] = _where(threshold, amplitude[-2], amplitude[-1], points[-2], points[-1])
    return points


def _where(level: float, inner: float, outer: float, inside: Array, beyond: Array) -> Array:
    """Point between two crest points where the amplitude passes `level`; the inner one if it does not."""
    share = (inner - level) / (inner - outer) if outer < level < inner else 0.0
    return np.asarray(inside + share * (beyond - inside))


def _stamp(sections: Sections, rows: NDArray[np.int64], height: Array, owned: Mask) -> None:
    """Put the sections' heights on the nodes (the mean on each), and mark the zone above half height."""
    above = sections.height[rows]
    k, p = np.nonzero(above > 0)
    n, m = height.shape
    i, j = np.rint(sections.uv[rows][k, p]).astype(int).T
    node = np.clip(i, 0, n - 1) * m + np.clip(j, 0, m - 1)
    count = np.bincount(node, minlength=n * m)
    total = np.bincount(node, weights=above[k, p], minlength=n * m)
    mean = (total / np.maximum(count, 1)).reshape(n, m)
    np.maximum(height, mean, out=height)
    amplitude = sections.values[rows, AMPLITUDE]
    owned.ravel()[node[above[k, p] > 0.5 * amplitude[k]]] = True
