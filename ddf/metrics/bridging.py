"""Bridging: where the ply spans a hollow of the tool without touching it, wrinkles left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ddf.metrics.surface import Array, Mask, PlySurface, gap_field, node_area


@dataclass(frozen=True)
class Bridging:
    """Gaps to the tool; all NaN when the distance to the tool is not known."""

    gap: Array  # [mm] (n, m) distance - offset; NaN where not in the ply
    mask: Mask  # (n, m) bridging nodes: gap above the threshold, outside wrinkles
    largest_anywhere_mm: float  # [mm] largest gap, wrinkles included
    open_area_percent: float  # [%] share of the ply's area with a gap above the threshold, wrinkles included
    largest_mm: float  # [mm] largest gap outside wrinkles
    mean_mm: float  # [mm] area mean of max(gap, 0) over the whole ply
    mean_outside_wrinkles_mm: float  # [mm] the same over the area outside wrinkles
    area_percent: float  # [%] bridged share of the ply's area


def find_bridging(surface: PlySurface, wrinkle_cells: Mask | None = None, threshold_mm: float = 0.5) -> Bridging:
    """Gap of the mid-surface over its conforming place, and the share of the ply that bridges.

    A node bridges when its gap exceeds the threshold and it is not within one cell of a wrinkle cell
    (`wrinkle_cells`, (n-1, m-1)). Means count small penetration as 0 and weight nodes by initial area.
    """
    gap = gap_field(surface)
    area = node_area(surface)
    outside = (area > 0) & np.isfinite(gap)
    if not outside.any():
        nan = float("nan")
        return Bridging(gap, np.zeros(surface.shape, bool), nan, nan, nan, nan, nan, nan)
    open_gap = np.where(outside, np.maximum(gap, 0.0), 0.0)
    mean = float((open_gap * area)[outside].sum() / area[outside].sum())
    whole = float(area[outside].sum())
    largest, wide = float(open_gap.max()), float(area[outside & (gap > threshold_mm)].sum())
    if wrinkle_cells is not None:
        outside &= ~_nodes_near(wrinkle_cells)
    mask = outside & (gap > threshold_mm)
    rest = float(area[outside].sum())
    return Bridging(
        gap=gap,
        mask=mask,
        largest_anywhere_mm=largest,
        open_area_percent=100 * wide / whole,
        largest_mm=float(open_gap[outside].max(initial=0.0)),
        mean_mm=mean,
        mean_outside_wrinkles_mm=float((open_gap * area)[outside].sum() / rest) if rest > 0 else 0.0,
        area_percent=100 * float(area[mask].sum()) / whole,
    )


def _nodes_near(cells: Mask) -> Mask:
    """Nodes of the marked cells and of the cells around them, (n, m)."""
    padded = np.pad(cells, 1)
    nodes = padded[1:, 1:] | padded[:-1, 1:] | padded[1:, :-1] | padded[:-1, :-1]
    return np.asarray(ndimage.binary_dilation(nodes, np.ones((3, 3), bool)))
