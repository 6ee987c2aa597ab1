"""The multi-rate explicit step (r-RESPA): slow forces once, fibre tension in small inner steps.

Outer step n, of length dt:

    1  f = shear + bending + diaphragms + pressure + contact + tool       at x_n      blocks of rows
    2  v <- damping v + dt f / m;  diaphragms drift: x <- x + dt v                    blocks of rows
    3  plies: `inner` steps of dt/inner of fibre tension and drift                    tiles of rows

Each phase is one parallel region. Blocks are fixed, tiles carry halos: the bits of the result do not depend
on the number of threads. The scheme is symplectic but for the stated dissipations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from ddf.contact.layers import clear_buffer, layer_forces
from ddf.contact.tool import tool_forces
from ddf.dynamics.team import barrier, draw
from ddf.elements.bending import bending_forces
from ddf.elements.plate import plate_forces
from ddf.elements.rubber import rubber_forces
from ddf.elements.shear import shear_forces
from ddf.elements.tension import FAST, inner_steps
from ddf.model import (
    CONTACT_DAMPING,
    DAMPING,
    FRICTION,
    MASS_DAMPING,
    NORMAL_SPRING,
    PLY,
    TANGENTIAL_SPRING,
    TOOL_DAMPING,
    TOOL_FRICTION,
    TOOL_NORMAL_SPRING,
    TOOL_SPEED,
    TOOL_TANGENTIAL_SPRING,
    TOOL_WORK,
    TOOL_Z,
    Model,
    State,
    scalars,
    vectors,
)

SCRATCH_ROWS = 72


class Work(NamedTuple):
    """Scratch memory: nothing in it outlives a step, but for `sleep` and `rest`, which are set before every call of `advance`."""

    scratch: np.ndarray  # (members, SCRATCH_ROWS * (widest + 2))
    buffers: np.ndarray  # forces on masters, one (3, N, M) a pair and slave block
    spans: np.ndarray  # (..., 2) columns written in each row of each buffer
    carry: np.ndarray  # (blocks, 3, widest + 2) row of the next block
    sleep: np.ndarray  # (n-1, m-1) int16: steps that a cell of the tool's sheet sleeps
    rest: np.ndarray  # (P,) int8: steps that a slave node rests
    tiles: np.ndarray  # (tiles, 5): sheet, low, high, first row with halo, end
    tile_x: np.ndarray  # pools of the tiles, halo included
    tile_v: np.ndarray
    tile_green1: np.ndarray
    tile_green2: np.ndarray
    tile_first: np.ndarray  # (tiles,) first node of a tile in these pools
    wave: np.ndarray  # (tiles, (2 inner + 2) * 3 * (widest + 2))
    lost: np.ndarray  # (tiles,) axial viscosity, cumulative over one call [N mm]


@njit(**FAST)
def _internal(model, state, row, b, scratch):
    """Internal forces and pressure of a block's rows; they are cleared first."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, f = vectors(state.x, sheet), vectors(state.f, sheet)
    low, high = block.low, block.high
    w = scratch[: SCRATCH_ROWS * (sheet.cols + 2)].reshape((SCRATCH_ROWS, sheet.cols + 2))
    f[:, low:high] = 0.0
    if sheet.kind == PLY:
        bar1, bar2, cell = scalars(model.bar1, sheet), scalars(model.bar2, sheet), scalars(model.cell, sheet)
        shear_forces(x, f, cell, model.shear_tables[sheet.shear], low, high, w)
        triple1, triple2 = scalars(model.triple1, sheet), scalars(model.triple2, sheet)
        bending_forces(x, f, bar1, bar2, triple1, triple2, sheet, low, high, w)
    else:
        dx = model.lines[sheet.line : sheet.line + sheet.rows - 1]
        dy = model.lines[sheet.line + sheet.rows - 1 : sheet.line + sheet.rows + sheet.cols - 2]
        rubber_forces(x, f, dx, dy, sheet, model.ogden, row[sheet.face], low, high, w)
        if sheet.rigidity > 0.0:
            plate_forces(x, f, dx, dy, sheet.rigidity, low, high, w)


@njit(inline="always")
def _first_block(model, k):
    """First block of sheet k."""
    b = 0
    while model.blocks[b].sheet != k:
        b += 1
    return b


