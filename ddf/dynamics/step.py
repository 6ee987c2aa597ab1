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
    7  plies: x <- x + dt v; then the rims of plies (`contact.rim`)                        blocks of rows

In a half model (`dynamics.mirror`) forces are folded back and ghosts let go between 1 and 2, and follow after 7.

2 ends, for plies, with the impulses of the tensions kept from the last step. The families change places every other
step. A ply that itself meets the tool (in problems of verification) is acted on before 3. Each phase is one parallel
region; blocks and bundles of lines are fixed, so the bits of the result do not depend on the number of threads.

Two other ways were built and measured before. Small inner steps of the tension between impulses of the other
forces (r-RESPA), 14 of them: a flat clamped stack at 5 mm lost fifty times the work done on it to fibre damping
(with 5 inner steps two fifths of it), which looks like resonance of the impulses with the fibres' waves. The
trapezoidal rule with both families factored into one operator went unstable as soon as the ply was curved.
"""

from __future__ import annotations

from numba import njit

from ddf.dynamics import contacts, mirror, phases
from ddf.dynamics.team import barrier, draw
from ddf.elements.squeeze import SHARE
from ddf.jit import FAST
from ddf.model import PLY

# phases in order; the first three once before all steps, the turns of fibre tension (two of them for a ply that meets
# the tool itself) from FIRST_TURN on
PACK, BEGIN, RIM, FORCES, COLLECT, FOLD_BACK, LEAVE, FOLLOW_SPEED, FIRST_TURN = range(9)
DRIFT, FOLLOW, RIM_AGAIN = FIRST_TURN + 6, FIRST_TURN + 7, FIRST_TURN + 8


@njit(**FAST)
def advance(member, members, sync, model, state, work, schedule, first, reach):
    """Run one step a row of `schedule` (steps, SCHEDULE); every member of the team calls it.

    first: number of the first step; reach: way that a sheet can go in a step, for what sleeps and rests [mm].
    All phases are cases of one loop: each function that calls what is below costs a compiler as much as all of it.
    """
    blocks, half, rimless = model.blocks.shape[0], model.mirror >= 0, model.rim.shape[0] == 0
    tool_blocks, tool_first = 0, 0
    if model.tool_sheet >= 0:
        tool_first, tool_blocks = contacts.blocks_of(model, model.tool_sheet)
    # a ply that meets the tool itself is kicked before its fibres are pulled; a diaphragm meanwhile
    first_turn = -2 if tool_blocks > 0 and model.sheets[model.tool_sheet].kind == PLY else 0
    base = 0
    for n in range(-1, schedule.shape[0]):
        row = work.nothing if n < 0 else schedule[n]
        early = 1 + (first + n) % 2
        for phase in range(PACK if n < 0 else FORCES, FORCES if n < 0 else RIM_AGAIN + 1):
            turn = phase - FIRST_TURN - 2 if phase < DRIFT else 4
            settle = (
                1 if FIRST_TURN <= phase < DRIFT else 0
            )  # not a constant, for which the kernel would be compiled anew
            tasks, also, family = blocks, 0, early if turn % 2 == 0 else 3 - early
            if settle == 1:
                if turn < first_turn:
                    continue
                also = tool_blocks if turn < first_turn + 2 else 0
                bundles = work.bundles1.shape[0] if family == 1 else work.bundles2.shape[0]
                tasks = also + (bundles if turn >= 0 else 0)
            elif phase in (BEGIN, FOLD_BACK, LEAVE, FOLLOW):
                if not half:
                    continue
            elif model.twins.shape[0] == 0 if phase == FOLLOW_SPEED else rimless and phase in (RIM, RIM_AGAIN):
                continue
            t = draw(sync, base)
            while t < tasks:
                if phase == PACK:
                    contacts.pack(model, state, work, t)
                elif phase in (BEGIN, FOLLOW):
                    mirror.follow(model, state, work, t)
                    mirror.follow_tension(model, state, t)
                elif phase in (RIM, RIM_AGAIN):
                    contacts.extend_rim(model, work, t)
                elif phase == FORCES:
                    phases.internal(model, state, work, row, t, work.scratch[member])
                    contacts.layers(model, state, work, member, t, model.dt, reach)
                elif phase == COLLECT:
                    contacts.collect(model, state, work, t)
                    if not half:
                        phases.leave(model, state, work, row, t, reach, member, settle)
                elif phase == FOLD_BACK:
                    mirror.fold_back(model, state, work, SHARE, t)
                elif phase == LEAVE:
                    phases.leave(model, state, work, row, t, reach, member, settle)
                elif phase == FOLLOW_SPEED:
                    mirror.follow_speed(model, state, t)
                elif phase == DRIFT:
                    phases.drift(model, state, work, row, t)
                elif t >= also:
                    phases.pull_family(model, state, work, member, family, turn // 2, t - also)
                elif turn == first_turn:
                    contacts.tool(model, state, work, member, row, tool_first + t, model.dt, reach)
                else:
                    phases.leave(model, state, work, row, tool_first + t, reach, member, settle)
                t = draw(sync, base)
            base += tasks + members
            barrier(sync, members)
