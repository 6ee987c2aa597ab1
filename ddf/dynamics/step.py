"""One step: explicit forces, the tool's implicit at its nodes, fibre tension implicit along the fibre lines.

Step n, of length dt (leapfrog: v lives half a step behind x):

    1  f = gravity + shear + bending + folds + diaphragms + squeeze + pressure + contact    blocks of rows
    2  v <- exp(-damping dt) v + dt f / m;  diaphragms: x <- x + dt v                       blocks of rows
       (not the sheet that meets the tool)
    3  plies: v and kept tensions corrected along family 1 (`elements.tension`)             fibre lines
       what the tool does to its sheet, f of which is known                                 blocks of rows
    4  plies: the same along family 2                                                       fibre lines
       tool's sheet: f <- m (m + J)^-1 (f + tool), then as 2 (`contact.tool`)               blocks of rows
    5, 6  as 3, 4, with the string's step
    7  plies: x <- x + dt v                                                                 blocks of rows

2 ends, for plies, with the impulses of the tensions kept from the last step. The families change places every other
step. A ply that itself meets the tool (in problems of verification) is acted on before 3. Each phase is one parallel
region; blocks and bundles of lines are fixed, so the bits of the result do not depend on the number of threads.

Two other ways were built and measured before. Small inner steps of the tension between impulses of the other
forces (r-RESPA), 14 of them: a flat clamped stack at 5 mm lost fifty times the work done on it to fibre damping
(with 5 inner steps two fifths of it), which looks like resonance of the impulses with the fibres' waves. The
trapezoidal rule with both families factored into one operator went unstable as soon as the ply was curved.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from ddf.contact.layers import clear_buffer, collect_row, layer_forces, pack_rows, touched
from ddf.contact.self_contact import drop_near
from ddf.contact.summit import add_pushes, summit_forces
from ddf.contact.tool import PRESS, settle_row, tool_forces
from ddf.dynamics.team import barrier, draw
from ddf.elements.bending import bending_forces
from ddf.elements.fold import fold_forces, fold_lattice_forces
from ddf.elements.plate import plate_forces
from ddf.elements.rubber import rubber_forces
from ddf.elements.shear import shear_forces
from ddf.elements.shell_membrane import membrane, shell
from ddf.elements.shell_membrane.history import HISTORY
from ddf.elements.shell_membrane.rotations import turn_row
from ddf.elements.squeeze import SHARE, squeeze_forces
from ddf.elements.tension import LINES, pull_kept, pull_lines, pull_rows
from ddf.jit import FAST, INLINE
from ddf.materials.shear_law import TANGENT_SPAN
from ddf.model import (
    CONTACT_DAMPING,
    DAMPING,
    FIBRE_WORK,
    FRICTION,
    MASS_DAMPING,
    NORMAL_SPRING,
    PLY,
    SHELL_PLY,
    SQUEEZE_WORK,
    TANGENTIAL_SPRING,
    TOOL_DAMPING,
    TOOL_FRICTION,
    TOOL_NORMAL_SPRING,
    TOOL_SPEED,
    TOOL_TANGENTIAL_SPRING,
    TOOL_WORK,
    TOOL_Z,
    fours,
    scalars,
    shell_fields,
    vectors,
)

SCRATCH_ROWS = 72


class Work(NamedTuple):
    """Scratch memory. Nothing outlives a step but `sleep`, `rest` and `idle`, set before every call of `advance`."""

    scratch: np.ndarray  # (members, SCRATCH_ROWS * (widest + 2))
    packed: np.ndarray  # (4 N,) positions as (x, y, z, cover)
    rates: np.ndarray  # (4 N,) velocities likewise
    nothing: np.ndarray  # (N,) zeros
    normal: np.ndarray  # (N,) normal contact forces on slaves [N]
    buffers: np.ndarray  # forces on masters, one (N, M, 4) a pair and slave block
    spans: np.ndarray  # (..., 2) columns written by patches centred in each row of each buffer
    chunks: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]  # from `contact.layers.chunk_scratch`
    sums: np.ndarray  # (members, 4)
    carry: np.ndarray  # (blocks, widest + 2, PRESS) row of the next block, from the tool's contact
    carried: np.ndarray  # (blocks,) bool: whether it holds anything
    shell_carry: np.ndarray  # (6, blocks, widest) row of the next block, from a shell ply's cells: forces, pulls
    press: np.ndarray  # (PRESS N,) of the tool's sheet, see `contact.tool`
    pressed: np.ndarray  # (n,) bool: rows of press in use
    pushes: np.ndarray  # (k, PUSH) what the tool's summits do, see `contact.summit`
    give: np.ndarray  # (members, PRESS)
    sleep: np.ndarray  # (n, m) int16: steps in which a cell need not look at the tool
    rest: np.ndarray  # (P,) int8: steps that a slave node rests
    idle: np.ndarray  # (pairs,) bool: pairs of self-contact in which no node is followed in this batch of steps
    bundles1: np.ndarray  # (k, 3): sheet, first and last+1 column: lines of family 1 solved side by side
    bundles2: np.ndarray  # (k, 3): sheet, first and last+1 row: lines of family 2
    lines: np.ndarray  # (members, (6 (longest + 1) + 2) * LINES)
    turned: np.ndarray  # (members, 9 * longest * LINES)


@njit(**FAST)
def largest_square(v):
    """Largest squared speed of a vector array (3, n, m); NaN if any component is."""
    top = 0.0
    for i in range(v.shape[1]):
        for j in range(v.shape[2]):
            s = v[0, i, j] ** 2 + v[1, i, j] ** 2 + v[2, i, j] ** 2
            if not s <= top:
                top = s
    return top


@njit(**FAST)
def _weigh_row(f, gravity, mass):
    """F <- m g, one component of a row."""
    for j in range(f.shape[0]):
        f[j] = gravity * mass[j]


@njit(**FAST)
def _internal(model, state, work, row, b, scratch):
    """Gravity, internal forces and pressure of a block's rows; what was there is overwritten."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, f = vectors(state.x, sheet), vectors(state.f, sheet)
    low, high = block.low, block.high
    w = scratch[: SCRATCH_ROWS * (sheet.cols + 2)].reshape((SCRATCH_ROWS, sheet.cols + 2))
    mass = scalars(model.mass, sheet)
    for i in range(low, high):
        for c in range(3):
            _weigh_row(f[c, i], model.gravity[c], mass[i])
    if sheet.squeeze > 0.0:
        power = squeeze_forces(
            x, vectors(state.v, sheet), f, scalars(model.cell, sheet), scalars(state.press, sheet), sheet.squeeze,
            low, high, scratch,
        )  # fmt: skip
        state.ledger[b, SQUEEZE_WORK] += model.dt * power
    if sheet.kind == PLY:
        shear_forces(x, f, scalars(model.cell, sheet), model.shear_tables[sheet.shear], low, high, scratch)
        triple1, triple2 = scalars(model.triple1, sheet), scalars(model.triple2, sheet)
        bending_forces(x, f, fours(model.weight, sheet), triple1, triple2, sheet, low, high, scratch)
        if sheet.fold_radius > 0.0:
            fold_lattice_forces(
                x, f, triple1, triple2, sheet.a1, sheet.a2, sheet.hourglass, sheet.fold_radius, low, high, w
            )
    elif sheet.kind == SHELL_PLY:
        _shell_membrane(model, state, work.shell_carry, b, scratch)
    else:
        dx = model.lines[sheet.line : sheet.line + sheet.rows - 1]
        dy = model.lines[sheet.line + sheet.rows - 1 : sheet.line + sheet.rows + sheet.cols - 2]
        rubber_forces(x, f, dx, dy, sheet, model.ogden, row[sheet.face], low, high, w)
        if sheet.rigidity > 0.0:
            plate_forces(x, f, dx, dy, sheet.rigidity, low, high, w)
        if sheet.fold_radius > 0.0:
            fold_forces(x, f, dx, dy, sheet.hourglass, sheet.fold_radius, low, high, w)


