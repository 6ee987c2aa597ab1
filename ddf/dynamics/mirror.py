"""Half models: what the mirror image of a scene does to the half of it that is computed.

A scene that is its own image in a vertical plane, and stays so, is known from one half. Kept are that half, the nodes
on the plane, and a strip of nodes beyond it, the ghosts, which go where the images of their own images go:
x' = M x, v' = M v, M = 1 - 2 n n. Half the energy of the whole is then that of

    what lies in the half, what lies on the plane or across it at half its strength, and nothing beyond,

and its gradient is what the nodes of the half feel: a force on a ghost acts on its image, f += M f', and on the plane
only what lies in it. Masses, areas, bars, bending triples and cells come with these weights (`build.half`). A
diaphragm's own forces know no weights: they are worked out for the strip as well, so that nodes of the half have all of
theirs; what they put on ghosts is dropped, and of what they put on the plane half is kept. The ledger counts halves.

Where the plane runs across both families of a ply (at +-45 degrees) the images of the lines of one are lines of the
other. Ending both on the plane does not do: without its normal component bars of both are parallel there, and taken one
after the other (`elements.tension`) they grow (a flat ply of 350 mm tore within the first stage). So the fibres of such
a ply are solved for on both sides, all else on one, and afterwards what is beyond the plane is made the image again,
the kept tensions too.

The mean contact force on a node (`press`) is kept as that of the whole: on the plane it is twice what arrives.

Of its image the half knows the strip only. Both meet where a fold closes on the plane, and there a wall keeps them
apart: nodes beyond `contact.self_contact`'s least way from the plane, along the sheet, stay half a contact distance
away from it, nearer ones NEAR of that (in a fold of the least radius they are farther away; without it the lower
diaphragm under two plies passed through its image). There is no friction on it, for both sides move alike.
"""

from __future__ import annotations

from numba import njit

from ddf.jit import FAST, INLINE
from ddf.model import scalars, vectors

NEAR = 0.3
"""Of the distance at which a sheet touches itself, for nodes near the plane along the sheet."""


@njit(**INLINE)
def _flat(pool, sheet):
    """Sheet's slice of a vector pool, component by component, and how many numbers a component has."""
    size = sheet.rows * sheet.cols
    return pool[3 * sheet.node : 3 * (sheet.node + size)], size


@njit(**FAST)
def set_aside(model, state, work, b):
    """Remember the forces on a block's ghosts and nodes on the plane, before a diaphragm's own are added."""
    sheet = model.sheets[model.blocks[b].sheet]
    f, size = _flat(state.f, sheet)
    for g in range(model.ghost_first[b], model.ghost_first[b + 1]):
        for c in range(3):
            work.aside[g, c] = f[c * size + model.ghosts[g, 0] - sheet.node]
    count = model.ghosts.shape[0]
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        for c in range(3):
            work.aside[count + p, c] = f[c * size + model.plane[p] - sheet.node]


@njit(**FAST)
def take_share(model, state, work, b):
    """Of what was added since drop all on ghosts, half on the plane."""
    sheet = model.sheets[model.blocks[b].sheet]
    f, size = _flat(state.f, sheet)
    for g in range(model.ghost_first[b], model.ghost_first[b + 1]):
        for c in range(3):
            f[c * size + model.ghosts[g, 0] - sheet.node] = work.aside[g, c]
    count = model.ghosts.shape[0]
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        for c in range(3):
            k = c * size + model.plane[p] - sheet.node
            f[k] = 0.5 * (f[k] + work.aside[count + p, c])


@njit(**FAST)
def fold_back(model, state, work, share, b):
    """Add what acts on ghosts to their images in a block; on the plane nothing is left along its normal.

    share: of a step's contact force in its running mean.
    """
    sheet = model.sheets[model.blocks[b].sheet]
    f, size = _flat(state.f, sheet)
    for k in range(model.image_first[b], model.image_first[b + 1]):
        g = model.images[k]
        ghost, image = model.ghosts[g, 0] - sheet.node, model.ghosts[g, 1] - sheet.node
        for c in range(3):
            force = f[c * size + ghost]
            f[c * size + image] += -force if c == model.mirror else force
        arrived = state.press[model.ghosts[g, 0]] - (1.0 - share) * work.pressed_before[g]
        state.press[model.ghosts[g, 1]] += arrived
    count = model.ghosts.shape[0]
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        f[model.mirror * size + model.plane[p] - sheet.node] = 0.0
        arrived = state.press[model.plane[p]] - (1.0 - share) * work.pressed_before[count + p]
        state.press[model.plane[p]] += arrived


