"""A cantilever along a fibre family under its own weight against the heavy elastica, from small to very large bending.

A strip of the lattice along a family, its fibres stiff and its bending soft, is an elastica with hinges at the
nodes. The hinge of the last clamped node stands for half a bar before and behind it, so the clamp ends half a
bar before that node: the strip has L = (cells - 1/2) a. Errors then fall as a^2. Shell-membrane cells clamp the
directors of the held nodes themselves: L = cells a.
"""

from __future__ import annotations

import math

import numpy as np

from ddf.verify.cantilever import Cantilever
from ddf.verify.elastica import heavy_elastica
from ddf.verify.problem import LATTICE, SHELL_MEMBRANE, Answer, Check, Curve, Figure, FloatArray, Options, Problem
from ddf.verify.scenes import areal_mass, fabric_of, held, ply_scene, positions

LENGTH_MM = 40.0
ELEMENT_MM = 1.0
QUICK_ELEMENT_MM = 2.0
GAMMAS = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
QUICK_GAMMAS = (1.0, 10.0, 100.0)
ORDER_GAMMA = 10.0
BOUND = 0.005
"""Largest error of the tip's place, over the strip's length."""


def _cantilever(options: Options, element_mm: float) -> Cantilever:
    fabric = fabric_of(options, bending=True)
    cells = max(4, round(LENGTH_MM / element_mm + 0.5))
    clamped = 0.0 if options.shell else 0.5  # of a cell
    a = LENGTH_MM / (cells - clamped)
    scene = ply_scene(fabric, (2.0 * a, cells * a), a, formulation=options.formulation)
    x = positions(scene)
    x[1] += a * (0.5 * cells - clamped)  # the clamp ends at y = 0
    clamp, tip = np.zeros(x.shape[1:], bool), np.zeros(x.shape[1:], bool)
    clamp[:, : 1 if options.shell else 2] = tip[:, -1] = True
    return Cantilever(held(scene, clamp), LENGTH_MM, fabric.bending_rigidity_Nmm[1], areal_mass(fabric), tip)


def _tip(options: Options, element_mm: float, gammas: tuple[float, ...]) -> tuple[FloatArray, list[FloatArray]]:
    """Tip (2, loads): ahead and drop over the length; and the shapes (2, cols) of the strip's middle line."""
    strip = _cantilever(options, element_mm)
    tips, shapes = [], []
    for gamma in gammas:
        _, ahead, up = strip.sag(gamma * strip.rigidity / LENGTH_MM**3)
        tips.append((ahead / LENGTH_MM, -up / LENGTH_MM))
        shapes.append(positions(strip.scene)[1:, 1, 1:] / LENGTH_MM)
    return np.array(tips).T, shapes


def solve(options: Options) -> Answer:
    """Tips at all loads, and the order of convergence at one of them."""
    element = options.element_mm or (QUICK_ELEMENT_MM if options.quick else ELEMENT_MM)
    gammas = QUICK_GAMMAS if options.quick else GAMMAS
    got, shapes = _tip(options, element, gammas)
    checks, known = [], []
    for k, gamma in enumerate(gammas):
        exact = heavy_elastica(gamma)
        for name, expected, value in (("ahead", exact.x[-1], got[0, k]), ("drop", exact.drop[-1], got[1, k])):
            checks.append(Check(f"tip {name}/L at Gamma = {gamma:g}", "1", expected, value, BOUND, relative=False))
        known.append(exact)
    curves = [Curve("elastica", shape.x, -shape.drop) for shape in known]
    curves += [
        Curve(f"Gamma = {gamma:g}", shape[0], shape[1], points=True)
        for gamma, shape in zip(gammas, shapes, strict=True)
    ]
    where = gammas.index(ORDER_GAMMA)
    exact_tip = np.array([known[where].x[-1], known[where].drop[-1]])
    coarse, _ = _tip(options, 2.0 * element, (ORDER_GAMMA,))
    errors = [float(np.hypot(*(tip - exact_tip))) for tip in (coarse[:, 0], got[:, where])]
    note = (
        f"tip error over L at Gamma = {ORDER_GAMMA:g}: {errors[0]:.2e} at {2 * element:g} mm, {errors[1]:.2e} at "
        f"{element:g} mm: observed order {math.log2(errors[0] / errors[1]):.2f}"
    )
    table = {
        "gamma": np.array(gammas),
        "tip_ahead_expected": np.array([shape.x[-1] for shape in known]), "tip_ahead": got[0],
        "tip_drop_expected": np.array([shape.drop[-1] for shape in known]), "tip_drop": got[1],
    }  # fmt: skip
    figure = Figure("ahead of the clamp / L", "height / L", tuple(curves), equal_axes=True)
    return Answer(tuple(checks), figure, table, (note,))


PROBLEM = Problem(
    "heavy-elastica",
    "Cantilever under its own weight, 0/90",
    "heavy elastica, Peirce 1930, Bickley 1934; boundary value problem solved here",
    solve,
    (LATTICE, SHELL_MEMBRANE),
)
