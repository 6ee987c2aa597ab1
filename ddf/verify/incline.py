"""A block on an incline: friction of layers and of the tool.

A sheet of diaphragm lies on a held sheet, or on a flat tool, under gravity g at the angle a to the normal. It slides by
g (sin a - mu cos a), and it starts to slide where tan a = mu (Coulomb). Acceleration: at a given angle, from rest, by
the second difference of the mean way over two equal times, after the friction springs have wound up. Threshold: gravity
leans over smoothly (a sudden load swings twice as far) and turns slowly from 1 % below tan a = mu to 1 % above; sought
is the tangent at which the block is three times as far from its place as friction springs let it. At this rate it takes
0.1 to 0.2 % of the tangent to get there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ddf.contact.friction import TANGENTIAL
from ddf.loads.path import smooth_ramp
from ddf.verify.bench import Bench, assemble
from ddf.verify.bench_sheets import FloatArray, ToolContact, Touch, constant_load, even_line, rubber_sheet
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.scenes import GRAVITY
from ddf.verify.tool_fields import gridded, plane

BOUND = 5e-3
BLOCK, TABLE, ELEMENT = 8.0, 60.0, 4.0  # mm
LIFT = 20.0  # height of the tool's flat top above its platform [mm]
STIFFNESS = 1.0  # N/mm3
SLIDES = ((30.0, 0.28), (35.0, 0.52), (40.0, 0.0))  # angle [deg], friction
THRESHOLDS = (0.28, 0.6)
TURN = 0.01  # of the tangent, either way
TURN_TIME, LEAN_TIME = 0.1, 0.01  # s
AWAY = 3.0  # elastic ways that count as sliding


@dataclass(frozen=True)
class Block:
    """A block at rest in its contact."""

    bench: Bench
    sheet: int

    def tilt(self, angle: float) -> None:
        """Turn gravity to an angle [rad] from the normal, towards +x."""
        self.bench.model.gravity[:] = GRAVITY * np.array([math.sin(angle), 0.0, -math.cos(angle)])

    @property
    def way(self) -> float:
        """Mean place along x [mm]."""
        return float(self.bench.x(self.sheet)[0].mean())


def make_block(options: Options, kind: str, friction: float, angle: float) -> Block:
    """A block on a `layer` or on a `tool`, pressed in by its weight at an angle [rad]."""
    path = constant_load()
    block = rubber_sheet(options, (even_line(BLOCK, ELEMENT, 14.0), even_line(BLOCK, ELEMENT)))
    pressed = block.areal_mass * GRAVITY * math.cos(angle) / STIFFNESS
    if kind == "tool":
        block.start[2] = LIFT + 0.5 * block.thickness - pressed
        field = gridded(plane(0.0, LIFT), (-5.0, -20.0, 0.0), (TABLE, 20.0, LIFT + 10.0), 5.0)
        made = Block(assemble([block], path, tool=ToolContact(field, friction, stiffness=STIFFNESS)), 0)
    else:
        lines = (even_line(TABLE, ELEMENT, 0.5 * TABLE), even_line(2.0 * BLOCK, ELEMENT))
        table = rubber_sheet(options, lines, np.ones((lines[0].size, lines[1].size), bool))
        block.start[2] = block.thickness - pressed
        made = Block(assemble([table, block], path, [Touch(1, 0, 1.0, friction, STIFFNESS)]), 1)
    made.tilt(angle)
    return made


def slide(options: Options, kind: str, degrees: float, friction: float, seconds: float = 0.1) -> float:
    """Acceleration of a sliding block [mm/s2]."""
    block = make_block(options, kind, friction, math.radians(degrees))
    sim = block.bench.simulation(options.threads)
    steps = round(seconds / 2.2 / block.bench.model.dt)
    sim.advance(steps // 5)
    ways = [block.way]
    for _ in range(2):
        sim.advance(steps)
        ways.append(block.way)
    sim.close()
    return (ways[2] - 2.0 * ways[1] + ways[0]) / (steps * block.bench.model.dt) ** 2


def threshold(options: Options, kind: str, friction: float) -> tuple[float, FloatArray, FloatArray]:
    """Tangent of the angle at which a block starts to slide; all tangents and ways [mm] on the way."""
    first, last = (math.atan(friction * (1.0 + s * TURN)) for s in (-1.0, 1.0))
    block = make_block(options, kind, friction, 0.0)
    sim, weight = block.bench.simulation(options.threads), block.bench.model.tool_mass * GRAVITY
    steps = round(TURN_TIME / block.bench.model.dt / 10)
    start, tangents, ways = block.way, [], []
    leans = round(steps * LEAN_TIME / TURN_TIME)
    for share in smooth_ramp(np.arange(1, leans + 1) / leans)[0]:
        block.tilt(first * share)
        sim.advance(10)
    for n in range(steps):
        angle = first + (last - first) * (n + 1) / steps
        block.tilt(angle)
        sim.advance(10)
        tangents.append(math.tan(angle))
        ways.append(block.way - start)
    sim.close()
    elastic = weight * math.sin(last) / (TANGENTIAL * STIFFNESS)
    gone = np.flatnonzero(np.array(ways) > AWAY * elastic)
    return tangents[gone[0]] if gone.size else math.nan, np.array(tangents), np.array(ways)


def solve(options: Options) -> Answer:
    """Accelerations and thresholds on layer and tool."""
    slides, frictions = (SLIDES[:1], THRESHOLDS[:1]) if options.quick else (SLIDES, THRESHOLDS)
    checks, curves, rows = [], [], []
    for kind in ("layer", "tool"):
        for degrees, friction in slides:
            a = math.radians(degrees)
            known = GRAVITY * (math.sin(a) - friction * math.cos(a))
            got = slide(options, kind, degrees, friction)
            checks.append(Check(f"acceleration, {kind}, {degrees:g} deg, mu {friction:g}", "mm/s2", known, got, BOUND))
        for friction in frictions:
            tangent, tangents, ways = threshold(options, kind, friction)
            checks.append(Check(f"tangent at the first slip, {kind}, mu {friction:g}", "-", friction, tangent, BOUND))
            every = max(1, tangents.size // 60)
            curves.append(Curve(f"{kind}, mu {friction:g}", tangents[::every] / friction, 1e3 * ways[::every], True))
            rows += [(kind == "tool", friction, t, w) for t, w in zip(tangents[::every], ways[::every], strict=True)]
    top = max(float(c.y.max()) for c in curves)
    curves.append(Curve("known: starts to slide", np.ones(2), np.array([0.0, top])))
    columns = np.array(rows, dtype=float).T
    names = ("on_tool", "friction", "tangent", "way_mm")
    figure = Figure("tangent of the tilt / friction", "way of the block [um]", tuple(curves))
    return Answer(tuple(checks), figure, dict(zip(names, columns, strict=True)))


PROBLEM = Problem("incline", "Block on an incline", "Coulomb's law", solve)
