"""A strip drawn round a bar: the capstan law, of a diaphragm on the tool and of a ply on a held sheet.

A strip wrapped by the angle b round a round bar with friction mu slides when its tensions stand as

    T2 / T1 = exp(mu b)                                                   (Euler 1762, Eytelwein 1808)

whatever the bar's radius. The strip starts wrapped and slack; its leading end is drawn until the strip is tight, then
both ends go on at the same speed along their tangents. Tensions are those of the ends: what the holder resists of the
diaphragm, what the solver keeps of the ply's bars. They are averaged while several cells pass: a cell is straight,
and tensions swing as its nodes come and go.
The bar is a tool (2 x 2 contact points a cell against a distance field) or a held sheet (nodes against its surface).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ddf.model import sheet_scalars
from ddf.verify.bench import CHUNK, Bench, assemble
from ddf.verify.bench_sheets import (
    FloatArray,
    Sheet,
    ToolContact,
    Touch,
    constant_load,
    edges,
    even_line,
    fabric_sheet,
    rubber_sheet,
)
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.tool_fields import cylinder, gridded

BOUND = 2e-2
RADIUS, WIDTH, STRAIGHT, ELEMENT = 20.0, 8.0, 16.0, 2.0  # mm
AXIS = 100.0  # height of a tool's axis above its platform [mm]
TENSION = {"tool": 0.5, "layer": 2.0}  # of the leading end when the strip is tight: much above D/R^2 [N/mm]
SPEED, WAY, JUDGED = 100.0, 5.0, 2.5  # mm/s, mm: way of both ends, and the last part of it that is averaged
TIGHTEN = {"tool": 40.0, "layer": 5.0}  # speed of the leading end before [mm/s]
DAMPING = 30.0  # 1/s
STIFFNESS = 10.0  # N/mm3
CASES = (
    ("tool", 90.0, 0.28),
    ("tool", 180.0, 0.28),
    ("layer", 90.0, 0.28),
    ("layer", 180.0, 0.28),
    ("layer", 180.0, 0.6),
)
QUICK = (("tool", 180.0, 0.28), ("layer", 90.0, 0.52))


def _wrapped(s: FloatArray, radius: float, wrap: float) -> FloatArray:
    """Points (3, k) at the arc lengths s, 0 at the top: round the axis y = 0 and straight on beyond the wrap [rad]."""
    q = np.clip(s / radius, -0.5 * wrap, 0.5 * wrap)
    rest = s - radius * q
    return np.array([radius * np.sin(q) + rest * np.cos(q), np.zeros_like(s), radius * np.cos(q) - rest * np.sin(q)])


def _surface(lines: tuple[FloatArray, FloatArray], radius: float, wrap: float) -> FloatArray:
    x = np.repeat(_wrapped(lines[0], radius, wrap)[:, :, None], lines[1].size, axis=2)
    x[1] = lines[1]
    return x


@dataclass(frozen=True)
class Strip:
    """A strip on its bar; `sheet` is its number."""

    bench: Bench
    sheet: int
    start: Sheet
    wrap: float

    def along(self) -> tuple[FloatArray, FloatArray]:
        """Directions (3,) in which the trailing and the leading straight part run forward."""
        c, s = math.cos(0.5 * self.wrap), math.sin(0.5 * self.wrap)
        return np.array([c, 0.0, s]), np.array([c, 0.0, -s])

    def tension(self) -> tuple[float, float]:
        """Tensions [N/mm] of the trailing and the leading end."""
        f, fibres = self.bench.f(self.sheet), sheet_scalars(self.bench.model, self.bench.state.tension1, self.sheet)
        trailing, leading = self.along()
        first = float(trailing @ f[:, 0].sum(axis=1) + fibres[0].sum())
        last = float(-leading @ f[:, -1].sum(axis=1) + fibres[-2].sum())
        return first / WIDTH, last / WIDTH

    def go(self, trailing: float, leading: float) -> None:
        """Let the ends go at these speeds [mm/s] along their tangents."""
        v = self.bench.v(self.sheet)
        for row, speed, along in zip((0, -1), (trailing, leading), self.along(), strict=True):
            v[:, row] = speed * along[:, None]


def make_strip(options: Options, kind: str, degrees: float, friction: float) -> Strip:
    """A slack strip round a `tool` (of diaphragm) or a `layer` (of ply)."""
    wrap, element = math.radians(degrees), options.element_mm or ELEMENT
    length = RADIUS * wrap + 2.0 * STRAIGHT + WAY
    lines = (even_line(length, element, -0.5 * WAY), even_line(WIDTH, element))  # more of it on the trailing side
    make = rubber_sheet if kind == "tool" else fabric_sheet
    strip = make(options, lines, edges(lines, "left", "right"))
    half = 0.5 * strip.thickness
    if kind == "tool":
        strip = replace(strip, start=_surface(lines, RADIUS + half, wrap))
        reach = RADIUS + 6.0
        corners = (-reach, -WIDTH, AXIS - reach), (reach, WIDTH, AXIS + reach)
        field = gridded(cylinder(RADIUS, AXIS), *corners, spacing=0.5)
        tool = ToolContact(field, friction, -AXIS, STIFFNESS)
        return Strip(assemble([strip], constant_load(damping=DAMPING), tool=tool), 0, strip, wrap)
    around = (even_line(RADIUS * (wrap + 0.6), element), even_line(WIDTH + 6.0, element))
    bar = rubber_sheet(options, around, np.ones((around[0].size, around[1].size), bool))
    bar = replace(bar, start=_surface(around, RADIUS, 2.0 * math.pi))
    strip = replace(strip, start=_surface(lines, RADIUS + 0.5 * bar.thickness + half, wrap))
    touch = Touch(1, 0, 1.0, friction, STIFFNESS)
    return Strip(assemble([bar, strip], constant_load(damping=DAMPING), [touch]), 1, strip, wrap)


def draw(options: Options, kind: str, degrees: float, friction: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Ways [mm] after the strip is tight, and tensions of both ends [N/mm]."""
    strip = make_strip(options, kind, degrees, friction)
    sim = strip.bench.simulation(options.threads)
    strip.go(0.0, TIGHTEN[kind])
    while strip.tension()[1] < TENSION[kind] and sim.time < 1.0:
        sim.advance(CHUNK)
    strip.go(SPEED, SPEED)
    start, looks = sim.time, []
    while sim.time < start + WAY / SPEED:
        sim.advance(2 * CHUNK)
        looks.append((SPEED * (sim.time - start), *strip.tension()))
    sim.close()
    way, trailing, leading = np.array(looks).T
    return way, trailing, leading