@njit(**FAST)
def _shell_membrane(model, state, carry, b, scratch):
    """Membrane, shell and folds of a block of a shell ply; what belongs to the next block's first row goes to carry."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, f, cell = vectors(state.x, sheet), vectors(state.f, sheet), scalars(model.cell, sheet)
    past = shell_fields(state.history, sheet, HISTORY)
    low, high = block.low, block.high
    carry[:, b] = 0.0
    done = membrane.membrane_forces(
        x, f, past, cell, model.tangents[sheet.shear], TANGENT_SPAN, sheet, sheet.viscous / model.dt, low, high,
        carry[:3], b, scratch,
    )  # fmt: skip
    if max(sheet.bend1, sheet.bend2) > 0.0:
        director, pull = shell_fields(state.director, sheet, 3), shell_fields(state.pull, sheet, 3)
        pull[:, low:high] = 0.0
        done += shell.shell_forces(x, f, director, pull, past, cell, sheet, low, high, carry, b, scratch)
    state.ledger[b, FIBRE_WORK] -= done
    if sheet.fold_radius > 0.0:
        w = scratch[: SCRATCH_ROWS * (sheet.cols + 2)].reshape((SCRATCH_ROWS, sheet.cols + 2))
        triple1, triple2 = scalars(model.triple1, sheet), scalars(model.triple2, sheet)
        fold_lattice_forces(
            x, f, triple1, triple2, sheet.a1, sheet.a2, sheet.hourglass, sheet.fold_radius, low, high, w
        )


@njit(**FAST)
def _collect_shell(state, sheet, carry, low, b):
    """Add what the block before carried over to a shell ply's block."""
    f, pull = vectors(state.f, sheet), shell_fields(state.pull, sheet, 3)
    for c in range(3):
        for j in range(sheet.cols):
            f[c, low, j] += carry[c, b - 1, j]
            pull[c, low, j] += carry[3 + c, b - 1, j]