@njit(inline="always")
def _buffer(work, model, pair, index):
    """Master force buffer and row spans of a pair for its slave's block number `index`."""
    master = model.sheets[pair.master]
    size = 3 * master.rows * master.cols
    start = pair.buffer + index * size
    buffer = work.buffers[start : start + size].reshape((3, master.rows, master.cols))
    span = work.spans[pair.span + index * master.rows : pair.span + (index + 1) * master.rows]
    return buffer, span


@njit(**FAST)
def _layers(model, state, work, b, dt, reach):
    """Forces of all pairs in which the block's sheet is the slave."""
    block = model.blocks[b]
    index = b - _first_block(model, block.sheet)
    out = np.zeros(4)
    for k in range(model.pairs.shape[0]):
        pair = model.pairs[k]
        if pair.slave != block.sheet:
            continue
        slave, master = model.sheets[pair.slave], model.sheets[pair.master]
        buffer, span = _buffer(work, model, pair, index)
        clear_buffer(buffer, span)
        n = slave.rows * slave.cols
        shape = (2, slave.rows, slave.cols)
        first = pair.first
        layer_forces(
            vectors(state.x, slave), vectors(state.v, slave), vectors(state.f, slave), scalars(model.area, slave),
            vectors(state.x, master), vectors(state.v, master), scalars(model.cell, master),
            model.centre[2 * master.node : 2 * (master.node + master.rows * master.cols)].reshape(
                (master.rows, master.cols, 2)
            ),
            state.place[2 * first : 2 * (first + n)].reshape(shape),
            state.anchor[2 * first : 2 * (first + n)].reshape(shape),
            work.rest[first : first + n].reshape((slave.rows, slave.cols)),
            buffer, span, pair, reach, dt, block.low, block.high, out,
        )  # fmt: skip
    state.springs[b, NORMAL_SPRING] = out[0]
    state.springs[b, TANGENTIAL_SPRING] = out[1]
    state.ledger[b, FRICTION] += out[2]
    state.ledger[b, CONTACT_DAMPING] += out[3]


@njit(**FAST)
def _tool(model, state, work, row, b, dt, reach):
    """Forces of the tool on a block of its sheet."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    dx = model.lines[sheet.line : sheet.line + sheet.rows - 1]
    dy = model.lines[sheet.line + sheet.rows - 1 : sheet.line + sheet.rows + sheet.cols - 2]
    carry = work.carry[b]
    carry[:] = 0.0
    out = np.zeros(4)
    law = (model.tool_offset, model.tool_stiffness, model.tool_damping, model.tool_friction)
    done = tool_forces(
        vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet), carry, dx, dy,
        model.tool, model.tool_origin, model.tool_spacing, law, (row[TOOL_Z], row[TOOL_SPEED]), reach, dt,
        state.tool_anchor, work.sleep, block.low, block.high, out,
    )  # fmt: skip
    state.springs[b, TOOL_NORMAL_SPRING] = out[0]
    state.springs[b, TOOL_TANGENTIAL_SPRING] = out[1]
    state.ledger[b, TOOL_FRICTION] += out[2]
    state.ledger[b, TOOL_DAMPING] += out[3]
    state.ledger[b, TOOL_WORK] += done


@njit(**FAST)
def _collect(model, state, work, b):
    """Add what other blocks put on this block's rows: master buffers, then the tool's carried row."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    f = vectors(state.f, sheet)
    for k in range(model.pairs.shape[0]):
        pair = model.pairs[k]
        if pair.master != block.sheet:
            continue
        first = _first_block(model, pair.slave)
        index = 0
        while first + index < model.blocks.shape[0] and model.blocks[first + index].sheet == pair.slave:
            buffer, span = _buffer(work, model, pair, index)
            for i in range(block.low, block.high):
                j0, j1 = span[i, 0], span[i, 1]
                for c in range(3):
                    for j in range(j0, j1):
                        f[c, i, j] += buffer[c, i, j]
            index += 1
    if block.sheet == model.tool_sheet and block.low > 0:
        for c in range(3):
            for j in range(sheet.cols):
                f[c, block.low, j] += work.carry[b - 1, c, j]


@njit(**FAST)
def _kick_row(v, f, inverse_mass, damping, dt):
    for j in range(v.shape[0]):
        v[j] = damping * v[j] + dt * inverse_mass[j] * f[j]