@njit(**FAST)
def let_go(model, state, b):
    """Take the forces off a block's ghosts: their images have them."""
    sheet = model.sheets[model.blocks[b].sheet]
    f, size = _flat(state.f, sheet)
    for g in range(model.ghost_first[b], model.ghost_first[b + 1]):
        for c in range(3):
            f[c * size + model.ghosts[g, 0] - sheet.node] = 0.0


@njit(**FAST)
def stay_on_plane(model, state, b):
    """Nodes of a block on the plane do not leave it."""
    sheet = model.sheets[model.blocks[b].sheet]
    v, size = _flat(state.v, sheet)
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        v[model.mirror * size + model.plane[p] - sheet.node] = 0.0


@njit(**FAST)
def press_on_plane(model, state, press, b, before):
    """Keep the tool's push on nodes of a block on the plane in the plane; press (n, m, PRESS) as in `contact.tool`.

    before: the first of the places in which the mean contact forces are remembered, for `press_whole`.
    """
    sheet = model.sheets[model.blocks[b].sheet]
    c = model.mirror
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        n = model.plane[p] - sheet.node
        i, j = n // sheet.cols, n % sheet.cols
        before[p] = state.press[model.plane[p]]
        press[i, j, c] = press[i, j, 9 + c] = 0.0
        press[i, j, 6] = press[i, j, 7 if c == 0 else 8] = 0.0  # xy, and xz or yz


@njit(**FAST)
def press_whole(model, state, b, before):
    """Count what the tool did to nodes of a block on the plane for both halves."""
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        state.press[model.plane[p]] += state.press[model.plane[p]] - before[p]


@njit(**FAST)
def follow(model, state, work, b):
    """Put a block's ghosts where the images of their images are, packed ones too."""
    sheet = model.sheets[model.blocks[b].sheet]
    x, size = _flat(state.x, sheet)
    v, _ = _flat(state.v, sheet)
    for g in range(model.ghost_first[b], model.ghost_first[b + 1]):
        ghost, image = model.ghosts[g, 0], model.ghosts[g, 1]
        for c in range(3):
            sign = -1.0 if c == model.mirror else 1.0
            place, speed = sign * x[c * size + image - sheet.node], sign * v[c * size + image - sheet.node]
            x[c * size + ghost - sheet.node], v[c * size + ghost - sheet.node] = place, speed
            work.packed[4 * ghost + c], work.rates[4 * ghost + c] = place, speed
        state.press[ghost] = state.press[image]
        work.pressed_before[g] = state.press[ghost]
    count = model.ghosts.shape[0]
    for p in range(model.plane_first[b], model.plane_first[b + 1]):
        work.pressed_before[count + p] = state.press[model.plane[p]]


@njit(**FAST)
def follow_speed(model, state, b):
    """Give a block's ghosts the speeds of their images, for the fibre lines that run through them."""
    sheet = model.sheets[model.blocks[b].sheet]
    v, size = _flat(state.v, sheet)
    for g in range(model.ghost_first[b], model.ghost_first[b + 1]):
        for c in range(3):
            speed = v[c * size + model.ghosts[g, 1] - sheet.node]
            v[c * size + model.ghosts[g, 0] - sheet.node] = -speed if c == model.mirror else speed


@njit(**FAST)
def follow_tension(model, state, b):
    """Give a block's bars beyond the plane the tensions of their images."""
    for t in range(model.twin_first[b], model.twin_first[b + 1]):
        image = model.twins[t, 1]
        tension = state.tension1[image // 2] if image % 2 == 0 else state.tension2[image // 2]
        if model.twins[t, 0] % 2 == 0:
            state.tension1[model.twins[t, 0] // 2] = tension
        else:
            state.tension2[model.twins[t, 0] // 2] = tension


@njit(**FAST)
def meet_image(model, state, pair, b):
    """Push a block's nodes off the plane where their sheet would meet its image; returns the energy stored [N mm].

    pair: of the sheet's contact with itself.
    """
    block = model.blocks[b]
    sheet = model.sheets[block.sheet]
    x, f, area = vectors(state.x, sheet), vectors(state.f, sheet), scalars(model.area, sheet)
    away, inverse = scalars(model.away, sheet), scalars(model.inverse_mass, sheet)
    c = model.mirror
    stored = 0.0
    for i in range(block.low, block.high):
        for j in range(sheet.cols):
            depth = (1.0 if away[i, j] else NEAR) * pair.offset - 2.0 * x[c, i, j]
            if depth > 0.0 and inverse[i, j] > 0.0 and x[c, i, j] != 0.0:
                k = pair.stiffness * area[i, j]
                stored += 0.5 * k * depth * depth
                f[c, i, j] += 2.0 * k * depth
    return stored
