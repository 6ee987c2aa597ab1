"""Buckling of a strip along a fibre family, its ends pinned: N_cr = B (pi / L)^2 (Euler's column, per width)."""

from __future__ import annotations

import math

import numpy as np

from ddf.verify.buckling import LOADS, critical_modes, moving_load
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.scenes import areal_mass, fabric_of, held, ply_scene, positions

LENGTH_MM = 100.0
ELEMENT_MM, QUICK_ELEMENT_MM = 2.5, 5.0
BOUND = 0.02


def solve(options: Options) -> Answer:
    """Critical load by both ways, and its order of convergence."""
    fabric = fabric_of(options, bending=True)
    element = options.element_mm or (QUICK_ELEMENT_MM if options.quick else ELEMENT_MM)
    rigidity = fabric.bending_rigidity_Nmm[1]
    wave = math.pi / LENGTH_MM
    known = rigidity * wave**2
    loads = []
    for size in (2.0 * element, element):
        flat = ply_scene(fabric, (2.0 * size, LENGTH_MM), size)
        ends = np.abs(positions(flat)[1]) > 0.5 * LENGTH_MM - 0.1 * size
        scene = held(flat, ends)
        modes = critical_modes(scene, known, 1)
        loads.append(float(modes.load[0]))
    omega = wave**2 * math.sqrt(rigidity / areal_mass(fabric))
    squares, moved = moving_load(scene, modes.shape[0], omega, known)
    checks = (
        Check("critical load, stiffness", "N/mm", known, loads[1], BOUND),
        Check("critical load, motion", "N/mm", known, moved, BOUND),
        Check("unloaded frequency", "1/s", omega, math.sqrt(squares[0]), BOUND),
    )
    errors = [abs(load / known - 1.0) for load in loads]
    note = f"error {errors[0]:.1e} at {2 * element:g} mm, {errors[1]:.1e} at {element:g} mm: observed order "
    note += f"{math.log2(errors[0] / errors[1]):.2f}"
    line = np.array([0.0, LOADS[-1]])
    curves = (
        Curve("1 - N / N_cr", line, 1.0 - line),
        Curve("motion", LOADS, squares / omega**2, points=True),
    )
    figure = Figure("N / N_cr", "omega^2 / omega0^2", curves)
    table = {"load_N_mm": LOADS * known, "omega_square_1_s2": squares}
    return Answer(checks, figure, table, (note,))


PROBLEM = Problem("buckling-strip", "Buckling of a free strip between pinned ends", "Euler's column", solve)