@njit(**FAST)
def _kick(model, state, b, damping, dt):
    """Kick a block's rows with the slow forces; diaphragms drift as well."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, v, f = vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet)
    mass, inverse = scalars(model.mass, sheet), scalars(model.inverse_mass, sheet)
    lost = 0.0
    for i in range(block.low, block.high):
        for c in range(3):
            vv = v[c, i]
            for j in range(sheet.cols):
                lost += mass[i, j] * vv[j] * vv[j]
            _kick_row(vv, f[c, i], inverse[i], damping, dt)
            if sheet.kind != PLY:
                xx = x[c, i]
                for j in range(sheet.cols):
                    xx[j] += dt * vv[j]
    state.ledger[b, MASS_DAMPING] += 0.5 * lost * (1.0 - damping * damping)


@njit(inline="always")
def _tile_views(work, model, t):
    """Tile t's copies of x, v, green1, green2."""
    sheet = model.sheets[work.tiles[t, 0]]
    rows = work.tiles[t, 4] - work.tiles[t, 3]
    a = work.tile_first[t]
    n = rows * sheet.cols
    shape = (rows, sheet.cols)
    return (
        work.tile_x[3 * a : 3 * (a + n)].reshape((3, rows, sheet.cols)),
        work.tile_v[3 * a : 3 * (a + n)].reshape((3, rows, sheet.cols)),
        work.tile_green1[a : a + n].reshape(shape),
        work.tile_green2[a : a + n].reshape(shape),
    )


@njit(**FAST)
def _load_tile(model, state, work, t):
    """Copy a tile with its halo."""
    sheet = model.sheets[work.tiles[t, 0]]
    a, b = work.tiles[t, 3], work.tiles[t, 4]
    x, v, g1, g2 = _tile_views(work, model, t)
    x[:] = vectors(state.x, sheet)[:, a:b]
    v[:] = vectors(state.v, sheet)[:, a:b]
    g1[:] = scalars(state.green1, sheet)[a:b]
    g2[:] = scalars(state.green2, sheet)[a:b]


@njit(**FAST)
def _advance_tile(model, state, work, t, dt):
    """Inner steps of a tile, written back to its own rows."""
    k = work.tiles[t, 0]
    sheet = model.sheets[k]
    low, high, a, b = work.tiles[t, 1], work.tiles[t, 2], work.tiles[t, 3], work.tiles[t, 4]
    x, v, g1, g2 = _tile_views(work, model, t)
    first = model.row_first[k]
    waves, width = 2 * model.inner + 2, sheet.cols + 2
    wave = work.wave[t, : waves * 3 * width].reshape((waves, 3, width))
    work.lost[t] += inner_steps(
        x, v, scalars(model.bar1, sheet)[a:b], scalars(model.bar2, sheet)[a:b], scalars(model.inverse_mass, sheet)[a:b],
        g1, g2, model.row_span[first + a : first + b], sheet, (low - a, high - a, a == 0, b == sheet.rows),
        model.inner, dt / model.inner, wave,
    )  # fmt: skip
    vectors(state.x, sheet)[:, low:high] = x[:, low - a : high - a]
    vectors(state.v, sheet)[:, low:high] = v[:, low - a : high - a]
    scalars(state.green1, sheet)[low:high] = g1[low - a : high - a]
    scalars(state.green2, sheet)[low:high] = g2[low - a : high - a]


@njit(**FAST)
def advance(member, members, sync, model, state, work, schedule, reach):
    """Run one outer step a row of `schedule` (steps, SCHEDULE); every member of the team calls it.

    reach: way that a sheet can go in a step, for what sleeps and rests [mm].
    """
    blocks, tiles = model.blocks.shape[0], work.tiles.shape[0]
    dt = model.dt
    base = 0
    for n in range(schedule.shape[0]):
        row = schedule[n]
        b = draw(sync, base)
        while b < blocks:
            _internal(model, state, row, b, work.scratch[member])
            _layers(model, state, work, b, dt, reach)
            if model.blocks[b].sheet == model.tool_sheet:
                _tool(model, state, work, row, b, dt, reach)
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
        b = draw(sync, base)
        while b < blocks:
            _collect(model, state, work, b)
            _kick(model, state, b, row[DAMPING], dt)
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
        t = draw(sync, base)
        while t < tiles:
            _load_tile(model, state, work, t)
            t = draw(sync, base)
        base += tiles + members
        barrier(sync, members)
        t = draw(sync, base)
        while t < tiles:
            _advance_tile(model, state, work, t, dt)
            t = draw(sync, base)
        base += tiles + members
        barrier(sync, members)
