"""Compressed rubber: a sheet pressed in its plane, held flat, rough at first, at the step of its bound.

Pressed rubber is thicker and stiffer, which the bound of the step allows for (power iteration found 7.2e9 1/s^2 at 0.7
of the length, at true mass and 2.5 mm, against a bound of 5.6e9), and the stress in it lets every roughness grow.
Beyond 0.7 of its area the even state is lost, at half the step as well: a real sheet would long have left its plane.
"""

from __future__ import annotations

import numpy as np

from ddf.monitors.stability import check_state
from ddf.study.stability.map import STOPPED, Limit, Map, RuleLine, Spot, judge
from ddf.verify.bench import assemble
from ddf.verify.bench_sheets import constant_load, edges, even_line, rubber_sheet
from ddf.verify.problem import Options

STRETCHES, QUICK_STRETCHES = (0.15, 0.3, 0.45, 0.6, 0.7, 0.85, 1.0, 1.5), (0.3, 0.7, 1.0)
SIDE_MM, ELEMENT_MM = 40.0, 4.0
ROUGH = 0.02  # of an element, at first
STEPS, LOOK = 1500, 50
DAMPING_1_S = 200.0
LEAST_AREA = 0.7


def pressed(first: float, second: float, share: float = 1.0) -> tuple[float, str]:
    """How far a sheet at two stretches is off them in the end [elements], and the guard's word; share: of the step."""
    lines = (even_line(SIDE_MM, ELEMENT_MM), even_line(SIDE_MM, ELEMENT_MM))
    sheet = rubber_sheet(Options(), lines, edges(lines, "left", "right", "front", "back"))
    bench = assemble([sheet], constant_load(damping=DAMPING_1_S))
    bench = bench.with_step(share * bench.model.dt)
    x, free = bench.x(), ~sheet.held
    x[0] *= first
    x[1] *= second
    even = x.copy()
    rng = np.random.default_rng(0)
    x[:2, free] += ROUGH * ELEMENT_MM * rng.uniform(-1.0, 1.0, x[:2, free].shape) * np.array([[first], [second]])
    start, sim = bench.state.x.copy(), bench.simulation()
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(STEPS // LOOK):
            sim.advance(LOOK)
            alarm = check_state(bench.model, bench.state, ["diaphragm"], start)
            if alarm is not None:
                sim.close()
                return np.inf, alarm.problem.partition(" of ")[0]
    sim.close()
    return float(np.abs(x - even).max()) / ELEMENT_MM, ""


def chart(quick: bool) -> Map:
    """Both stretches."""
    stretches = QUICK_STRETCHES if quick else STRETCHES
    spots = []
    for first in stretches:
        for second in (s for s in stretches if s <= first):
            away, guard = pressed(first, second)
            verdict, guard = judge(away < ROUGH, STOPPED, guard)
            spots.append(Spot(first, second, first * second >= LEAST_AREA - 1e-9, verdict, away, guard))
    line = np.linspace(0.4, 1.8, 60)
    half = pressed(0.6, 0.6, 0.5)[1]
    note = f"0.6 x 0.6 at half the step: {half or 'right'}"
    rule = RuleLine("0.7 of the area", line, LEAST_AREA / line)
    return Map(
        "stretch", "stretch across", "farthest node off the even state [elements]", tuple(spots), (rule,),
        log_x=False, log_y=False, notes=(note,),
    )  # fmt: skip


LIMIT = Limit(
    "compressed-rubber", "A diaphragm pressed in its plane", "not less than 0.7 of its area at the stable step", chart,
)  # fmt: skip
