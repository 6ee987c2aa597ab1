"""A model's state before the first step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.build.summits import NO_SPOTS
from ddf.contact.tool import POINTS
from ddf.contact.tool_point import FREE
from ddf.elements.shell_membrane.history import HISTORY, M_C11, M_C22, S_C11, S_C22
from ddf.elements.shell_membrane.rotations import normals
from ddf.model import LEDGER, SHELL_PLY, SPRINGS, Model, State, sheet_shells, sheet_vectors

FloatArray = NDArray[np.float64]


def state_at_rest(model: Model, x: FloatArray, places: FloatArray, spots: FloatArray = NO_SPOTS) -> State:
    """A fresh state: positions x (3 N,), first places of all pairs, nothing in motion, no tension, no anchor.

    spots: of the tool's summits, from `first_spots`.
    """
    sheet = model.sheets[model.tool_sheet]
    nodes = (int(sheet["rows"]), int(sheet["cols"])) if model.tool_sheet >= 0 else (1, 1)
    anchors = np.zeros((POINTS, 3, *nodes))
    anchors[:, 0] = FREE
    shells = model.sheets["kind"] == SHELL_PLY
    size = int((model.sheets["rows"] * model.sheets["cols"])[shells].sum())
    state = State(
        x=x, v=np.zeros_like(x), f=np.zeros_like(x),
        place=places, slip=np.zeros(2 * model.exposed.size), tool_anchor=anchors, spots=spots,
        press=np.zeros(model.mass.size), tension1=np.zeros(model.mass.size), tension2=np.zeros(model.mass.size),
        rise=np.zeros(model.mass.size),
        director=np.zeros(3 * size), spin=np.zeros(3 * size), pull=np.zeros(3 * size), history=np.zeros(HISTORY * size),
        ledger=np.zeros((model.blocks.size, LEDGER)), springs=np.zeros((model.blocks.size, SPRINGS)),
        clock=np.zeros(4),
    )  # fmt: skip
    for k in np.flatnonzero(shells):
        sheet_shells(model, state.history, int(k), HISTORY)[[M_C11, M_C22, S_C11, S_C22]] = 1.0
        sheet_shells(model, state.director, int(k), 3)[:] = normals(sheet_vectors(model, x, int(k)))
    return state
