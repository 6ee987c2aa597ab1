"""Blocks of rows: the unit of parallel work and of all sums."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ddf.model import BLOCK

BLOCKS_A_SHEET = 12
LEAST_ROWS = 4


def block_rows(rows: int) -> int:
    """Rows of a block of a sheet that has so many."""
    return max(LEAST_ROWS, math.ceil(rows / BLOCKS_A_SHEET))


def row_blocks(sheets: np.ndarray) -> np.ndarray:
    """Fixed blocks of rows of every sheet."""
    blocks = []
    for k, s in enumerate(sheets):
        rows = int(s["rows"])
        size = block_rows(rows)
        blocks += [(k, low, min(low + size, rows)) for low in range(0, rows, size)]
    return np.array(blocks, dtype=BLOCK)


def block_edges(sheets: np.ndarray, blocks: np.ndarray) -> NDArray[np.int64]:
    """Where lists by blocks are cut: the first node of every block in the model, and a last number beyond all."""
    first = [int(sheets[b["sheet"]]["node"] + b["low"] * sheets[b["sheet"]]["cols"]) for b in blocks]
    return np.array([*first, np.iinfo(np.int64).max])
