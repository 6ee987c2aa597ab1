"""Wrinkling of a strip on a foundation of springs: N_cr = 2 sqrt(B K), lambda = 2 pi (B/K)^(1/4) (Winkler, Hetenyi).

The solver has no springs to the ground. It has contact with the diaphragms: held flat on both sides of the ply, each
pressed on it by a small interference, without friction and contact damping, their penalty k acts both ways, as
a foundation K = 2 k, for deflections below that interference.
"""

from __future__ import annotations

import math

import numpy as np

from ddf.scene import Scene
from ddf.verify.problem import Answer, Options, Problem
from ddf.verify.scenes import areal_mass, case_scene, damped, fabric_of, held, positions
from ddf.verify.wrinkling import wrinkling_answer

PENALTY_N_MM3 = 5e-4
INTERFERENCE_MM = 0.05
WAVES = 4
ELEMENT_MM, QUICK_ELEMENT_MM = 1.5, 2.5
PLY = 1


def bedded(options: Options, element_mm: float, length: float, penalty: float = PENALTY_N_MM3) -> Scene:
    """The strip between both diaphragms of contact stiffness `penalty` [N/mm3] each, its ends pinned."""
    whole = case_scene(
        fabric_of(options), (2.0 * element_mm, length), element_mm,
        friction={"ply_diaphragm": 0.0},
        solver={"mass_scaling": 1.0, "contact_stiffness_N_mm3": penalty, "contact_damping": 0.0},
    )  # fmt: skip
    scene = damped(whole, 0.0)
    sheets = scene.model.sheets
    touching = float(scene.model.pairs["offset"][0])
    for k, sign in ((0, -1.0), (2, 1.0)):
        positions(scene, k)[2] = sign * (touching - INTERFERENCE_MM)
        scene = held(scene, np.ones((int(sheets[k]["rows"]), int(sheets[k]["cols"])), bool), k)
    for pair in scene.model.pairs[
        scene.model.pairs["slave"] == PLY
    ]:  # it has come to these depths, see `contact.layers`
        first, nodes = int(pair["first"]), int(sheets[PLY]["rows"] * sheets[PLY]["cols"])
        scene.state.place[5 * first : 5 * (first + nodes)].reshape(5, nodes)[2] = -INTERFERENCE_MM
    x = positions(scene, PLY)
    x[2] = 0.0
    return held(scene, np.abs(x[1]) > 0.5 * length - 0.1 * element_mm, PLY)


def solve(options: Options) -> Answer:
    """A strip about four waves long."""
    fabric = fabric_of(options, bending=True)
    rigidity, foundation = fabric.bending_rigidity_Nmm[1], 2.0 * PENALTY_N_MM3
    element = options.element_mm or (QUICK_ELEMENT_MM if options.quick else ELEMENT_MM)
    length = WAVES * 2.0 * math.pi * (rigidity / foundation) ** 0.25
    scenes = [(size, bedded(options, size, length)) for size in (2.0 * element, element)]
    return wrinkling_answer(scenes, PLY, length, rigidity, foundation, areal_mass(fabric))


PROBLEM = Problem("buckling-foundation", "Wrinkling of a strip on contact springs", "Winkler foundation", solve)
