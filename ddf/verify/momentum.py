"""Contact conserves momentum and never makes heat negative, whatever the motion.

Two free sheets, the upper one turned by 20 degrees and pressed in by a tenth of a millimetre at first, get a sliding, a
turning and a random velocity at every node. Without load and damping of mass, internal forces, contact and friction
keep their common  P = sum m v  and  L = sum x cross m v  (v half a step behind x: the leapfrog keeps both where forces
and moments cancel). Drifts are over sum m |v| and sum m |v| |x|. Each step's friction heat of every block of rows
is looked at on its own.

A ply's fibre tension keeps P but not L (its implicit string stiffness, see `elements.tension`), so where a ply takes
part L is reported, and judged is the moment of all other forces in every step, sum x cross f over sum |x| |f|; also
in a first step in which the places of the slave's nodes on the master are up to 0.9 cells off.

A strip folded over, its flanks as deep in each other, gets the same velocities: it touches itself.

The tool is rigid and takes momentum; a flat one without friction leaves P_x, P_y and L_z of a sheet alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ddf.model import FRICTION, TOOL_FRICTION
from ddf.simulate import Simulation
from ddf.verify.bench import Bench, assemble
from ddf.verify.bench_sheets import (
    FloatArray,
    Sheet,
    ToolContact,
    Touch,
    constant_load,
    even_line,
    fabric_sheet,
    rubber_sheet,
)
from ddf.verify.folded import folded_sheet
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.tool_fields import gridded, plane

BOUND = 1e-10
PRESSED = 0.1  # mm
SPEED = 400.0  # mm/s
TOOL_TOP = 20.0  # mm
MISPLACED = (0.6, 0.9)  # cells; a node more than one off does not touch
Make = Callable[..., Sheet]
PAIRS: dict[str, tuple[Make, Make]] = {
    "ply on diaphragm": (rubber_sheet, fabric_sheet),
    "ply on ply": (fabric_sheet, fabric_sheet),
    "diaphragm on diaphragm": (rubber_sheet, rubber_sheet),
}
FOLDS: dict[str, Make] = {"diaphragm on itself": rubber_sheet, "ply on itself": fabric_sheet}


@dataclass(frozen=True)
class History:
    """Step by step: drifts of P and L, moment of the forces; the least friction heat of a block, momentum exchanged."""

    linear: FloatArray
    angular: FloatArray
    moment: FloatArray  # of the explicit forces
    least_heat: float  # over the whole heat
    heat: float  # [N mm]
    exchanged: float  # of sum m |v|


BELOW = (even_line(50.0, 5.0), even_line(40.0, 5.0))
ABOVE = (even_line(36.0, 4.0), even_line(28.0, 4.0))


def _turned(sheet: Sheet, degrees: float, z: float) -> Sheet:
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    x, y, _ = sheet.start
    return replace(sheet, start=np.array([c * x - s * y, s * x + c * y, np.full_like(x, z)]))


def two_sheets(options: Options, below: Make, above: Make, friction: float) -> Bench:
    """Two sheets in contact; diaphragms touch each other both ways, as in a run."""
    master = below(options, BELOW)
    slave = above(options, ABOVE)
    slave = _turned(slave, 20.0, 0.5 * (master.thickness + slave.thickness) - PRESSED)
    touches = [Touch(1, 0, 1.0, friction)]
    if below is above is rubber_sheet:
        touches = [Touch(1, 0, 1.0, friction, 0.5), Touch(0, 1, -1.0, friction, 0.5)]
    return assemble([master, slave], constant_load(), touches)


def on_tool(options: Options, friction: float) -> Bench:
    """A diaphragm on a flat tool above its platform."""
    sheet = rubber_sheet(options, ABOVE)
    sheet = _turned(sheet, 20.0, TOOL_TOP + 0.5 * sheet.thickness - PRESSED)
    field = gridded(plane(0.0, TOOL_TOP), (-60.0, -60.0, 0.0), (60.0, 60.0, TOOL_TOP + 20.0), 5.0)
    return assemble([sheet], constant_load(), tool=ToolContact(field, friction))


def _momenta(bench: Bench) -> tuple[FloatArray, FloatArray]:
    """P and L of all sheets [tonne mm/s, tonne mm2/s], (sheets, 3) each."""
    linear, angular = [], []
    for k in range(bench.model.sheets.size):
        record = bench.model.sheets[k]
        n = int(record["rows"] * record["cols"])
        mass = bench.model.mass[int(record["node"]) :][:n]
        p = mass * bench.v(k).reshape(3, -1)
        linear.append(p.sum(axis=1))
        angular.append(np.cross(bench.x(k).reshape(3, -1).T, p.T).sum(axis=0))
    return np.array(linear), np.array(angular)


def _set_off(bench: Bench, seed: int = 0) -> None:
    """Give all nodes their velocities."""
    rng = np.random.default_rng(seed)
    for k in range(bench.model.sheets.size):
        v, x = bench.v(k), bench.x(k)
        v += rng.normal(size=v.shape) * SPEED + SPEED * rng.normal(size=(3, 1, 1))
        v += np.cross(rng.normal(size=3) * 20.0, x, axisb=0, axisc=0)
        v[2] += SPEED if k == 0 and bench.model.tool_sheet < 0 else -SPEED  # towards each other


def _moment(bench: Bench, sim: Simulation) -> float:
    """Moment of a step's explicit forces over sum |x| |f|; makes the step."""
    sheets = range(bench.model.sheets.size)
    x = np.concatenate([bench.x(k).reshape(3, -1) for k in sheets], axis=1)
    sim.advance(1)
    f = np.concatenate([bench.f(k).reshape(3, -1) for k in sheets], axis=1)
    size = float(np.sum(np.linalg.norm(x, axis=0) * np.linalg.norm(f, axis=0)))
    return float(np.abs(np.cross(x, f, axis=0).sum(axis=1)).max()) / size


