"""Joining of ridge lines that go on in each other across a small gap."""

from __future__ import annotations

import numpy as np

from ddf.metrics.surface import Array

JOIN_ANGLE_DEG = 35.0


def join_lines(lines: list[Array], spacing: tuple[float, float], gap_mm: float) -> list[Array]:
    """Join lines end to end where the ends lie within `gap_mm` and both point along the gap."""
    scale = np.array(spacing)
    step = 0.5 * min(spacing)
    done: list[Array] = []
    rest = list(lines)
    while rest:
        line = rest.pop(0)
        joined = True
        while joined:
            joined = False
            for flip in (False, True):
                line = line[::-1] if flip else line
                best = _best_partner(line, rest, scale, gap_mm)
                if best is not None:
                    k, partner = best
                    rest.pop(k)
                    count = max(int(np.linalg.norm((partner[0] - line[-1]) * scale) / step), 1)
                    bridge = np.linspace(line[-1], partner[0], count, endpoint=False)[1:]
                    line = np.vstack([line, bridge, partner])
                    joined = True
        done.append(line)
    return done


def _best_partner(line: Array, rest: list[Array], scale: Array, gap_mm: float) -> tuple[int, Array] | None:
    """The nearest line that goes on from the end of `line`, turned to start there."""
    if not rest:
        return None
    ends = np.array([[other[0], other[-1]] for other in rest]) * scale
    distance = np.linalg.norm(ends - line[-1] * scale, axis=2)
    for flat in np.argsort(distance, axis=None):
        k, side = divmod(int(flat), 2)
        if distance[k, side] > gap_mm:
            return None
        partner = rest[k] if side == 0 else rest[k][::-1]
        if _goes_on(line * scale, partner * scale):
            return k, partner
    return None


def _goes_on(line: Array, partner: Array) -> bool:
    """Whether the end of `line`, the gap and the start of `partner` (mm) lie in one direction."""
    ahead = line[-1] - line[max(-8, -len(line))]
    beyond = partner[min(7, len(partner) - 1)] - partner[0]
    gap = partner[0] - line[-1]
    limit = np.cos(np.radians(JOIN_ANGLE_DEG))
    through = ahead if np.linalg.norm(gap) < 1e-9 else gap
    pairs = ((ahead, beyond), (ahead, through), (through, beyond))
    return all(float(a @ b) >= limit * float(np.linalg.norm(a) * np.linalg.norm(b)) for a, b in pairs)