@njit(**INLINE)
def _first_block(model, k):
    """First block of sheet k."""
    b = 0
    while model.blocks[b].sheet != k:
        b += 1
    return b


@njit(**INLINE)
def _buffer(work, model, pair, index):
    """Master force buffer and row spans of a pair for its slave's block number `index`."""
    master = model.sheets[pair.master]
    size = 4 * master.rows * master.cols
    start = pair.buffer + index * size
    buffer = work.buffers[start : start + size].reshape((master.rows, master.cols, 4))
    span = work.spans[pair.span + index * master.rows : pair.span + (index + 1) * master.rows]
    return buffer, span


@njit(**INLINE)
def _packed(pool, sheet):
    """Sheet's slice of a pool of quads as (rows, cols, 4)."""
    n = sheet.rows * sheet.cols
    return pool[4 * sheet.node : 4 * (sheet.node + n)].reshape((sheet.rows, sheet.cols, 4))


@njit(**INLINE)
def _centres(model, sheet):
    """Centres of a sheet's contact patches (rows, cols, 2)."""
    n = sheet.rows * sheet.cols
    return model.centre[2 * sheet.node : 2 * (sheet.node + n)].reshape((sheet.rows, sheet.cols, 2))


@njit(**FAST)
def _pack(model, state, work, b):
    """Pack the positions and velocities of a block's rows for contact."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    pack_rows(vectors(state.x, sheet), scalars(model.cover, sheet), _packed(work.packed, sheet), block.low, block.high)
    pack_rows(vectors(state.v, sheet), scalars(work.nothing, sheet), _packed(work.rates, sheet), block.low, block.high)


@njit(**FAST)
def _layers(model, state, work, member, b, dt, reach):
    """Forces of all pairs in which the block's sheet is the slave."""
    block = model.blocks[b]
    index = b - _first_block(model, block.sheet)
    out = work.sums[member]
    out[:] = 0.0
    normal = scalars(work.normal, model.sheets[block.sheet])
    normal[block.low : block.high] = 0.0
    scratch = (work.chunks[0][member], work.chunks[1][member], work.chunks[2][member], work.chunks[3][member])
    for k in range(model.pairs.shape[0]):
        pair = model.pairs[k]
        if pair.slave != block.sheet or work.idle[k]:
            continue
        slave, master = model.sheets[pair.slave], model.sheets[pair.master]
        buffer, span = _buffer(work, model, pair, index)
        clear_buffer(buffer, span)
        n = slave.rows * slave.cols
        first = pair.first
        place = state.place[5 * first : 5 * (first + n)].reshape((5, slave.rows, slave.cols))
        slip = state.slip[2 * first : 2 * (first + n)].reshape((2, slave.rows, slave.cols))
        rest = work.rest[first : first + n].reshape((slave.rows, slave.cols))
        if pair.slave == pair.master:
            drop_near(slave, model.lines, place, slip, rest, block.low, block.high)
        layer_forces(
            vectors(state.x, slave), vectors(state.v, slave), vectors(state.f, slave), normal,
            scalars(model.area, slave),
            _packed(work.packed, master), _packed(work.rates, master), scalars(model.cell, master),
            _centres(model, master),
            place, slip, rest, buffer, span, pair, reach, dt, block.low, block.high, scratch, out,
        )  # fmt: skip
    state.springs[b, NORMAL_SPRING] = out[0]
    state.springs[b, TANGENTIAL_SPRING] = out[1]
    state.ledger[b, FRICTION] += out[2]
    state.ledger[b, CONTACT_DAMPING] += out[3]


