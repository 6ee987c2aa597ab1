"""Scratch memory of a step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ddf.contact.bed import BED
from ddf.contact.layers import NOWHERE, chunk_scratch
from ddf.contact.summit import PUSH
from ddf.contact.tool import point_scratch
from ddf.contact.tool_point import PRESS
from ddf.elements import bending, rubber, shear, squeeze
from ddf.elements.shell_membrane import membrane, shell
from ddf.elements.tension import LINES, line_scratch
from ddf.model import PLY, Model, sheet_scalars

SCRATCH_ROWS = 72


class Work(NamedTuple):
    """Scratch memory. Nothing outlives a step but what sleeps, rests, is idle: set before a call of `advance`."""

    scratch: np.ndarray  # (members, SCRATCH_ROWS * (widest + 2))
    packed: np.ndarray  # (4 N,) positions as (x, y, z, cover)
    rates: np.ndarray  # (4 N,) velocities likewise
    nothing: np.ndarray  # (N,) zeros
    normal: np.ndarray  # (N,) normal contact forces on slaves [N]
    buffers: np.ndarray  # forces on masters, one (N, M, 4) a pair and slave block
    spans: np.ndarray  # (..., 2) columns written by patches centred in each row of each buffer
    chunks: tuple[np.ndarray, np.ndarray, np.ndarray]  # from `contact.layers.chunk_scratch`
    sums: np.ndarray  # (members, 4)
    carry: np.ndarray  # (blocks, widest + 2, PRESS) row of the next block, from the tool's contact
    carried: np.ndarray  # (blocks,) bool: whether it holds anything
    shell_carry: np.ndarray  # (6, blocks, widest) row of the next block, from a shell ply's cells: forces, pulls
    press: np.ndarray  # (PRESS N,) of the tool's sheet, see `contact.tool_point`
    pressed: np.ndarray  # (n,) bool: rows of press in use
    pushes: np.ndarray  # (k, PUSH) what the tool's summits do, see `contact.summit`
    points: tuple[np.ndarray, ...]  # from `contact.tool.point_scratch`
    sleep: np.ndarray  # (n, m) int16: steps in which a cell need not look at the tool
    rest: np.ndarray  # (P,) int8: steps that a slave node rests
    idle: np.ndarray  # (pairs,) bool: pairs of self-contact in which no node is followed in this batch of steps
    bundles1: np.ndarray  # (k, 5): sheet, columns, rows (first and last+1): lines of family 1 solved side by side
    bundles2: np.ndarray  # (k, 5): sheet, rows, columns: lines of family 2
    lines: np.ndarray  # (members, `line_scratch`)
    bed: np.ndarray  # (N, BED) what bears plies' nodes, see `contact.bed`
    borne: np.ndarray  # (N,) bool: whether it does
    bed_sleep: np.ndarray  # (N,) int16: steps in which a ply's node need not look at the tool
    aside: np.ndarray  # (ghosts + nodes on the plane, 3): forces set aside, see `dynamics.mirror`
    pressed_before: np.ndarray  # (ghosts + nodes on the plane,) mean contact forces before the step


def make_work(model: Model, members: int) -> Work:
    """Scratch memory for a team of `members` threads."""
    widest = int(model.sheets["cols"].max()) + 2
    buffers = spans = 0
    for pair in model.pairs:
        n, m = (int(model.sheets[pair["master"]][key]) for key in ("rows", "cols"))
        blocks = int(np.sum(model.blocks["sheet"] == pair["slave"]))
        buffers = max(buffers, int(pair["buffer"]) + 4 * n * m * blocks)
        spans = max(spans, int(pair["span"]) + n * blocks)
    bundles = [_bundles(model, family) for family in (1, 2)]
    tiled = (bending, rubber, shear, squeeze, membrane, shell)
    longest = int(max(model.sheets["rows"].max(), model.sheets["cols"].max()))
    bottom, mirrored = model.sheets[0], len(model.ghosts) + len(model.plane)
    return Work(
        scratch=np.zeros((members, max(SCRATCH_ROWS * widest, *(part.SCRATCH for part in tiled)))),
        packed=np.zeros(4 * model.mass.size), rates=np.zeros(4 * model.mass.size),
        nothing=np.zeros(model.mass.size), normal=np.zeros(model.mass.size),
        buffers=np.zeros(buffers), spans=np.tile(np.array([NOWHERE, 0]), (spans, 1)),
        chunks=chunk_scratch(members), sums=np.zeros((members, 4)), carry=np.zeros((model.blocks.size, widest, PRESS)),
        shell_carry=np.zeros((6, model.blocks.size, widest)),
        carried=np.zeros(model.blocks.size, bool), press=np.zeros(PRESS * int(bottom["rows"] * bottom["cols"])),
        pressed=np.zeros(int(bottom["rows"]), bool), points=point_scratch(members, int(bottom["cols"])),
        pushes=np.full((model.summits.shape[0], PUSH), -1.0),
        sleep=np.zeros((int(bottom["rows"]), int(bottom["cols"])), np.int16),
        rest=np.zeros(model.exposed.size, np.int8), idle=np.zeros(model.pairs.size, bool),
        bundles1=bundles[0], bundles2=bundles[1], lines=np.zeros((members, line_scratch(longest))),
        bed=np.zeros((model.mass.size, BED)), borne=np.zeros(model.mass.size, bool),
        bed_sleep=np.zeros(model.mass.size, np.int16),
        aside=np.zeros((mirrored, 3)), pressed_before=np.zeros(mirrored),
    )  # fmt: skip


def _bundles(model: Model, family: int) -> np.ndarray:
    """Fibre lines to be solved side by side, and the nodes along them between which there are bars: (k, 5)."""
    found = []
    for k in np.flatnonzero(model.sheets["kind"] == PLY):
        bars = sheet_scalars(model, model.bar1 if family == 1 else model.bar2, int(k)) > 0.0
        bars = bars if family == 1 else bars.T
        for a in range(0, bars.shape[1], LINES):
            b = min(a + LINES, bars.shape[1])
            there = np.flatnonzero(bars[:, a:b].any(axis=1))
            if there.size:
                found.append((int(k), a, b, there[0], there[-1] + 2))
    return np.array(found, np.int64).reshape(-1, 5)
