"""The grid of a diaphragm: a tensor grid, fine under the plies and graded outward to the frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ddf.errors import MeshError
from ddf.mesh.grid import Block, block_lines, mesh_grid

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class DiaphragmMesh:
    """A tensor grid of n x m nodes; the first index runs along x, the second along y."""

    x_lines: FloatArray
    """Grid lines along x, (n,) [mm]."""
    y_lines: FloatArray
    """Grid lines along y, (m,) [mm]."""
    x: FloatArray
    """Positions (3, n, m) [mm], z = 0."""


def mesh_diaphragm(
    length_mm: float,
    width_mm: float,
    fine_box: tuple[float, float, float, float],
    element_mm: float,
    element_max_mm: float,
    growth: float,
    even: bool = False,
) -> DiaphragmMesh:
    """Grid of a diaphragm clamped at x = +-length/2, y = +-width/2 [mm].

    Inside `fine_box` (xmin, xmax, ymin, ymax) [mm] cells are uniform and at most `element_mm`; outside each
    is at most `growth` times the one before, up to `element_max_mm`. The box is widened to the frame on a
    side where too little is left to grade. The grid is exactly symmetric if the box is; with `even` it has an
    even number of cells along x and y. Raises MeshError for a box that leaves the frame or a growth below 1.
    """
    if not 0.0 < element_mm <= element_max_mm or not growth >= 1.0:
        raise MeshError(
            f"diaphragm: element_mm {element_mm}, element_max_mm {element_max_mm}, growth {growth}",
            "they must satisfy 0 < element_mm <= element_max_mm and growth >= 1",
        )
    x_min, x_max, y_min, y_max = fine_box
    x_blocks = _graded_blocks(length_mm / 2, x_min, x_max, element_mm, element_max_mm, growth, even)
    y_blocks = _graded_blocks(width_mm / 2, y_min, y_max, element_mm, element_max_mm, growth, even)
    mesh_grid(x_blocks, y_blocks, 0.0, "diaphragm")
    x_lines = _symmetrised(block_lines(x_blocks))
    y_lines = _symmetrised(block_lines(y_blocks))
    x = np.zeros((3, x_lines.size, y_lines.size))
    x[0], x[1] = x_lines[:, None], y_lines[None, :]
    return DiaphragmMesh(x_lines, y_lines, x)


def _symmetrised(lines: FloatArray) -> FloatArray:
    """The lines, made symmetric to the last bit if they are but for rounding."""
    if np.abs(lines + lines[::-1]).max() < 1e-9 * lines[-1]:
        return 0.5 * (lines - lines[::-1])
    return lines


def _graded_blocks(
    half: float, low: float, high: float, element: float, largest: float, growth: float, even: bool
) -> list[Block]:
    """Blocks from -half to half [mm] along one direction: capped, graded, uniform, graded, capped."""
    if not -half - 1e-9 <= low < high <= half + 1e-9:
        raise MeshError(
            f"diaphragm: the fine box from {low:.4g} to {high:.4g} mm leaves the frame of +-{half:.4g} mm",
            "make the frame larger or the plies smaller",
        )
    while True:
        cells = max(1, int(np.ceil((high - low) / element - 1e-9)))
        cells += cells % 2 if even else 0
        actual = (high - low) / cells
        left = _grade(low + half, actual, largest, growth)
        right = _grade(half - high, actual, largest, growth)
        widen_left, widen_right = not left and low > -half, not right and high < half
        if not widen_left and not widen_right:
            break
        low, high = (-half if widen_left else low), (half if widen_right else high)
    blocks = [Block(low, high, cells)]
    for side, sizes in ((-1.0, left), (1.0, right)):
        for count, first, ratio in sizes:
            end = blocks[0].start if side < 0 else blocks[-1].stop
            total = float(np.sum(first * ratio ** np.arange(count)))
            if side < 0:
                blocks.insert(0, Block(end - total, end, count, 1.0 / ratio))
            else:
                blocks.append(Block(end, end + total, count, ratio))
    return _pinned(blocks, half)


def _pinned(blocks: list[Block], half: float) -> list[Block]:
    """The blocks with their outer ends exactly on the frame (the sums above are off by rounding)."""
    blocks[0] = replace(blocks[0], start=-half)
    blocks[-1] = replace(blocks[-1], stop=half)
    return blocks


def _grade(length: float, element: float, largest: float, growth: float) -> tuple[tuple[int, float, float], ...]:
    """Runs of cells (count, first size, ratio) that fill `length` [mm] outward from cells of `element` [mm].

    k graded cells a r, a r^2, ... a r^k, then p cells of a r^k, with the fewest cells for which some ratio
    1 <= r <= growth gives sum a r^i + p a r^k = length and a r^k <= largest. Empty if there is none.
    """
    if length <= 1e-9 * element:
        return ()
    graded = int(np.ceil(np.log(largest / element) / np.log(growth) - 1e-9)) if growth > 1.0 else 0
    growth = (largest / element) ** (1.0 / graded) if graded else 1.0

    def total(ratio: float, count: int) -> float:
        powers = element * ratio ** np.arange(1, min(graded, count) + 1)
        cap = powers[-1] if powers.size else element
        return float(powers.sum() + max(count - graded, 0) * cap)

    count = 1
    while total(growth, count) < length * (1 - 1e-12):
        count += 1
    if count * element > length * (1 + 1e-9):
        return ()
    ratio = growth
    if total(growth, count) > length:
        ratio = float(brentq(lambda r: total(r, count) - length, 1.0 - 1e-6, growth, xtol=1e-15))
    rising = min(graded, count)
    runs = []
    if rising:
        runs.append((rising, element * ratio, ratio))
    if count > rising:
        runs.append((count - rising, element * ratio**rising, 1.0))
    return tuple(runs)