def misplaced_moment(bench: Bench, options: Options, cells: float) -> float:
    """Moment of the first step's forces, flat sheets' contact alone, with places that many cells off both ways."""
    _set_off(bench)
    pair = bench.model.pairs[0]
    nodes = bench.x(int(pair["slave"])).size // 3
    place = bench.state.place[5 * int(pair["first"]) :][: 5 * nodes].reshape(5, nodes)
    place[0] += cells
    place[1] -= cells
    sim = bench.simulation(options.threads)
    moment = _moment(bench, sim)
    sim.close()
    return moment


def watch(bench: Bench, options: Options, steps: int, axes: tuple[list[int], list[int]]) -> History:
    """Run and watch components `axes` of P and of L."""
    _set_off(bench)
    mass = bench.model.mass
    size = scale = 0.0
    for k in range(bench.model.sheets.size):
        record = bench.model.sheets[k]
        n = int(record["rows"] * record["cols"])
        m = mass[int(record["node"]) :][:n]
        speed = np.linalg.norm(bench.v(k).reshape(3, -1), axis=0)
        size += float(np.sum(m * speed))
        scale += float(np.sum(m * speed * np.linalg.norm(bench.x(k).reshape(3, -1), axis=0)))
    first, sim = _momenta(bench), bench.simulation(options.threads)
    column = FRICTION if bench.model.tool_sheet < 0 else TOOL_FRICTION
    linear, angular, moment, least, heat = [], [], [], np.inf, bench.state.ledger[:, column].copy()
    for _ in range(steps):
        moment.append(_moment(bench, sim))
        least = min(least, float((bench.state.ledger[:, column] - heat).min()))
        heat = bench.state.ledger[:, column].copy()
        now = _momenta(bench)
        drift = [(a - b).sum(axis=0) for a, b in zip(now, first, strict=True)]
        linear.append(np.abs(drift[0][axes[0]]).max() / size)
        angular.append(np.abs(drift[1][axes[1]]).max() / scale)
    sim.close()
    exchanged = float(np.abs(now[0][0] - first[0][0]).max()) / size
    total = float(heat.sum())
    return History(np.array(linear), np.array(angular), np.array(moment), least / max(total, 1e-300), total, exchanged)


def solve(options: Options) -> Answer:
    """Drifts and least heat of every kind of contact."""
    steps = 300 if options.quick else 1000
    everything = ([0, 1, 2], [0, 1, 2])
    seen = {
        name: watch(two_sheets(options, below, above, 0.5), options, steps, everything)
        for name, (below, above) in PAIRS.items()
    }
    for name, make in FOLDS.items():
        seen[name] = watch(folded_sheet(options, make, 0.5, PRESSED), options, steps, everything)
    seen["tool without friction"] = watch(on_tool(options, 0.0), options, steps, ([0, 1], [2]))
    rubbed = watch(on_tool(options, 0.3), options, steps, everything)
    checks, curves = [], []
    table = {"step": np.arange(1.0, steps + 1)}
    for name, h in seen.items():
        checks.append(Check(f"linear momentum lost, {name}", "-", 0.0, float(h.linear.max()), BOUND, relative=False))
        bound = None if "ply" in name else BOUND
        checks.append(Check(f"angular momentum lost, {name}", "-", 0.0, float(h.angular.max()), bound, relative=False))
        every = np.s_[:: max(1, steps // 60)]
        if "tool" not in name:
            curves.append(Curve(name, table["step"][every], np.log10(np.maximum(h.moment, 1e-18))[every], True))
        key = name.replace(" ", "_")
        table |= {f"{key}_linear": h.linear, f"{key}_angular": h.angular, f"{key}_moment": h.moment}
    for name in (*PAIRS, *FOLDS):
        checks.append(
            Check(f"moment of forces, {name}", "-", 0.0, float(seen[name].moment.max()), BOUND, relative=False)
        )
    for name, (below, above) in PAIRS.items():
        for cells in MISPLACED:
            off = misplaced_moment(two_sheets(options, below, above, 0.5), options, cells)
            checks.append(Check(f"moment {cells:g} cells off, {name}", "-", 0.0, off, BOUND, relative=False))
    for name, h in (*((name, seen[name]) for name in (*PAIRS, *FOLDS)), ("tool", rubbed)):
        checks.append(
            Check(f"least heat over all heat, {name}", "-", 0.0, min(h.least_heat, 0.0), 1e-12, relative=False)
        )
    notes = [
        f"{name}: {h.exchanged:.2g} of sum m |v| changed hands, {h.heat:.3g} N mm of friction heat"
        for name, h in (*seen.items(), ("tool with friction", rubbed))
    ]
    curves.append(Curve("bound", np.array([0.0, steps]), np.log10(np.full(2, BOUND))))
    return Answer(tuple(checks), Figure("step", "log10 of the forces' moment", tuple(curves)), table, tuple(notes))


PROBLEM = Problem("momentum", "Momentum and heat of contact under any motion", "conservation laws", solve)
