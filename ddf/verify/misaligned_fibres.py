"""Fibres across the grid: the bias extension of `bias_extension` with shell-membrane cells along and across the fibres.

A strip at 45 degrees to its fibres shears with fibres that are inextensible. Cells whose sides run along the
fibres can follow that (grid at 45 degrees to the strip); cells along the strip, with the fibres on their diagonals, can
do so at their one point of integration, but in their hourglass patterns only against the control, whose stiffness is a
share of the fibres': they lock (R. ten Thije, R. Akkerman, Int. J. Mater. Form. 1 (2008) 235; N. Hamila, P. Boisse,
Composites Part A 53 (2013) 109). The force over that of the net of least energy says how much, at three
hourglass coefficients. The lattice cannot be built across its fibres.

All is in the plane, so the strip has no bending rigidity here and its cells no shells; masses are scaled.
"""

from __future__ import annotations

import numpy as np

from ddf.verify.bias_extension import HEIGHT_MM, MIDDLE_MM, WIDTH_MM, draw, way
from ddf.verify.net import least_energy, make_net, mean_shear
from ddf.verify.problem import SHELL_MEMBRANE, Answer, Check, Curve, Figure, FloatArray, Options, Problem
from ddf.verify.scenes import entered_law, fabric_of, ply_scene

CELLS, QUICK_CELLS = 12, 8
"""Diagonals of a cell along the fibres over the width."""
HALTS_DEG, QUICK_HALTS_DEG = np.array([10.0, 20.0, 30.0]), np.array([10.0, 20.0])
MASS_SCALING = 16.0
DAMPING_1_S = 25.0
HOURGLASS = (0.005, 0.05, 0.5)
DEFAULT = 0.05
FORCE_BOUND, ANGLE_BOUND_DEG = 0.05, 1.0


def strip(
    options: Options, cells: int, along: bool, hourglass: float, halts: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Angles in the middle [deg] and forces [N] at the halts, with the grid along the fibres or along the strip."""
    fabric = fabric_of(options).model_copy(update={"bending_rigidity_Nmm": (0.0, 0.0)})
    diagonal = WIDTH_MM / cells
    size = (WIDTH_MM, HEIGHT_MM + (2.0 * diagonal if along else 0.0))
    turn, fibre = (45.0, 0.0) if along else (0.0, 45.0)
    scene = ply_scene(
        fabric,
        size,
        diagonal / np.sqrt(2.0),
        turn,
        SHELL_MEMBRANE,
        fibre,
        hourglass=hourglass,
        mass_scaling=MASS_SCALING,
    )
    return draw(scene, DAMPING_1_S, halts)


def solve(options: Options) -> Answer:
    """Both grids against the net of least energy."""
    cells = QUICK_CELLS if options.quick else CELLS
    if options.element_mm is not None:
        cells = max(4, round(WIDTH_MM / (np.sqrt(2.0) * options.element_mm)))
    halts = QUICK_HALTS_DEG if options.quick else HALTS_DEG
    law, net = entered_law(fabric_of(options)), make_net(WIDTH_MM, HEIGHT_MM)
    known = [least_energy(net, float(way(g)), law, 0.5 * float(g)) for g in np.deg2rad(halts)]
    net_force = np.array([pull for _, pull in known])
    net_angle = np.rad2deg([mean_shear(net, t, MIDDLE_MM) for t, _ in known])
    ways = way(np.deg2rad(halts))
    angle, force = strip(options, cells, True, DEFAULT, halts)
    last = f"zones {halts[-1]:g} deg"
    checks = [
        Check(f"force, grid along the fibres, {last}", "N", net_force[-1], force[-1], FORCE_BOUND),
        Check(f"angle, grid along the fibres, {last}", "deg", net_angle[-1], angle[-1], ANGLE_BOUND_DEG, False),
    ]
    curves = [Curve("net of least energy", ways, net_force), Curve("grid along the fibres", ways, force, points=True)]
    table = {"way_mm": ways, "net_force_N": net_force, "net_angle_deg": net_angle, "along_N": force, "along_deg": angle}
    notes = []
    for hourglass in (DEFAULT,) if options.quick else HOURGLASS:
        angle, force = strip(options, cells, False, hourglass, halts)
        name = f"fibres 45 deg to the grid, hourglass {hourglass:g}"
        checks.append(Check(f"force, {name}", "N", net_force[-1], force[-1], None))
        checks.append(Check(f"angle, {name}", "deg", net_angle[-1], angle[-1], None, False))
        curves.append(Curve(name, ways, force, points=True))
        table |= {f"across_{hourglass:g}_N": force, f"across_{hourglass:g}_deg": angle}
        notes.append(f"{name}: {force[-1] / net_force[-1]:.1f} times the net's force at {last}")
    figure = Figure("way of the grips [mm]", "force [N]", tuple(curves), log_y=True)
    return Answer(tuple(checks), figure, table, tuple(notes))


PROBLEM = Problem(
    "misaligned-fibres",
    "Bias extension with the grid along and across the fibres",
    "net of inextensible fibres",
    solve,
    (SHELL_MEMBRANE,),
)