@njit(**FAST)
def _tool(model, state, work, member, row, b, dt, reach):
    """What the tool does to a block of its sheet, on which all other forces stand."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    dx = model.lines[sheet.line : sheet.line + sheet.rows - 1]
    dy = model.lines[sheet.line + sheet.rows - 1 : sheet.line + sheet.rows + sheet.cols - 2]
    carry = work.carry[b]
    if work.carried[b]:
        carry[:] = 0.0
    out = work.sums[member]
    out[:] = 0.0
    law = (model.tool_offset, model.tool_stiffness, model.tool_damping, model.tool_friction)
    done, work.carried[b] = tool_forces(
        vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet), scalars(model.inverse_mass, sheet),
        work.press.reshape((sheet.rows, sheet.cols, PRESS)), work.pressed, carry, scalars(model.area, sheet), dx, dy,
        model.tool, model.tool_origin, model.tool_spacing, law, model.tool_boxed,
        (row[TOOL_Z], row[TOOL_SPEED]), reach, dt, state.tool_anchor, work.sleep, block.low, block.high, out,
        work.give[member],
    )  # fmt: skip
    if block.low == 0 and model.summits.shape[0] > 0:
        done += summit_forces(
            _packed(work.packed, sheet).reshape(4 * sheet.rows * sheet.cols),
            _packed(work.rates, sheet).reshape(4 * sheet.rows * sheet.cols),
            vectors(state.f, sheet), scalars(model.inverse_mass, sheet), _centres(model, sheet), dx, dy, law,
            (row[TOOL_Z], row[TOOL_SPEED]), dt, model.summits, state.spots, work.pushes, out, work.give[member],
        )  # fmt: skip
    state.springs[b, TOOL_NORMAL_SPRING] = out[0]
    state.springs[b, TOOL_TANGENTIAL_SPRING] = out[1]
    state.ledger[b, TOOL_FRICTION] += out[2]
    state.ledger[b, TOOL_DAMPING] += out[3]
    state.ledger[b, TOOL_WORK] += done


@njit(**FAST)
def _collect(model, state, work, b):
    """Add what other blocks' slaves put on this block's rows."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    f, press = vectors(state.f, sheet), scalars(state.press, sheet)
    normal = scalars(work.normal, sheet)
    for i in range(block.low, block.high):
        for j in range(sheet.cols):
            press[i, j] += SHARE * (normal[i, j] - press[i, j])
    for k in range(model.pairs.shape[0]):
        pair = model.pairs[k]
        if pair.master != block.sheet or work.idle[k]:
            continue
        first = _first_block(model, pair.slave)
        index = 0
        while first + index < model.blocks.shape[0] and model.blocks[first + index].sheet == pair.slave:
            buffer, span = _buffer(work, model, pair, index)
            for i in range(block.low, block.high):
                j0, j1 = touched(span, i)
                if j1 > j0:
                    collect_row(f, press, SHARE, buffer, i, j0, j1)
            index += 1
    if sheet.kind == SHELL_PLY and block.low > 0:
        _collect_shell(state, sheet, work.shell_carry, block.low, b)


