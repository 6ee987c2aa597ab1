"""What contact does in a step to one block of rows: layers on each other, the tool on its sheet and on plies."""

from __future__ import annotations

from numba import njit

from ddf.contact.bed import BED, bear, find_borne, lose
from ddf.contact.layers import clear_buffer, collect_row, layer_forces, pack_rows, touched
from ddf.contact.rim import clear_rim, extend, hand_over
from ddf.contact.self_contact import drop_near
from ddf.contact.summit import add_pushes, summit_forces
from ddf.contact.tool import settle_row, tool_forces
from ddf.contact.tool_point import PRESS
from ddf.dynamics import mirror
from ddf.elements.squeeze import SHARE
from ddf.jit import FAST, INLINE
from ddf.model import (
    CONTACT_DAMPING,
    DAMPING,
    FIBRE_WORK,
    FRICTION,
    NORMAL_SPRING,
    SHELL_PLY,
    TANGENTIAL_SPRING,
    TOOL_DAMPING,
    TOOL_FRICTION,
    TOOL_NORMAL_SPRING,
    TOOL_SPEED,
    TOOL_TANGENTIAL_SPRING,
    TOOL_WORK,
    TOOL_Z,
    scalars,
    shell_fields,
    vectors,
)


@njit(**INLINE)
def _first_block(model, k):
    """First block of sheet k."""
    b = 0
    while model.blocks[b].sheet != k:
        b += 1
    return b


@njit(**FAST)
def blocks_of(model, k):
    """First block of sheet k, and how many it has."""
    first, count = _first_block(model, k), 0
    while first + count < model.blocks.shape[0] and model.blocks[first + count].sheet == k:
        count += 1
    return first, count


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


@njit(**INLINE)
def _bed(work, sheet):
    """Sheet's slice of what bears nodes as (rows, cols, BED)."""
    return work.bed[sheet.node : sheet.node + sheet.rows * sheet.cols].reshape((sheet.rows, sheet.cols, BED))


@njit(**FAST)
def pack(model, state, work, b):
    """Pack the positions and velocities of a block's rows for contact."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    pack_rows(vectors(state.x, sheet), scalars(model.cover, sheet), _packed(work.packed, sheet), block.low, block.high)
    pack_rows(vectors(state.v, sheet), scalars(work.nothing, sheet), _packed(work.rates, sheet), block.low, block.high)


@njit(**FAST)
def extend_rim(model, work, b):
    """Put the rim nodes in a block's rows, packed, where those that they go on from take them."""
    first, end = model.rim_first[b], model.rim_first[b + 1]
    extend(work.packed, model.rim, first, end)
    extend(work.rates, model.rim, first, end)


@njit(**FAST)
def layers(model, state, work, member, b, dt, reach):
    """Forces of all pairs in which the block's sheet is the slave."""
    block = model.blocks[b]
    index = b - _first_block(model, block.sheet)
    out = work.sums[member]
    out[:] = 0.0
    normal = scalars(work.normal, model.sheets[block.sheet])
    normal[block.low : block.high] = 0.0
    scratch = (work.chunks[0][member], work.chunks[1][member], work.chunks[2][member])
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
            _packed(work.packed, master), _packed(work.rates, master), _centres(model, master),
            place, slip, rest, buffer, span, pair, reach, dt, block.low, block.high, scratch, out,
        )  # fmt: skip
    if model.mirror >= 0:
        out[0] += _meet_image(model, state, b)
    state.springs[b, NORMAL_SPRING] = out[0]
    state.springs[b, TANGENTIAL_SPRING] = out[1]
    state.ledger[b, FRICTION] += out[2]
    state.ledger[b, CONTACT_DAMPING] += out[3]


@njit(**INLINE)
def _meet_image(model, state, b):
    """Keep a sheet that folds on the mirror plane from its image; returns the energy stored [N mm]."""
    for k in range(model.pairs.shape[0]):
        pair = model.pairs[k]
        if pair.slave == pair.master == model.blocks[b].sheet:
            return mirror.meet_image(model, state, pair, b)
    return 0.0


