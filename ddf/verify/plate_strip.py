"""A strip of diaphragm bent and twisted by its ends: the plate's moments, its Poisson and its twisting term.

With free long edges Kirchhoff's plate (rigidity D, nu = 1/2, width b) carries

    bending: w = k/2 (x^2 - nu y^2)    the moment  D (1 - nu^2) k b      (the edges curl the other way)
    twist:   w = q x y                 the torque  2 D (1 - nu) q b      (forces at the corners included)

exactly over its whole length if its ends follow these surfaces (Timoshenko and Woinowsky-Krieger, 2nd ed., sections
10 and 11). The first two and last two lines of nodes are held on them, the rest starts flat and must find them; moment
and torque are those of the holder. Deflections are so small that the membrane is idle.

A node on a free edge knows no curvature across the edge: half a cell there is bent as if flat across, stiffer by
1/(1 - nu^2) = 4/3. The moment is therefore too large by h/(3 b), first order in the cell h along the edges; twisting is
exact on any grid. Fine cells at the edges keep that small; the order is observed on even grids.
"""

from __future__ import annotations

from math import log

import numpy as np

from ddf.verify.bench import assemble, come_to_rest, drive
from ddf.verify.bench_sheets import FloatArray, constant_load, flat_start, rubber_sheet
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem

BOUND = 1e-2
LENGTH, WIDTH, ELEMENT = 15.0, 12.0, 1.5  # mm
CURVATURE = 1e-6  # 1/mm
EDGE_CELL = 0.25  # mm
SPEED = 1e-8  # mm/s at which the strip counts as at rest


def _across(element: float, finest: float) -> FloatArray:
    """Symmetric places across the strip [mm]: cells of `finest` at the edges, doubling up to `element`."""
    sizes, left = [finest], 0.5 * WIDTH - finest
    while left > 1e-9:
        step = min(2.0 * sizes[-1], element)
        count = max(1, round(left / step))
        if step >= element or left < 2.0 * step:
            sizes += [left / count] * count
            break
        sizes.append(step)
        left -= step
    half = np.concatenate([[0.0], np.cumsum(sizes)]) - 0.5 * WIDTH
    return np.concatenate([half, -half[-2::-1]])


def hold(options: Options, across: FloatArray, twist: bool) -> tuple[float, float, FloatArray, FloatArray]:
    """Moment or torque got and known [N mm], the deflections (n, m) over the known ones, and x, y (2, n, m)."""
    element = options.element_mm or ELEMENT
    lines = (np.linspace(-0.5, 0.5, round(LENGTH / element) + 1) * LENGTH, across)
    held = np.zeros((lines[0].size, lines[1].size), bool)
    held[[0, 1, -2, -1]] = True
    sheet = rubber_sheet(options, lines, held, bending=True)
    x, y, _ = flat_start(lines)
    target = flat_start(lines)
    target[2] = CURVATURE * (x * y if twist else 0.5 * (x * x - 0.5 * y * y))
    omega = 22.4 / LENGTH**2 * np.sqrt(sheet.rigidity / sheet.areal_mass)
    bench = assemble([sheet], constant_load(damping=2.0 * omega))
    sim = bench.simulation(options.threads)
    drive(bench, sim, 0, target, 4.0 / omega)
    come_to_rest(bench, sim, SPEED, 40.0 / omega)
    sim.close()
    lever = y if twist else x
    got = float(np.sum(bench.f()[2, :2] * lever[:2]))  # moment of the left holder
    factor = 2.0 * 0.5 if twist else -0.75  # 2 (1 - nu); the left end turns against the right one
    return abs(got), abs(factor) * sheet.rigidity * CURVATURE * WIDTH, bench.x()[2] / CURVATURE, np.array([x, y])


def solve(options: Options) -> Answer:
    """Moment and torque of the ends."""
    element = options.element_mm or ELEMENT
    fine = _across(element, EDGE_CELL)
    moment, moment_known, bent, place = hold(options, fine, twist=False)
    torque, torque_known, twisted, _ = hold(options, fine, twist=True)
    notes = []
    if not options.quick:
        sizes = (1.5, 0.75)
        off = []
        for size in sizes:
            got, known, *_ = hold(options, np.linspace(-0.5, 0.5, round(WIDTH / size) + 1) * WIDTH, twist=False)
            off.append(got / known - 1.0)
            notes.append(f"even cells of {size:g} mm across: moment {100 * off[-1]:+.3f} %")
        notes.append(f"observed order on even cells: {log(off[0] / off[1]) / log(sizes[0] / sizes[1]):.2f}")
    x, y = place
    saddle, screw = 0.5 * (x * x - 0.5 * y * y), x * y
    bent_off, twisted_off = (
        float(np.abs(got - shape).max() / shape.max()) for got, shape in ((bent, saddle), (twisted, screw))
    )
    checks = (
        Check("moment of the ends", "N mm", moment_known, moment, BOUND),
        Check("torque of the ends", "N mm", torque_known, torque, BOUND),
        Check("shape when bent, largest error", "-", 0.0, bent_off, BOUND, False),
        Check("shape when twisted, largest error", "-", 0.0, twisted_off, BOUND, False),
    )  # fmt: skip
    row = x.shape[0] // 2
    curves = (
        Curve("known, across the middle", y[row], saddle[row]), Curve("solver", y[row], bent[row], True),
        Curve("known, along an edge", x[:, 0], saddle[:, 0]), Curve("solver, along an edge", x[:, 0], bent[:, 0], True),
    )  # fmt: skip
    table = {"x_mm": x.ravel(), "y_mm": y.ravel(), "bent_mm2": bent.ravel(), "twisted_mm2": twisted.ravel()}
    return Answer(checks, Figure("y or x [mm]", "deflection over curvature [mm2]", curves), table, tuple(notes))


PROBLEM = Problem(
    "plate-strip", "Strip of diaphragm bent and twisted by its ends",
    "Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells", solve,
)  # fmt: skip
