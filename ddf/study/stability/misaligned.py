"""Fibres at an angle to the grid: shell-membrane cells lock, the lattice cannot be built so.

A strip at 45 degrees to its fibres is drawn, with the grid at an angle to the fibres. The force over that of the net of
least energy says how much the hourglass control, a share of the fibres' stiffness, is in the way (R. ten Thije, R.
Akkerman, Int. J. Mater. Form. 1 (2008) 235). A case lays the grid along the fibres at any orientation, for both
formulations, so nothing beyond the rule can be asked for: the map turns the fibres by hand.
"""

from __future__ import annotations

import numpy as np

from ddf.study.stability.map import REFUSED, Limit, Map, RuleLine, Spot, grid, judge
from ddf.verify.bias_extension import HEIGHT_MM, WIDTH_MM, draw, draw_strip, way
from ddf.verify.net import least_energy, make_net
from ddf.verify.problem import SHELL_MEMBRANE, Options
from ddf.verify.scenes import entered_law, fabric_of, ply_scene

ANGLES, QUICK_ANGLES = (0.0, 45.0), (0.0, 45.0)
COEFFICIENTS, QUICK_COEFFICIENTS = (0.005, 0.05, 0.5), (0.05,)
LATTICE = 1e-3  # where the lattice, which has no such coefficient, stands in the map
CELLS = 6  # diagonals of a cell over the width
HALTS_DEG = np.array([10.0])
MASS_SCALING, DAMPING_1_S = 64.0, 50.0
RIGHT = 1.15
"""Force over that of the net; along the fibres 1 to 1.1 at this coarse grid."""
NOWHERE = "cannot be asked for: a case lays the grid along the fibres"


def _force(angle: float, coefficient: float) -> float:
    """Force on the grips [N] with fibres at an angle [deg] to a grid that runs at 45 degrees less it to the strip."""
    fabric = fabric_of(Options()).model_copy(update={"bending_rigidity_Nmm": (0.0, 0.0)})
    diagonal = WIDTH_MM / CELLS
    size = (WIDTH_MM, HEIGHT_MM + (2.0 * diagonal if angle == 0.0 else 0.0))
    scene = ply_scene(
        fabric, size, diagonal / np.sqrt(2.0), 45.0 - angle, SHELL_MEMBRANE, angle, hourglass=coefficient,
        mass_scaling=MASS_SCALING,
    )  # fmt: skip
    return float(draw(scene, DAMPING_1_S, HALTS_DEG)[1][0])


def chart(quick: bool) -> Map:
    """Angles and hourglass coefficients; the lattice along its fibres beside them."""
    angles, coefficients = (QUICK_ANGLES, QUICK_COEFFICIENTS) if quick else (ANGLES, COEFFICIENTS)
    law, net = entered_law(fabric_of(Options())), make_net(WIDTH_MM, HEIGHT_MM)
    halt = float(np.deg2rad(HALTS_DEG[0]))
    known = least_energy(net, float(way(np.array(halt))), law, 0.5 * halt)[1]
    lattice = float(draw_strip(Options(), CELLS, HALTS_DEG)[1][0]) / known
    spots = [Spot(0.0, LATTICE, True, judge(lattice <= RIGHT, "", "")[0], lattice)]
    for angle, coefficient in grid(angles, coefficients):
        share = _force(angle, coefficient) / known
        right = bool(share <= RIGHT)
        verdict, guard = judge(right, REFUSED, NOWHERE if angle else "")
        spots.append(Spot(angle, coefficient, angle == 0.0, verdict, share, guard))
    ends = np.array([5e-4, 1.0])
    lines = (RuleLine("grid along the fibres", np.zeros(2), ends),)
    return Map("fibres to the grid [deg]", f"solver.hourglass (lattice: at {LATTICE:g})", "force over the net's",
               tuple(spots), lines, log_x=False)  # fmt: skip


LIMIT = Limit(
    "misaligned-fibres", "Bias extension with fibres at an angle to the grid",
    "the grid runs along the fibres, always: there is no key for anything else", chart,
)  # fmt: skip
