"""What is done in a step to one block of rows, phase by phase; `dynamics.step` says in which order, and how often."""

from __future__ import annotations

from numba import njit

from ddf.dynamics import contacts, mirror
from ddf.dynamics.work import SCRATCH_ROWS
from ddf.elements.bending import bending_forces
from ddf.elements.cells import filled_nodes
from ddf.elements.fold import fold_forces, fold_lattice_forces
from ddf.elements.plate import plate_forces
from ddf.elements.rubber import rubber_forces
from ddf.elements.shear import shear_forces
from ddf.elements.shell_membrane import membrane, shell
from ddf.elements.shell_membrane.history import HISTORY
from ddf.elements.shell_membrane.rotations import turn_row
from ddf.elements.squeeze import squeeze_forces
from ddf.elements.tension import pull_kept, pull_lines, pull_rows
from ddf.jit import FAST
from ddf.materials.shear_law import TANGENT_SPAN
from ddf.model import (
    DAMPING,
    DIAPHRAGM,
    FIBRE_WORK,
    MASS_DAMPING,
    PLY,
    SHELL_PLY,
    SQUEEZE_WORK,
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
        whole = 0.0 if sheet.kind == DIAPHRAGM else sheet.a1 * sheet.a2
        power = squeeze_forces(
            x, vectors(state.v, sheet), f, scalars(model.cell, sheet), whole, scalars(state.press, sheet),
            scalars(model.inverse_area, sheet), sheet.squeeze, low, high, scratch,
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
        rubber_forces(x, f, dx, dy, sheet, model.ogden, row[sheet.face], low, high, scratch)
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
    cell, dt = scalars(model.cell, sheet), model.dt
    if model.mirror >= 0:
        mirror.let_go(model, state, b)
    if sheet.bed > 0.0:
        contacts.find_bed(model, state, work, row, b, reach)
    square = power = 0.0
    for i in range(block.low, block.high):
        p, q = filled_nodes(cell, i)
        for c in range(3):
            done = _kick_row(v[c, i, p:q], f[c, i, p:q], inverse[i, p:q], mass[i, p:q], damping, dt)
            square += done[0]
            power += done[1]
            if sheet.kind != PLY:
                _drift_row(x[c, i, p:q], v[c, i, p:q], f[c, i, p:q], mass[i, p:q], dt)
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
            contacts.bear_plies(model, state, work, row, b)
        if model.mirror >= 0:
            mirror.stay_on_plane(model, state, b)


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
    mass, cell = scalars(model.mass, sheet), scalars(model.cell, sheet)
    if model.mirror >= 0:
        mirror.stay_on_plane(model, state, b)
    if sheet.bed > 0.0:
        contacts.leave_bed(model, state, work, row, b)
    square = power = 0.0
    for i in range(block.low, block.high):
        p, q = filled_nodes(cell, i)
        for c in range(3):
            done = _drift_row(x[c, i, p:q], v[c, i, p:q], f[c, i, p:q], mass[i, p:q], model.dt)
            square += done[0]
            power += done[1]
    state.ledger[b, FIBRE_WORK] += 0.5 * (square - model.dt * power)
    contacts.pack(model, state, work, b)


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
        contacts.settle_tool(model, state, work, row, b)
    elif model.blocks[b].sheet == model.tool_sheet:
        return
    _kick(model, state, work, row, b, reach, work.scratch[member])
    if settle == 1 or kind != PLY:
        contacts.pack(model, state, work, b)
