"""A sheet drawn over another one: the friction force and the heat it makes.

A sheet lies on a held sheet under gravity g; its front line of nodes is drawn over it at a steady speed. Whatever the
sheet's stretch, the rest of it weighs N = sum m g on the other one, the draw is  F = mu N  and the heat of a way s is
F s (Coulomb). The draw on a diaphragm is what the holder of its front line resists; on a ply it is the tension of the
first bars, as the solver keeps it. The heat is the solver's own ledger of friction. Gravity is a hundredfold, so that
the pressure is that of a process rather than that of a weight.
Mass damping quiets the start and has faded before the half of the way that is judged.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddf.loads.path import LoadPath
from ddf.model import FRICTION, sheet_scalars
from ddf.verify.bench import Bench, assemble
from ddf.verify.bench_sheets import (
    FloatArray,
    Sheet,
    Touch,
    edges,
    even_line,
    fabric_sheet,
    ramped_load,
    rubber_sheet,
)
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.scenes import GRAVITY

BOUND = 5e-3
LENGTH, WIDTH, ELEMENT = 40.0, 20.0, 4.0  # mm
GO, LOOKS = 12.0, 24  # way of the front [mm], and how often it is looked at
SPEED = 100.0  # mm/s
HEAVY = 100.0  # gravity over the earth's
STIFFNESS = 1.0  # N/mm3
FADING = ((0.03, 600.0), (0.045, 100.0), (0.06, 20.0), (1.0, 0.0))  # mass damping [1/s] up to a time [s]
KINDS = (("diaphragm", 0.6), ("ply", 0.28))


def _sheets(options: Options, kind: str) -> tuple[Sheet, Sheet]:
    """The held sheet and the drawn one, pressed in by its weight."""
    below = (even_line(LENGTH + GO + 16.0, ELEMENT, 0.5 * GO), even_line(WIDTH + 16.0, ELEMENT))
    above = (even_line(LENGTH, ELEMENT), even_line(WIDTH, ELEMENT))
    make = rubber_sheet if kind == "diaphragm" else fabric_sheet
    bed = make(options, below, np.ones((below[0].size, below[1].size), bool))
    drawn = make(options, above, edges(above, "right"))
    drawn.start[2] = drawn.thickness - drawn.areal_mass * HEAVY * GRAVITY / STIFFNESS
    return bed, drawn


def _draw(bench: Bench, kind: str) -> float:
    """Force of the front line on the sheet [N]."""
    if kind == "diaphragm":
        return float(-bench.f(1)[0, -1].sum())
    return float(sheet_scalars(bench.model, bench.state.tension1, 1)[-2].sum())


def _fading_damping() -> LoadPath:
    """No load; mass damping that ends before the second half of the way: it drags too."""
    until, damping = np.array(FADING).T
    time = np.concatenate([[0.0], until])
    return replace(ramped_load(time, np.zeros_like(time), 0.0), damping=damping)


def pull(options: Options, kind: str, friction: float) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Weight N [N], then way of the front [mm], force [N] and heat [N mm] along it."""
    bed, drawn = _sheets(options, kind)
    touch = Touch(1, 0, 1.0, friction, STIFFNESS)
    bench = assemble([bed, drawn], _fading_damping(), [touch], gravity=(0.0, 0.0, -HEAVY * GRAVITY))
    sim = bench.simulation(options.threads)
    mass = float(np.sum(bench.model.mass))
    steps, looks = round(GO / LOOKS / SPEED / bench.model.dt), []
    bench.v(1)[0, -1] = SPEED
    for _ in range(LOOKS):
        sim.advance(steps)
        way = float(bench.x(1)[0, -1, 0] - drawn.start[0, -1, 0])
        looks.append((way, _draw(bench, kind), bench.state.ledger[:, FRICTION].sum()))
    sim.close()
    way_mm, force, heat = np.array(looks).T
    return mass * HEAVY * GRAVITY, way_mm, force, heat


def solve(options: Options) -> Answer:
    """Force and heat of both kinds of sheet; judged over the second half of the way."""
    checks, curves = [], []
    table: dict[str, FloatArray] = {}
    for kind, friction in KINDS:
        weight, way, force, heat = pull(options, kind, friction)
        half = way.size // 2
        known = friction * weight
        made = float((heat[-1] - heat[half]) / (way[-1] - way[half]))
        checks += [
            Check(f"draw on a {kind}, mu {friction:g}", "N", known, float(force[half:].mean()), BOUND),
            Check(f"heat a way, {kind}, mu {friction:g}", "N", known, made, BOUND),
        ]
        curves += [
            Curve(f"known, {kind}", way[[0, -1]], np.full(2, known)), Curve(f"solver, {kind}", way, force, True)
        ]  # fmt: skip
        table |= {f"{kind}_way_mm": way, f"{kind}_force_N": force, f"{kind}_heat_Nmm": heat}
    return Answer(tuple(checks), Figure("way of the front [mm]", "draw [N]", tuple(curves)), table)


PROBLEM = Problem("sliding", "A sheet drawn over another one", "Coulomb's law", solve)
