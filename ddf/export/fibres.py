"""Fibre directions, shear angle and thickness of every element of a formed ply.

With t1, t2 the means of an element's opposite edges and a1, a2 its flat ones: fibres f_k = t_k/|t_k|, shear angle
g = asin(f1.f2), and the area ratio J = |t1 x t2|/(a1 a2) = l1 l2 cos g, l_k the stretch of family k.

Thickness: fibres are neither lost nor gained, so areal density times area is constant, and so is
thickness x fibre volume fraction x area. A ply that keeps its fibre volume fraction therefore has

    h = h0/J,   with fibres that do not stretch h0/cos g.

This is the usual assumption for a sheared weave (for example Long (ed.), Composites Forming Technologies, Woodhead
2007, chapter 1). Measured weaves follow it up to locking under constant pressure only roughly; the other limit is a
thickness that a mould keeps, with a fibre volume fraction 1/J times as high: `area_ratio` serves for both. Beyond
locking (45 to 60 deg, mostly in tight folds) neither holds. The solver itself keeps the thickness h0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.export.part import FormedPly

Array = NDArray[np.float64]


def element_centres(x: Array) -> Array:
    """Centres of all elements [mm], (3, n-1, m-1), from nodes (3, n, m)."""
    return np.asarray(0.25 * (x[:, 1:, 1:] + x[:, 1:, :-1] + x[:, :-1, 1:] + x[:, :-1, :-1]))


def element_fields(ply: FormedPly) -> dict[str, Array]:
    """Fields of all elements: (n-1, m-1), fibre directions (n-1, m-1, 3); NaN where the ply has no element.

    `fibre_k_angle_deg` is the direction of family k seen from above, from the tool's x axis, -180 to 180.
    """
    surface = ply.surface
    x = np.where(surface.active, surface.x, np.nan)
    t1 = 0.5 * (x[:, 1:, :-1] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, :-1, 1:])
    t2 = 0.5 * (x[:, :-1, 1:] - x[:, :-1, :-1] + x[:, 1:, 1:] - x[:, 1:, :-1])
    f1, f2 = (t / np.sqrt((t * t).sum(axis=0)) for t in (t1, t2))
    normal = np.cross(t1, t2, axis=0)
    ratio = np.sqrt((normal * normal).sum(axis=0)) / (surface.spacing[0] * surface.spacing[1])
    return {
        "fibre_1": np.moveaxis(f1, 0, -1),
        "fibre_2": np.moveaxis(f2, 0, -1),
        "fibre_1_angle_deg": np.degrees(np.arctan2(f1[1], f1[0])),
        "fibre_2_angle_deg": np.degrees(np.arctan2(f2[1], f2[0])),
        "shear_angle_deg": np.degrees(np.arcsin(np.clip((f1 * f2).sum(axis=0), -1.0, 1.0))),
        "area_ratio": ratio,
        "thickness_mm": ply.thickness_mm / np.maximum(ratio, 1e-300),
    }