@njit(**FAST)
def _settle_tool(model, state, work, row, b):
    """Add what the block before carried over; then let the implicit tool act."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    v, f, mass = vectors(state.v, sheet), vectors(state.f, sheet), scalars(model.mass, sheet)
    press, normal = work.press.reshape((sheet.rows, sheet.cols, PRESS)), scalars(state.press, sheet)
    if block.low > 0 and work.carried[b - 1]:
        carry = work.carry[b - 1]
        for j in range(sheet.cols):
            for c in range(PRESS):
                press[block.low, j, c] += carry[j, c]
        work.pressed[block.low] = True
    add_pushes(press, work.pressed, work.pushes, block.low, block.high)
    for i in range(block.low, block.high):
        if work.pressed[i]:
            done, lost = settle_row(
                v[:, i], f[:, i], normal[i], SHARE, press[i], mass[i], row[TOOL_SPEED], row[DAMPING], model.dt
            )
            state.ledger[b, TOOL_WORK] += done
            state.ledger[b, TOOL_DAMPING] += lost
            work.pressed[i] = False


@njit(**FAST)
def _kick_row(v, f, inverse_mass, mass, damping, dt):
    """V <- damping v + dt f / m, one component of a row; returns sum m v^2 and sum f v before the kick.

    Held nodes (no inverse mass) keep their velocity.
    """
    square = power = 0.0
    for j in range(v.shape[0]):
        square += mass[j] * v[j] * v[j]
        power += f[j] * v[j]
        keep = damping if inverse_mass[j] > 0.0 else 1.0
        v[j] = keep * v[j] + dt * inverse_mass[j] * f[j]
    return square, power


@njit(**FAST)
def _drift_row(x, v, f, mass, dt):
    """X <- x + dt v, one component of a row; returns sum m v^2 and sum f v."""
    square = power = 0.0
    for j in range(v.shape[0]):
        square += mass[j] * v[j] * v[j]
        power += f[j] * v[j]
        x[j] += dt * v[j]
    return square, power


@njit(**FAST)
def _kick(model, state, b, damping, scratch):
    """Kick a block's rows by its forces; diaphragms move on."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, v, f = vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet)
    inverse, mass = scalars(model.inverse_mass, sheet), scalars(model.mass, sheet)
    dt = model.dt
    square = power = 0.0
    for i in range(block.low, block.high):
        for c in range(3):
            p, q = _kick_row(v[c, i], f[c, i], inverse[i], mass[i], damping, dt)
            square += p
            power += q
            if sheet.kind != PLY:
                _drift_row(x[c, i], v[c, i], f[c, i], mass[i], dt)
    if sheet.kind == SHELL_PLY and max(sheet.bend1, sheet.bend2) > 0.0:
        director, spin = shell_fields(state.director, sheet, 3), shell_fields(state.spin, sheet, 3)
        pull = shell_fields(state.pull, sheet, 3)
        for i in range(block.low, block.high):
            square += turn_row(director[:, i], spin[:, i], pull[:, i], mass[i], inverse[i], sheet.gyration, damping, dt)
    state.ledger[b, MASS_DAMPING] += 0.5 * square * (1.0 - damping * damping)
    if sheet.kind == PLY:
        state.ledger[b, FIBRE_WORK] -= 0.5 * damping * (damping * square + dt * power)
        kept1, kept2 = scalars(state.tension1, sheet), scalars(state.tension2, sheet)
        q = scratch[: 3 * sheet.cols].reshape((3, sheet.cols))
        for i in range(block.low, block.high):
            pull_kept(x, v, inverse, kept1, kept2, dt, i, q)


@njit(**FAST)
def _drift(model, state, b):
    """Move a ply's block on. With `_kick` the ledger gets the work of the tension in this step:

    change of kinetic energy less that of the other forces, dt f (v_before + v_after)/2.
    """
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, v, f = vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet)
    mass = scalars(model.mass, sheet)
    square = power = 0.0
    for i in range(block.low, block.high):
        for c in range(3):
            p, q = _drift_row(x[c, i], v[c, i], f[c, i], mass[i], model.dt)
            square += p
            power += q
    state.ledger[b, FIBRE_WORK] += 0.5 * (square - model.dt * power)


