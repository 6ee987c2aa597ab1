"""What is done in a step to one block of rows, phase by phase; `dynamics.step` says in which order, and how often."""

from __future__ import annotations

from numba import njit

from ddf.contact.bed import BED, bear, find_borne, lose
from ddf.contact.layers import clear_buffer, collect_row, layer_forces, pack_rows, touched
from ddf.contact.self_contact import drop_near
from ddf.contact.summit import add_pushes, summit_forces
from ddf.contact.tool import settle_row, tool_forces
from ddf.contact.tool_point import PRESS
from ddf.dynamics import mirror
from ddf.dynamics.work import SCRATCH_ROWS
from ddf.elements.bending import bending_forces
from ddf.elements.fold import fold_forces, fold_lattice_forces
from ddf.elements.plate import plate_forces
from ddf.elements.rubber import rubber_forces
from ddf.elements.shear import shear_forces
from ddf.elements.shell_membrane import membrane, shell
from ddf.elements.shell_membrane.history import HISTORY
from ddf.elements.shell_membrane.rotations import turn_row
from ddf.elements.squeeze import SHARE, squeeze_forces
from ddf.elements.tension import pull_kept, pull_lines, pull_rows
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
def internal(model, state, work, row, b, scratch):
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
        if model.mirror >= 0:
            mirror.set_aside(model, state, work, b)
        rubber_forces(x, f, dx, dy, sheet, model.ogden, row[sheet.face], low, high, w)
        if sheet.rigidity > 0.0:
            plate_forces(x, f, dx, dy, sheet.rigidity, low, high, w)
        if sheet.fold_radius > 0.0:
            fold_forces(x, f, dx, dy, sheet.hourglass, sheet.fold_radius, low, high, w)
        if model.mirror >= 0:
            mirror.take_share(model, state, work, b)


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


@njit(**FAST)
def pack(model, state, work, b):
    """Pack the positions and velocities of a block's rows for contact."""
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    pack_rows(vectors(state.x, sheet), scalars(model.cover, sheet), _packed(work.packed, sheet), block.low, block.high)
    pack_rows(vectors(state.v, sheet), scalars(work.nothing, sheet), _packed(work.rates, sheet), block.low, block.high)


@njit(**FAST)
def layers(model, state, work, member, b, dt, reach):
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
def _kick(model, state, work, row, b, reach, scratch):
    """Kick a block's rows by its forces; diaphragms move on."""
    damping = row[DAMPING]
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, v, f = vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet)
    inverse, mass = scalars(model.inverse_mass, sheet), scalars(model.mass, sheet)
    dt = model.dt
    if model.mirror >= 0:
        mirror.let_go(model, state, b)
    if sheet.bed > 0.0:
        _find_borne(model, state, work, row, b, reach)
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
            pull_kept(x, v, scalars(model.line_mass, sheet), kept1, kept2, dt, i, q)
        if sheet.bed > 0.0:
            _bear(model, state, work, row, b)
        if model.mirror >= 0:
            mirror.stay_on_plane(model, state, b)


@njit(**INLINE)
def _find_borne(model, state, work, row, b, reach):
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
def _bear(model, state, work, row, b):
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
def _bed(work, sheet):
    """Sheet's slice of what bears nodes as (rows, cols, BED)."""
    return work.bed[sheet.node : sheet.node + sheet.rows * sheet.cols].reshape((sheet.rows, sheet.cols, BED))


@njit(**FAST)
def drift(model, state, work, row, b):
    """Move a ply's block on and pack it. With `_kick` the ledger gets the work of the tension in this step:

    change of kinetic energy less that of the other forces, dt f (v_before + v_after)/2.
    """
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    if sheet.kind != PLY:
        return
    x, v, f = vectors(state.x, sheet), vectors(state.v, sheet), vectors(state.f, sheet)
    mass = scalars(model.mass, sheet)
    if model.mirror >= 0:
        mirror.stay_on_plane(model, state, b)
    if sheet.bed > 0.0:
        motion = (row[TOOL_Z], row[TOOL_SPEED])
        lost, rubbed = lose(v, scalars(work.borne, sheet), _bed(work, sheet), motion, model.dt, block.low, block.high)
        state.ledger[b, TOOL_DAMPING] += lost
        state.ledger[b, TOOL_FRICTION] += rubbed
    square = power = 0.0
    for i in range(block.low, block.high):
        for c in range(3):
            p, q = _drift_row(x[c, i], v[c, i], f[c, i], mass[i], model.dt)
            square += p
            power += q
    state.ledger[b, FIBRE_WORK] += 0.5 * (square - model.dt * power)
    pack(model, state, work, b)


@njit(**FAST)
def pull_family(model, state, work, member, family, sweep, t):
    """Correct the fibre tension along bundle of lines t of a family; sweep 0 or 1."""
    bundles = work.bundles1 if family == 1 else work.bundles2
    sheet, low, high = model.sheets[bundles[t, 0]], bundles[t, 1], bundles[t, 2]
    first, end = bundles[t, 3], bundles[t, 4]
    x, v = vectors(state.x, sheet), vectors(state.v, sheet)
    inverse = scalars(model.line_mass, sheet)
    dt = model.dt
    lines = work.lines[member]
    if family == 1:
        law = (1.0 / sheet.a1, dt * dt * sheet.eh1 / sheet.a1, 0.5 * dt * sheet.eh1, dt * dt / sheet.a1, dt)
        bar, kept = scalars(model.bar1, sheet), scalars(state.tension1, sheet)
        pull_lines(x, v, inverse, bar, kept, law, sweep == 1, model.mirror, low, high, first, end, lines)
    else:
        law = (1.0 / sheet.a2, dt * dt * sheet.eh2 / sheet.a2, 0.5 * dt * sheet.eh2, dt * dt / sheet.a2, dt)
        bar, kept = scalars(model.bar2, sheet), scalars(state.tension2, sheet)
        pull_rows(x, v, inverse, bar, kept, law, sweep == 1, model.mirror, low, high, first, end, lines)


@njit(**FAST)
def leave(model, state, work, row, b, reach, member, settle):
    """Kick a block; what is no ply moves on and is packed. settle: 1 for the sheet on which the tool acts first.

    Else blocks of the tool's sheet are left alone.
    """
    kind = model.sheets[model.blocks[b].sheet].kind
    if settle == 1:
        _settle_tool(model, state, work, row, b)
    elif model.blocks[b].sheet == model.tool_sheet:
        return
    _kick(model, state, work, row, b, reach, work.scratch[member])
    if settle == 1 or kind != PLY:
        pack(model, state, work, b)
