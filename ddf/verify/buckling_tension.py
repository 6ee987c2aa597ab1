"""Wrinkling of a strip under tension across the wrinkles, its ends supported, as folds in a stretched ply start.

A rectangle of L along x, held at x = 0 and L under a tension T per width and compressed along y, deflects as
w = sin(pi x / L) sin(q y). Without twisting stiffness and Poisson effect its energy gives

    N q^2 = B2 q^4 + B1 (pi/L)^4 + T (pi/L)^2

so tension and the bending along x are a foundation K = T (pi/L)^2 + B1 (pi/L)^4 under the bending along y: with
T much larger than B1 (pi/L)^2, lambda = 2 sqrt(pi) (B/T)^(1/4) sqrt(L) and N_cr = (2 pi/L) sqrt(B T)
(E. Cerda, L. Mahadevan, Phys. Rev. Lett. 90 (2003) 074302).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ddf.scene import Scene
from ddf.verify.problem import Answer, Options, Problem
from ddf.verify.scenes import areal_mass, copied_state, fabric_of, held, ply_scene, positions
from ddf.verify.wrinkling import wrinkling_answer

SPAN_MM = 100.0
TENSION_N_MM = 0.5
WAVES = 4
ELEMENT_MM, QUICK_ELEMENT_MM = 2.0, 3.0


def _foundation(rigidity_along_x: float) -> float:
    wave = math.pi / SPAN_MM
    return TENSION_N_MM * wave**2 + rigidity_along_x * wave**4


def _stretched(options: Options, element_mm: float, length: float) -> Scene:
    """The rectangle under its tension, all edges held."""
    fabric = fabric_of(options)
    scene = ply_scene(fabric, (SPAN_MM, length), element_mm)
    scene = replace(scene, state=copied_state(scene.state))
    x = positions(scene)
    stretch, stiff = 1.0, fabric.membrane_modulus_N_mm[0]
    for _ in range(5):
        stretch = math.exp(TENSION_N_MM * stretch / stiff)
    x[0] *= stretch
    edge = np.ones(x.shape[1:], bool)
    edge[1:-1, 1:-1] = False
    return held(scene, edge)


def solve(options: Options) -> Answer:
    """A rectangle about four waves long."""
    fabric = fabric_of(options, bending=True)
    first, second = fabric.bending_rigidity_Nmm
    foundation = _foundation(first)
    element = options.element_mm or (QUICK_ELEMENT_MM if options.quick else ELEMENT_MM)
    length = WAVES * 2.0 * math.pi * (second / foundation) ** 0.25
    scenes = [(size, _stretched(options, size, length)) for size in (2.0 * element, element)]
    return wrinkling_answer(scenes, 0, length, second, foundation, areal_mass(fabric))


PROBLEM = Problem(
    "buckling-tension", "Wrinkling of a strip under tension", "linear buckling; Cerda and Mahadevan 2003", solve
)