@njit(**FAST)
def _pull(model, state, work, member, family, sweep, k, low, high):
    """Correct the fibre tension along one bundle of lines of a family; sweep 0 or 1."""
    sheet = model.sheets[k]
    x, v = vectors(state.x, sheet), vectors(state.v, sheet)
    inverse = scalars(model.inverse_mass, sheet)
    dt = model.dt
    rows = 6 * ((sheet.rows if family == 1 else sheet.cols) + 1) + 2
    lines = work.lines[member, : rows * LINES].reshape((rows, LINES))
    if family == 1:
        law = (1.0 / sheet.a1, dt * dt * sheet.eh1 / sheet.a1, 0.5 * dt * sheet.eh1, dt * dt / sheet.a1, dt)
        bar, kept = scalars(model.bar1, sheet), scalars(state.tension1, sheet)
        pull_lines(x, v, inverse, bar, kept, law, sweep == 1, low, high, lines)
    else:
        law = (1.0 / sheet.a2, dt * dt * sheet.eh2 / sheet.a2, 0.5 * dt * sheet.eh2, dt * dt / sheet.a2, dt)
        bar, kept = scalars(model.bar2, sheet), scalars(state.tension2, sheet)
        turned = work.turned[member, : 9 * sheet.cols * LINES].reshape((9, sheet.cols, LINES))
        pull_rows(x, v, inverse, bar, kept, law, sweep == 1, low, high, turned, lines)


@njit(**FAST)
def _pull_family(model, state, work, member, family, sweep, t):
    """Task number t of a family's bundles."""
    bundles = work.bundles1 if family == 1 else work.bundles2
    _pull(model, state, work, member, family, sweep, bundles[t, 0], bundles[t, 1], bundles[t, 2])


@njit(**FAST)
def _move(model, state, work, row, b, member):
    """Kick, move and pack a block of the tool's sheet after the tool has acted."""
    _settle_tool(model, state, work, row, b)
    _kick(model, state, b, row[DAMPING], work.scratch[member])
    _pack(model, state, work, b)


@njit(**FAST)
def advance(member, members, sync, model, state, work, schedule, first, reach):
    """Run one step a row of `schedule` (steps, SCHEDULE); every member of the team calls it.

    first: number of the first step; reach: way that a sheet can go in a step, for what sleeps and rests [mm].
    """
    blocks = model.blocks.shape[0]
    tool_blocks, tool_first = 0, 0
    if model.tool_sheet >= 0:
        tool_first = _first_block(model, model.tool_sheet)
        while tool_first + tool_blocks < blocks and model.blocks[tool_first + tool_blocks].sheet == model.tool_sheet:
            tool_blocks += 1
    # a ply that meets the tool itself is kicked before its fibres are pulled; a diaphragm meanwhile
    first_turn = -2 if tool_blocks > 0 and model.sheets[model.tool_sheet].kind == PLY else 0
    base = 0
    b = draw(sync, base)
    while b < blocks:
        _pack(model, state, work, b)
        b = draw(sync, base)
    base += blocks + members
    barrier(sync, members)
    for n in range(schedule.shape[0]):
        row = schedule[n]
        b = draw(sync, base)
        while b < blocks:
            _internal(model, state, work, row, b, work.scratch[member])
            _layers(model, state, work, member, b, model.dt, reach)
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
        b = draw(sync, base)
        while b < blocks:
            _collect(model, state, work, b)
            if model.blocks[b].sheet != model.tool_sheet:
                _kick(model, state, b, row[DAMPING], work.scratch[member])
                if model.sheets[model.blocks[b].sheet].kind != PLY:
                    _pack(model, state, work, b)
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
        early = 1 + (first + n) % 2
        for turn in range(first_turn, 4):
            family = early if turn % 2 == 0 else 3 - early
            bundles = work.bundles1.shape[0] if family == 1 else work.bundles2.shape[0]
            if turn < 0:
                bundles = 0
            also = tool_blocks if turn < first_turn + 2 else 0
            t = draw(sync, base)
            while t < also + bundles:
                if t >= also:
                    _pull_family(model, state, work, member, family, turn // 2, t - also)
                elif turn == first_turn:
                    _tool(model, state, work, member, row, tool_first + t, model.dt, reach)
                else:
                    _move(model, state, work, row, tool_first + t, member)
                t = draw(sync, base)
            base += also + bundles + members
            barrier(sync, members)
        b = draw(sync, base)
        while b < blocks:
            if model.sheets[model.blocks[b].sheet].kind == PLY:
                _drift(model, state, b)
                _pack(model, state, work, b)
            b = draw(sync, base)
        base += blocks + members
        barrier(sync, members)
