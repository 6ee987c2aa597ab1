"""A fold without self-contact: a strip of diaphragm whose ends are pushed together, and past each other.

The strip bulges into a loop. As its ends meet the flanks touch; nothing in the contact of layers keeps a sheet from
itself, so beyond that they pass through one another. Only the struts of `elements.fold` keep its radius. The guard is
the audit's exact count of edges that pass through their own sheet; it does not see flanks that lie nearer than the
sheet is thick and do not cross yet.
"""

from __future__ import annotations

import numpy as np

from ddf.monitors.audit import crossing_check
from ddf.monitors.crossings import crossings_of
from ddf.study.stability.map import WARNED, FloatArray, Limit, Map, RuleLine, Spot, grid, judge
from ddf.verify.bench import assemble, drive
from ddf.verify.bench_sheets import constant_load, edges, even_line, rubber_sheet
from ddf.verify.problem import Options

LENGTH_MM, WIDTH_MM, ELEMENT_MM = 60.0, 8.0, 3.0
GAPS, QUICK_GAPS = (0.5, 0.25, 0.1, 0.05, 0.0, -0.1, -0.25), (0.1, -0.1)
THICKNESSES, QUICK_THICKNESSES = (0.5, 1.0, 1.5), (1.5,)
DAMPING_1_S, SECONDS, REST_STEPS = 200.0, 0.05, 200
BULGE_MM = 2.0


def folded(gap: float, thickness: float) -> FloatArray:
    """Positions (3, n, m) of the strip with its ends `gap` of its length apart."""
    lines = (even_line(LENGTH_MM, ELEMENT_MM), even_line(WIDTH_MM, 4.0))
    sheet = rubber_sheet(Options(), lines, edges(lines, "left", "right"), thickness=thickness, bending=True)
    sheet.start[2] += BULGE_MM * np.cos(np.pi * lines[0] / LENGTH_MM)[:, None]
    bench = assemble([sheet], constant_load(damping=DAMPING_1_S))
    sim, target = bench.simulation(), bench.x().copy()
    target[0] *= gap
    drive(bench, sim, 0, target, SECONDS)
    sim.advance(REST_STEPS)
    sim.close()
    return bench.x()


def _spot(gap: float, thickness: float) -> Spot:
    x = folded(gap, thickness)
    left, right = x[0, : x.shape[1] // 2], x[0, : -(x.shape[1] // 2) - 1 : -1]
    apart = float((right - left).min())  # of the flanks, at equal heights by symmetry
    check = crossing_check(crossings_of(x, np.ones((x.shape[1] - 1, x.shape[2] - 1), bool)))
    guard = "" if check["ok"] else f"{check['name']}: {check['value']:.0f}"
    verdict, guard = judge(apart >= thickness, WARNED, guard)
    return Spot(gap, thickness, gap * LENGTH_MM >= thickness, verdict, apart, guard)


def chart(quick: bool) -> Map:
    """Distances of the ends and thicknesses."""
    gaps, thicknesses = (QUICK_GAPS, QUICK_THICKNESSES) if quick else (GAPS, THICKNESSES)
    spots = tuple(_spot(gap, thickness) for gap, thickness in grid(gaps, thicknesses))
    ends = np.array([0.3, 1.8])
    lines = (RuleLine("flanks touch", ends / LENGTH_MM, ends),)
    return Map("distance of the ends over the length", "thickness [mm]", "distance of the flanks' middle surfaces [mm]",
               spots, lines, log_x=False, log_y=False)  # fmt: skip


LIMIT = Limit(
    "fold", "A fold that closes on itself, without self-contact", "flanks farther apart than the sheet is thick", chart,
)  # fmt: skip
