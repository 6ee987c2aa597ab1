"""A strip folded over, as a start for scenes of self-contact."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ddf.verify.bench import Bench, assemble
from ddf.verify.bench_sheets import FloatArray, Sheet, Touch, constant_load
from ddf.verify.problem import Options


def hairpin(
    cells: int, width: int, element: float, flank: float, radius: float, middle: float | None = None
) -> FloatArray:
    """A strip (3, cells+1, width+1): a flank of that length, a half circle, a flank back above; normals inwards.

    middle: radius at which the half circle has the strip's length, if not its own [mm].
    """
    s, middle = np.arange(cells + 1) * element, radius if middle is None else middle
    angle = np.clip((s - flank) / middle, 0.0, np.pi)
    x = np.minimum(s, flank) + radius * np.sin(angle) - np.maximum(s - flank - np.pi * middle, 0.0)
    z = radius * (1.0 - np.cos(angle))
    y = np.arange(width + 1) * element
    return np.array([np.tile(x[:, None], (1, y.size)), np.tile(y, (s.size, 1)), np.tile(z[:, None], (1, y.size))])


def folded_sheet(options: Options, make: Callable[..., Sheet], friction: float, pressed: float) -> Bench:
    """A free sheet of 20 x 7 cells of 4 mm, folded over 6 mm, that touches itself just above the flanks' distance.

    pressed: how deep the flanks lie in each other [mm].
    """
    cells, width, element, radius = 20, 7, 4.0, 6.0
    sheet = make(options, (np.arange(cells + 1) * element, np.arange(width + 1) * element))
    middle = 0.5 * element / math.asin(0.5 * element / radius)  # so that bars in the bend keep their length
    sheet.start[:] = hairpin(cells, width, element, 30.0, radius, middle)
    own = [Touch(0, 0, sign, friction, 0.5, offset=2.0 * radius + pressed) for sign in (1.0, -1.0)]
    bench = assemble([sheet], constant_load(), own)
    bench.model.sheets["fold_radius"] = radius
    return bench
