"""A strip of diaphragm folded over, its ends held, that pressure from outside closes."""

from __future__ import annotations

import dataclasses

import numpy as np

from ddf.verify.bench import Bench, assemble
from ddf.verify.bench_sheets import Touch, fabric_sheet, ramped_load, rubber_sheet
from ddf.verify.folded import hairpin
from ddf.verify.problem import Options

CELLS, WIDTH, ELEMENT = 30, 4, 2.0
STIFFNESS, RAMP = 0.5, 0.006


def folded_strip(pressure: float, friction: float = 0.0, touches: bool = True, damping: float = 300.0) -> Bench:
    """Flanks 24 mm long and 8 mm apart; pressure [MPa] on their outer faces, reached in RAMP seconds."""
    lines = (np.arange(CELLS + 1) * ELEMENT, np.arange(WIDTH + 1) * ELEMENT)
    held = np.zeros((CELLS + 1, WIDTH + 1), bool)
    held[:2] = held[-2:] = True
    sheet = rubber_sheet(Options(), lines, held, bending=True)
    sheet = dataclasses.replace(sheet, start=hairpin(CELLS, WIDTH, ELEMENT, 24.0, 4.0))
    own = [Touch(0, 0, sign, friction, 0.5 * STIFFNESS) for sign in (1.0, -1.0)]
    bench = assemble([sheet], ramped_load([0.0, RAMP, 1.0], [0.0, pressure, pressure], damping), own if touches else ())
    bench.model.sheets["fold_radius"] = 1.2 * sheet.thickness
    return bench


def folded_stack(pressure: float, touches: bool = True) -> Bench:
    """A ply between two diaphragms, folded over; pressure [MPa] on both diaphragms, towards the inside of the fold."""
    cells, flank, radius = 34, 24.0, 6.0
    lines = (np.arange(cells + 1) * ELEMENT, np.arange(WIDTH + 1) * ELEMENT)
    held = np.zeros((cells + 1, WIDTH + 1), bool)
    held[:2] = held[-2:] = True
    made = (
        rubber_sheet(Options(), lines, held, bending=True), fabric_sheet(Options(), lines, held),
        rubber_sheet(Options(), lines, held, bending=True),
    )  # fmt: skip
    apart = 0.5 * (made[0].thickness + made[1].thickness)
    sheets = []
    for k, sheet in enumerate(made):
        start = hairpin(cells, WIDTH, ELEMENT, flank, radius + apart * (1 - k), radius)
        start[2] += apart * k
        sheets.append(dataclasses.replace(sheet, start=start))
    pairs = [Touch(1, 0, 1.0, 0.5), Touch(1, 2, -1.0, 0.5)]
    if touches:
        pairs += [Touch(k, k, sign, 0.5, 0.5 * STIFFNESS) for k in range(3) for sign in (1.0, -1.0)]
    bench = assemble(sheets, ramped_load([0.0, RAMP, 1.0], [0.0, pressure, pressure], 300.0), pairs)
    bench.model.sheets["fold_radius"] = [1.8, 0.9, 1.8]
    return bench


def quads(cells: int = CELLS) -> np.ndarray:
    """Node numbers (q, 4) of the strip's cells."""
    number = np.arange((cells + 1) * (WIDTH + 1)).reshape(cells + 1, WIDTH + 1)
    return np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