@njit(**FAST)
def tool(model, state, work, member, row, b, dt, reach):
    """What the tool does to a block of its sheet, on which all other forces stand."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    dx = model.tool_lines[sheet.line : sheet.line + sheet.rows - 1]
    dy = model.tool_lines[sheet.line + sheet.rows - 1 : sheet.line + sheet.rows + sheet.cols - 2]
    carry = work.carry[b]
    if work.carried[b]:
        carry[:] = 0.0
    out = work.sums[member]
    out[:] = 0.0
    law = (model.tool_offset, model.tool_stiffness, model.tool_damping, model.tool_friction)
    size = 4 * sheet.rows * sheet.cols
    y, rates = _packed(work.packed, sheet).reshape(size), _packed(work.rates, sheet).reshape(size)
    parts = work.points
    scratch = (
        parts[0][member], parts[1][member], parts[2][member], parts[3][member], parts[4][member], parts[5][member],
    )  # fmt: skip
    done, work.carried[b] = tool_forces(
        vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet), y, rates,
        scalars(model.inverse_mass, sheet),
        work.press.reshape((sheet.rows, sheet.cols, PRESS)), work.pressed, carry, scalars(model.area, sheet), dx, dy,
        model.tool, model.tool_origin, model.tool_spacing, law,
        (model.tool_boxed, model.tool_walls), (row[TOOL_Z], row[TOOL_SPEED]), reach, dt, state.tool_anchor, work.sleep,
        block.low, block.high, out, scratch,
    )  # fmt: skip
    if block.low == 0 and model.summits.shape[0] > 0:
        done += summit_forces(
            y, rates, vectors(state.f, sheet), scalars(model.inverse_mass, sheet), _centres(model, sheet), dx, dy, law,
            (row[TOOL_Z], row[TOOL_SPEED]), dt, model.summits, state.spots, work.pushes, out, scratch[0],
        )  # fmt: skip
    state.springs[b, TOOL_NORMAL_SPRING] = out[0]
    state.springs[b, TOOL_TANGENTIAL_SPRING] = out[1]
    state.ledger[b, TOOL_FRICTION] += out[2]
    state.ledger[b, TOOL_DAMPING] += out[3]
    state.ledger[b, TOOL_WORK] += done


@njit(**FAST)
def settle_tool(model, state, work, row, b):
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
    before = work.pressed_before[model.ghosts.shape[0] :]
    if model.mirror >= 0:
        mirror.press_on_plane(model, state, press, b, before)
    for i in range(block.low, block.high):
        if work.pressed[i]:
            done, lost = settle_row(
                v[:, i], f[:, i], normal[i], SHARE, press[i], mass[i], row[TOOL_SPEED], row[DAMPING], model.dt
            )
            state.ledger[b, TOOL_WORK] += done
            state.ledger[b, TOOL_DAMPING] += lost
            work.pressed[i] = False
    if model.mirror >= 0:
        mirror.press_whole(model, state, b, before)


@njit(**FAST)
def _collect_shell(state, sheet, carry, low, b):
    """Add what the block before carried over to a shell ply's block."""
    f, pull = vectors(state.f, sheet), shell_fields(state.pull, sheet, 3)
    for c in range(3):
        for j in range(sheet.cols):
            f[c, low, j] += carry[c, b - 1, j]
            pull[c, low, j] += carry[3 + c, b - 1, j]


@njit(**FAST)
def collect(model, state, work, b):
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
            p, q = model.parent_first[b], model.parent_first[b + 1]
            hand_over(f, press, SHARE, buffer, span, model.rim_parents, p, q, sheet.node)
            index += 1
    clear_rim(f, press, model.rim, model.rim_first[b], model.rim_first[b + 1], sheet.node)
    if sheet.kind == SHELL_PLY and block.low > 0:
        _collect_shell(state, sheet, work.shell_carry, block.low, b)


@njit(**INLINE)
def find_bed(model, state, work, row, b, reach):
    """Find what bears a ply's block on the tool."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    stored, lost, done = find_borne(
        vectors(state.x, sheet), vectors(state.v, sheet), scalars(model.area, sheet),
        scalars(model.inverse_mass, sheet), model.tool, model.tool_origin, model.tool_spacing,
        (sheet.bed, sheet.bed_stiffness), (row[TOOL_Z], row[TOOL_SPEED]), reach, model.dt,
        scalars(work.bed_sleep, sheet), scalars(work.borne, sheet), scalars(state.rise, sheet), _bed(work, sheet),
        block.low, block.high,
    )  # fmt: skip
    state.springs[b, TOOL_NORMAL_SPRING] = stored
    state.ledger[b, TOOL_WORK] += done
    state.ledger[b, TOOL_DAMPING] += lost


@njit(**INLINE)
def bear_plies(model, state, work, row, b):
    """Let the tool bear a ply's block."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    power, done, lost, rubbed = bear(
        vectors(state.v, sheet), vectors(state.f, sheet), scalars(model.inverse_mass, sheet),
        scalars(work.borne, sheet), _bed(work, sheet), sheet.bed_friction, (row[TOOL_Z], row[TOOL_SPEED]),
        row[DAMPING], model.dt, block.low, block.high,
    )  # fmt: skip
    state.ledger[b, FIBRE_WORK] -= 0.5 * model.dt * power
    state.ledger[b, TOOL_WORK] += done
    state.ledger[b, TOOL_DAMPING] += lost
    state.ledger[b, TOOL_FRICTION] += rubbed


@njit(**INLINE)
def leave_bed(model, state, work, row, b):
    """Book what the bed loses with the velocities at the end of a ply's step."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    lost, rubbed = lose(
        vectors(state.v, sheet), scalars(work.borne, sheet), _bed(work, sheet), (row[TOOL_Z], row[TOOL_SPEED]),
        model.dt, block.low, block.high,
    )  # fmt: skip
    state.ledger[b, TOOL_DAMPING] += lost
    state.ledger[b, TOOL_FRICTION] += rubbed
