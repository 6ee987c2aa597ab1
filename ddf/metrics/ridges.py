"""Ridge lines of the height over the tool: found where it is largest across, and followed along.

The direction e across a ridge makes the larger of two curvatures least: that of the height, h_ee, and that of
the sheet itself, x_ee.n with n its outward normal. A fold is strongly negative in both. A rounded edge of
the tool under a conforming sheet is so in the second alone, a hollow corner that the sheet spans in the first
alone (the distance to the nearer of two walls has a crest half-way between them): neither leads a line
astray. On the ridge the slope h_e is zero (after Steger, IEEE Trans. PAMI 20 (1998) 113). All in
material coordinates (mm along the fibres), so a fold may overhang in plan.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy import ndimage

from ddf.metrics.base import HeightField
from ddf.metrics.surface import Array, Mask

LOOK_BACK_MM = 4.0  # length over which a line may not turn sharply
RATE_PER_MM = 0.2  # of taking on a new direction
HOLD_MM = 3.0
ANGLES = 24  # directions tried across a ridge
# fourth order: second-order errors differ with direction and bend the ends of oblique ridges
FIRST = (1 / 12, -8 / 12, 0.0, 8 / 12, -1 / 12)
SECOND = (-1 / 12, 16 / 12, -30 / 12, 16 / 12, -1 / 12)


def trace_ridges(
    field: HeightField,
    domain: Mask,
    spacing: tuple[float, float],
    smoothing_mm: float,
    curvature_per_mm: float,
) -> list[Array]:
    """Ridge lines as polylines (k, 2) in grid coordinates, strongest first, k >= 3.

    Height and positions are smoothed by a Gaussian of `smoothing_mm`. Ridges start where the curvature
    across is below -2 `curvature_per_mm` and are followed both ways until it is above -`curvature_per_mm`,
    the domain (n-1, m-1 cells) ends, the line turns sharply or meets a line already traced.
    """
    fields = _derivatives(field, spacing, smoothing_mm)
    cells = np.ascontiguousarray(domain)
    seeds = _seeds(fields, cells, spacing, 2 * curvature_per_mm)
    taken = np.zeros(field.h.shape, dtype=np.bool_)
    lines: list[Array] = []
    step = 0.5 * min(spacing)
    for u, v in seeds:
        if taken[round(u), round(v)]:
            continue
        place = (fields, cells, taken, np.array([u, v]), np.array(spacing))
        ahead, behind = (_follow(*place, sign, step, curvature_per_mm) for sign in (1.0, -1.0))
        line = np.vstack([behind[::-1], ahead[1:]])
        _take(taken, line)
        if len(line) >= 3:
            lines.append(line)
    return lines


def _derivatives(field: HeightField, spacing: tuple[float, float], smoothing_mm: float) -> Array:
    """(8, n, m): h_u, h_v, h_uu, h_uv, h_vv, then x_uu.n, x_uv.n, x_vv.n, smoothed, per mm of fibre."""
    hu, hv, *height = _smooth_derivatives(field.h, spacing, smoothing_mm)
    bent = np.stack([_smooth_derivatives(part, spacing, smoothing_mm)[2:] for part in field.x])
    return np.stack([hu, hv, *height, *np.einsum("cdij,cij->dij", bent, field.normal)])


def _smooth_derivatives(values: Array, spacing: tuple[float, float], smoothing_mm: float) -> Array:
    """First (u, v) and second (uu, uv, vv) derivatives of smoothed values (n, m), as (5, n, m)."""
    sigma = [max(smoothing_mm / a, 1.0) for a in spacing]
    smooth = ndimage.gaussian_filter(values, sigma, mode="nearest")
    du = _differ(smooth, FIRST, 0) / spacing[0]
    dv = _differ(smooth, FIRST, 1) / spacing[1]
    duu = _differ(smooth, SECOND, 0) / spacing[0] ** 2
    dvv = _differ(smooth, SECOND, 1) / spacing[1] ** 2
    return np.stack([du, dv, duu, _differ(du, FIRST, 1) / spacing[1], dvv])


def _differ(values: Array, weights: tuple[float, ...], axis: int) -> Array:
    """Central difference with the given weights, in grid steps."""
    return np.asarray(ndimage.correlate1d(values, weights, axis=axis, mode="nearest"))


def _seeds(fields: Array, cells: Mask, spacing: tuple[float, float], curvature: float) -> Array:
    """Ridge points near nodes, (k, 2) grid coordinates, most curved first."""
    bend, du, dv = _node_ridges(fields, np.array(spacing), -curvature)
    n, m = bend.shape
    inner = np.zeros((n, m), dtype=bool)
    inner[:-1, :-1] |= cells
    inner[1:, 1:] |= cells
    i, j = np.nonzero(inner & (bend < 0))
    order = np.argsort(bend[i, j], kind="stable")
    u = np.clip(i + du[i, j], 0, n - 1)[order]
    v = np.clip(j + dv[i, j], 0, m - 1)[order]
    return np.stack([u, v], axis=1)


@njit(cache=True)
def _node_ridges(fields: Array, spacing: Array, limit: float) -> tuple[Array, Array, Array]:
    """Curvature across and offset to the ridge (grid steps) of nodes within 0.6 steps of one; else 0."""
    n, m = fields.shape[1:]
    bend, du, dv = np.zeros((n, m)), np.zeros((n, m)), np.zeros((n, m))
    for i in range(n):
        for j in range(m):
            d = _derivatives_at(fields, float(i), float(j))
            # the least eigenvalue of the height bounds the curvature: no search where it is small
            if 0.5 * (d[2] + d[4]) - np.hypot(0.5 * (d[2] - d[4]), d[3]) > limit:
                continue
            curved, tu, tv = _along(d)
            if curved > limit:
                continue
            eu, ev = -tv, tu
            second = d[2] * eu * eu + 2 * d[3] * eu * ev + d[4] * ev * ev
            offset = -(d[0] * eu + d[1] * ev) / second
            ou, ov = offset * eu / spacing[0], offset * ev / spacing[1]
            if abs(ou) <= 0.6 and abs(ov) <= 0.6:
                bend[i, j], du[i, j], dv[i, j] = curved, ou, ov
    return bend, du, dv


@njit(cache=True)
def _derivatives_at(fields: Array, u: float, v: float) -> Array:
    """The eight derivatives at grid coordinates (u, v), bilinear."""
    n, m = fields.shape[1:]
    i = min(max(int(u), 0), n - 2)
    j = min(max(int(v), 0), m - 2)
    s, t = u - i, v - j
    d = np.empty(8)
    for f in range(8):
        low = (1 - s) * fields[f, i, j] + s * fields[f, i + 1, j]
        high = (1 - s) * fields[f, i, j + 1] + s * fields[f, i + 1, j + 1]
        d[f] = (1 - t) * low + t * high
    return d


@njit(cache=True)
def _along(d: Array) -> tuple[float, float, float]:
    """Curvature across the ridge, max(h_ee, x_ee.n) at its least over e, and the unit direction along it."""
    step = np.pi / ANGLES
    value = np.empty(ANGLES)
    best = 0
    for k in range(ANGLES):
        value[k] = _larger_curvature(d, k * step)
        if value[k] < value[best]:
            best = k
    low, high = value[best - 1], value[(best + 1) % ANGLES]  # of period pi: -1 is the last
    bow = low + high - 2 * value[best]
    angle = (best + (0.5 * (low - high) / bow if bow > 0.0 else 0.0)) * step
    return _larger_curvature(d, angle), -np.sin(angle), np.cos(angle)


@njit(cache=True)
def _larger_curvature(d: Array, angle: float) -> float:
    """The larger of the curvatures of height and sheet in the direction e = (cos, sin)."""
    c, s = np.cos(angle), np.sin(angle)
    return max(d[2] * c * c + 2 * d[3] * c * s + d[4] * s * s, d[5] * c * c + 2 * d[6] * c * s + d[7] * s * s)


@njit(cache=True)
def _follow(
    fields: Array,
    cells: Mask,
    taken: Mask,
    start: Array,
    spacing: Array,
    sign: float,
    step: float,
    curvature: float,
) -> Array:
    """One way along a ridge from `start`, (k, 2): a step along it, then Newton steps to the top across it.

    The direction is a running mean of that of the curvatures and the way travelled. Where the ridge falls off
    steeply, at its ends, a small fault of direction moves the summit of the section far to its side: the
    direction is then held, by a rate 1 / (1 + (L / HOLD_MM)^2), L = |slope along| / |curvature across|.
    """
    n, m = taken.shape
    limit = int(4 * (n + m) * max(spacing[0], spacing[1]) / step)
    back = max(int(LOOK_BACK_MM / step), 2)
    line = np.empty((limit, 2))
    u, v = start[0], start[1]
    line[0, 0], line[0, 1] = u, v
    _, tu, tv = _along(_derivatives_at(fields, u, v))
    tu, tv = sign * tu, sign * tv
    for count in range(1, limit):
        pu, pv = u + step * tu / spacing[0], v + step * tv / spacing[1]
        bend, pu, pv = _climb(fields, pu, pv, tu, tv, spacing, step, curvature)
        du, dv = (pu - u) * spacing[0], (pv - v) * spacing[1]
        size = np.hypot(du, dv)
        # a turn of more than 60 degrees in a step: another line's ridge, or none
        if bend == 0.0 or size < 0.2 * step or du * tu + dv * tv < 0.5 * size:
            return line[:count].copy()
        u, v = pu, pv
        line[count, 0], line[count, 1] = u, v
        if _turns(line, count, back, spacing):
            return line[: count - back].copy()
        d = _derivatives_at(fields, u, v)
        _, au, av = _along(d)
        flip = 1.0 if au * tu + av * tv >= 0 else -1.0
        rate = RATE_PER_MM * step / (1.0 + ((d[0] * tu + d[1] * tv) / (bend * HOLD_MM)) ** 2)
        tu, tv = tu + rate * (du / size + flip * au), tv + rate * (dv / size + flip * av)
        norm = np.hypot(tu, tv)
        tu, tv = tu / norm, tv / norm
        to_start = np.hypot((u - start[0]) * spacing[0], (v - start[1]) * spacing[1])
        outside = not cells[min(int(u), n - 2), min(int(v), m - 2)]
        if (count > 12 and to_start < step) or outside or taken[int(u + 0.5), int(v + 0.5)]:
            return line[: count + 1].copy()
    return line


@njit(cache=True)
def _turns(line: Array, count: int, back: int, spacing: Array) -> bool:
    """Whether the last points of a line turn by more than 60 degrees: it goes over to another ridge."""
    if count < 2 * back:
        return False
    aa = ab = bb = 0.0
    for c in range(2):
        b = (line[count, c] - line[count - back, c]) * spacing[c]
        a = (line[count - back, c] - line[count - 2 * back, c]) * spacing[c]
        aa, ab, bb = aa + a * a, ab + a * b, bb + b * b
    return ab < 0.5 * np.sqrt(aa * bb)


@njit(cache=True)
def _climb(
    fields: Array, u: float, v: float, tu: float, tv: float, spacing: Array, step: float, curvature: float
) -> tuple[float, float, float]:
    """Newton steps across direction t to the top of the ridge: its curvature across and place.

    The curvature is 0 where the ridge is less curved than asked or the grid ends.
    """
    n, m = fields.shape[1:]
    eu, ev = -tv, tu
    bend = 0.0
    for _ in range(3):
        if not (0.0 <= u <= n - 1 and 0.0 <= v <= m - 1):
            return 0.0, u, v
        d = _derivatives_at(fields, u, v)
        bend = d[2] * eu * eu + 2 * d[3] * eu * ev + d[4] * ev * ev
        if bend > -curvature:
            return 0.0, u, v
        move = min(max(-(d[0] * eu + d[1] * ev) / bend, -0.5 * step), 0.5 * step)
        u, v = u + move * eu / spacing[0], v + move * ev / spacing[1]
    return (bend if 0.0 <= u <= n - 1 and 0.0 <= v <= m - 1 else 0.0), u, v


def _take(taken: Mask, line: Array) -> None:
    """Mark the nodes within one node of a line."""
    i, j = np.rint(line).astype(int).T
    for di in (-1, 0, 1):
        for dj in (-1, 0, 1):
            taken[np.clip(i + di, 0, taken.shape[0] - 1), np.clip(j + dj, 0, taken.shape[1] - 1)] = True
