"""Ridge lines of a height field on the lattice: found where the height is largest across, and followed along.

A ridge point has a negative smallest eigenvalue c of the height's Hessian, with eigenvector e across the
ridge, and no slope across it: grad h . e = 0 (Haralick; Steger, IEEE Trans. PAMI 20 (1998) 113). All in
material coordinates (mm along the fibres), so a fold may overhang in plan.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy import ndimage

from ddf.metrics.surface import Array, Mask

LOOK_BACK_MM = 4.0  # length over which a line may not turn sharply
RATE_PER_MM = 0.2  # of taking on a new direction
HOLD_MM = 3.0
# fourth order: second-order errors differ with direction and bend the ends of oblique ridges
FIRST = (1 / 12, -8 / 12, 0.0, 8 / 12, -1 / 12)
SECOND = (-1 / 12, 16 / 12, -30 / 12, 16 / 12, -1 / 12)


def trace_ridges(
    h: Array,
    domain: Mask,
    spacing: tuple[float, float],
    smoothing_mm: float,
    curvature_per_mm: float,
) -> list[Array]:
    """Ridge lines as polylines (k, 2) in grid coordinates, strongest first, k >= 3.

    h (n, m) [mm] is smoothed by a Gaussian of `smoothing_mm`; ridges start where the curvature across is
    below -2 `curvature_per_mm` and are followed both ways until it is above -`curvature_per_mm`, the
    domain (n-1, m-1 cells) ends, the line turns sharply or meets a line already traced.
    """
    fields = _derivatives(h, spacing, smoothing_mm)
    cells = np.ascontiguousarray(domain)
    seeds = _seeds(fields, cells, spacing, 2 * curvature_per_mm)
    taken = np.zeros(h.shape, dtype=np.bool_)
    lines: list[Array] = []
    step = 0.5 * min(spacing)
    for u, v in seeds:
        if taken[round(u), round(v)]:
            continue
        halves = []
        for sign in (1.0, -1.0):
            start = np.array([u, v])
            halves.append(
                _follow(fields, cells, taken, start, np.array(spacing), sign, step, curvature_per_mm)
            )
        line = np.vstack([halves[1][::-1], halves[0][1:]])
        _take(taken, line)
        if len(line) >= 3:
            lines.append(line)
    return lines


def _derivatives(h: Array, spacing: tuple[float, float], smoothing_mm: float) -> Array:
    """(5, n, m): h_u, h_v, h_uu, h_uv, h_vv of the smoothed height, per mm along the fibres."""
    sigma = [max(smoothing_mm / a, 1.0) for a in spacing]
    smooth = ndimage.gaussian_filter(h, sigma, mode="nearest")
    hu = _differ(smooth, FIRST, 0) / spacing[0]
    hv = _differ(smooth, FIRST, 1) / spacing[1]
    huu = _differ(smooth, SECOND, 0) / spacing[0] ** 2
    hvv = _differ(smooth, SECOND, 1) / spacing[1] ** 2
    return np.stack([hu, hv, huu, _differ(hu, FIRST, 1) / spacing[1], hvv])


def _differ(values: Array, weights: tuple[float, ...], axis: int) -> Array:
    """Central difference with the given weights, in grid steps."""
    return np.asarray(ndimage.correlate1d(values, weights, axis=axis, mode="nearest"))


def _seeds(fields: Array, cells: Mask, spacing: tuple[float, float], curvature: float) -> Array:
    """Ridge points near nodes, (k, 2) grid coordinates, most curved first."""
    hu, hv, huu, huv, hvv = fields
    mean, half = 0.5 * (huu + hvv), np.hypot(0.5 * (huu - hvv), huv)
    least = mean - half
    angle = 0.5 * np.arctan2(-2 * huv, hvv - huu)  # eigenvector (cos, sin) of the least eigenvalue
    eu, ev = np.cos(angle), np.sin(angle)
    offset = -(hu * eu + hv * ev) / np.where(least < 0, least, -1e-300)
    du, dv = offset * eu / spacing[0], offset * ev / spacing[1]
    inner = np.zeros(hu.shape, dtype=bool)
    inner[:-1, :-1] |= cells
    inner[1:, 1:] |= cells
    found = inner & (least < -curvature) & (np.abs(du) <= 0.6) & (np.abs(dv) <= 0.6)
    i, j = np.nonzero(found)
    order = np.argsort(least[i, j], kind="stable")
    n, m = hu.shape
    u = np.clip(i + du[i, j], 0, n - 1)[order]
    v = np.clip(j + dv[i, j], 0, m - 1)[order]
    return np.stack([u, v], axis=1)


@njit(cache=True)
def _derivatives_at(fields: Array, u: float, v: float) -> Array:
    """The five derivatives at grid coordinates (u, v), bilinear."""
    n, m = fields.shape[1:]
    i = min(max(int(u), 0), n - 2)
    j = min(max(int(v), 0), m - 2)
    s, t = u - i, v - j
    d = np.empty(5)
    for f in range(5):
        low = (1 - s) * fields[f, i, j] + s * fields[f, i + 1, j]
        high = (1 - s) * fields[f, i, j + 1] + s * fields[f, i + 1, j + 1]
        d[f] = (1 - t) * low + t * high
    return d


@njit(cache=True)
def _along(d: Array) -> tuple[float, float]:
    """Unit direction along the ridge: across the eigenvector of the Hessian's least eigenvalue."""
    angle = 0.5 * np.arctan2(-2 * d[3], d[4] - d[2])
    return -np.sin(angle), np.cos(angle)


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

    The direction is a running mean of the eigenvector and the way travelled. Where the ridge falls off
    steeply, at its ends, a small fault of direction moves the summit of the section far to its side: the
    direction is then held, by a rate 1 / (1 + (L / HOLD_MM)^2), L = |slope along| / |curvature across|.
    """
    n, m = taken.shape
    limit = int(4 * (n + m) * max(spacing[0], spacing[1]) / step)
    back = max(int(LOOK_BACK_MM / step), 2)
    line = np.empty((limit, 2))
    line[0] = start
    u, v = start
    tu, tv = _along(_derivatives_at(fields, u, v))
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
        line[count] = u, v
        if _turns(line, count, back, spacing):
            return line[: count - back].copy()
        d = _derivatives_at(fields, u, v)
        au, av = _along(d)
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
    b = (line[count] - line[count - back]) * spacing
    a = (line[count - back] - line[count - 2 * back]) * spacing
    return np.sum(a * b) < 0.5 * np.sqrt(np.sum(a * a) * np.sum(b * b))


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
