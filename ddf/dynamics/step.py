"""One step: every force explicit, fibre tension by the trapezoidal rule.

Step n, of length dt (leapfrog: v lives half a step behind x):

    1  f = shear + bending + tension + diaphragms + pressure + contact + tool  at x_n    blocks of rows
    2  y = dt f / m;  diaphragms: v <- damping v + y, x <- x + dt v                      blocks of rows
    3  plies: y <- (M + kappa K1)^-1 M y                                                 fibre lines
    4  plies: y <- (M + kappa K2)^-1 M y                                                 fibre lines
    5  plies: v <- damping v + y, x <- x + dt v                                          blocks of rows

3 and 4 change places every other step. Each phase is one parallel region; blocks and bundles of lines are
fixed, so the bits of the result do not depend on the number of threads. The design that this replaced, small
inner steps for the tension between impulses of the slow forces (r-RESPA), was built and measured first: the
impulses of stiff contact resonated with the fibres' waves, and at 5 mm a flat clamped stack lost 100 times
the work done on it to friction and fibre damping; with 14 inner steps it also cost 10 times as much.
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
from ddf.elements.tension import FAST, LINES, solve_lines, solve_rows, tension_forces
from ddf.model import (
    CONTACT_DAMPING,
    DAMPING,
    FIBRE_DAMPING,
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
    bundles1: np.ndarray  # (k, 3): sheet, first and last+1 column: lines of family 1 solved side by side
    bundles2: np.ndarray  # (k, 3): sheet, first and last+1 row: lines of family 2
    lines: np.ndarray  # (members, (6 (longest + 1) + 2) * LINES)
    turned: np.ndarray  # (members, 8 * longest * LINES)


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
        v = vectors(state.v, sheet)
        lost = tension_forces(x, v, f, bar1, bar2, sheet, model.fibre_damping, model.dt, low, high, w)
        state.ledger[b, FIBRE_DAMPING] += lost
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
    law = (model.tool_offset, model.tool_stiffness, model.tool_damping, model.tool_mass, model.tool_friction)
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
def _move(x, v, y, mass, damping, dt):
    """v <- damping v + y, x <- x + dt v, one component of a row; returns sum m v^2 before."""
    lost = 0.0
    for j in range(v.shape[0]):
        lost += mass[j] * v[j] * v[j]
        v[j] = damping * v[j] + y[j]
        x[j] += dt * v[j]
    return lost


@njit(**FAST)
def _scale(f, factor, dt):
    for j in range(f.shape[0]):
        f[j] *= dt * factor[j]


@njit(**FAST)
def _kick(model, state, b, damping):
    """Turn a block's forces into velocity changes (kept in f); diaphragms move on."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    f, inverse = vectors(state.f, sheet), scalars(model.inverse_mass, sheet)
    for i in range(block.low, block.high):
        for c in range(3):
            _scale(f[c, i], inverse[i], model.dt)
    if sheet.kind != PLY:
        lost = _move_rows(model, state, sheet, block.low, block.high, damping)
        state.ledger[b, MASS_DAMPING] += lost


@njit(**FAST)
def _move_rows(model, state, sheet, low, high, damping):
    """Move rows by the velocity changes in f; f becomes the effective force m dv/dt. Returns the energy lost."""
    x, v, f = vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet)
    mass = scalars(model.mass, sheet)
    lost = 0.0
    for i in range(low, high):
        for c in range(3):
            lost += _move(x[c, i], v[c, i], f[c, i], mass[i], damping, model.dt)
            _scale(f[c, i], mass[i], 1.0 / model.dt)
    return 0.5 * lost * (1.0 - damping * damping)


@njit(**FAST)
def _solve(model, state, work, member, family, k, low, high):
    """Trapezoidal step of fibre tension along one bundle of lines of a family."""
    sheet = model.sheets[k]
    x, y = vectors(state.x, sheet), vectors(state.f, sheet)
    inverse = scalars(model.inverse_mass, sheet)
    kappa = (0.25 + 0.5 * model.fibre_damping) * model.dt * model.dt
    longest = sheet.rows if family == 1 else sheet.cols
    rows = 6 * (longest + 1) + 2
    lines = work.lines[member, : rows * LINES].reshape((rows, LINES))
    if family == 1:
        solve_lines(x, y, inverse, scalars(model.bar1, sheet), kappa * sheet.eh1 / sheet.a1, low, high, lines)
    else:
        turned = work.turned[member, : 8 * sheet.cols * LINES].reshape((8, sheet.cols, LINES))
        bar = scalars(model.bar2, sheet)
        solve_rows(x, y, inverse, bar, kappa * sheet.eh2 / sheet.a2, low, high, turned, lines)


@njit(**FAST)
def _solve_family(model, state, work, sync, base, member, family):
    """All bundles of a family, shared among the members."""
    bundles = work.bundles1 if family == 1 else work.bundles2
    t = draw(sync, base)
    while t < bundles.shape[0]:
        _solve(model, state, work, member, family, bundles[t, 0], bundles[t, 1], bundles[t, 2])
        t = draw(sync, base)


@njit(**FAST)
def advance(member, members, sync, model, state, work, schedule, first, reach):
    """Run one step a row of `schedule` (steps, SCHEDULE); every member of the team calls it.

    first: number of the first step; reach: way that a sheet can go in a step, for what sleeps and rests [mm].
    """
    blocks = model.blocks.shape[0]
    base = 0
    for n in range(schedule.shape[0]):
        row = schedule[n]
        b = draw(sync, base)
        while b < blocks:
            _internal(model, state, row, b, work.scratch[member])
            _layers(model, state, work, b, model.dt, reach)
            if model.blocks[b].sheet == model.tool_sheet:
                _tool(model, state, work, row, b, model.dt, reach)
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
        b = draw(sync, base)
        while b < blocks:
            _collect(model, state, work, b)
            _kick(model, state, b, row[DAMPING])
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
        early = 1 + (first + n) % 2
        for family in (early, 3 - early):
            _solve_family(model, state, work, sync, base, member, family)
            base += (work.bundles1.shape[0] if family == 1 else work.bundles2.shape[0]) + members
            barrier(sync, members)
        b = draw(sync, base)
        while b < blocks:
            block = model.blocks[b]
            sheet = model.sheets[block.sheet]
            if sheet.kind == PLY:
                lost = _move_rows(model, state, sheet, block.low, block.high, row[DAMPING])
                state.ledger[b, MASS_DAMPING] += lost
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