def solve(options: Options) -> Answer:
    """Ratio of the tensions for tool and layer, several angles and frictions."""
    checks, curves, rows = [], [], []
    for number, (kind, degrees, friction) in enumerate(QUICK if options.quick else CASES):
        way, trailing, leading = draw(options, kind, degrees, friction)
        late = way > WAY - JUDGED
        known = math.exp(friction * math.radians(degrees))
        got = float(leading[late].mean() / trailing[late].mean())
        checks.append(Check(f"T2/T1, {kind}, {degrees:g} deg, mu {friction:g}", "-", known, got, BOUND))
        every = np.s_[:: max(1, way.size // 60)]
        curves.append(Curve(f"known, {degrees:g} deg, mu {friction:g}", np.array([0.0, WAY]), np.full(2, known)))
        curves.append(Curve(f"{kind}, {degrees:g} deg, mu {friction:g}", way[every], (leading / trailing)[every], True))
        rows += [(number, *row) for row in zip(way[every], trailing[every], leading[every], strict=True)]
    names = ("case", "way_mm", "trailing_N_mm", "leading_N_mm")
    table = dict(zip(names, np.array(rows, dtype=float).T, strict=True))
    return Answer(tuple(checks), Figure("way of the ends [mm]", "T2 / T1", tuple(curves)), table)


PROBLEM = Problem("capstan", "Strip drawn round a bar", "capstan law of Euler and Eytelwein", solve)
