"""A clamped disc of diaphragm blown up by pressure: height and stretch of its pole.

The known answer solves the equations of `membrane.py`. The solver's disc lies on a square grid; the nodes beyond its
edge continue it as in `disc.py`, so that the clamp is a circle and not a staircase. Pressure is the follower load of
the run; it rises to each level and is held there under mass damping until the disc rests. Only levels on the rising
branch are used: beyond the largest pressure no state under given pressure is stable.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np

from ddf.elements.rubber import cell_metric
from ddf.verify.bench import assemble
from ddf.verify.bench_sheets import FloatArray, ramped_load, rubber_of, rubber_sheet
from ddf.verify.disc import Edge, disc_lines
from ddf.verify.membrane import Bulge, bulge
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem

BOUND = 1e-2
RADIUS, THICKNESS = 100.0, 1.5  # mm
STRETCHES = (1.05, 1.1, 1.2, 1.3, 1.5)
SIZES = (10.0, 7.0, 5.0)  # mm
RAMP, HOLD = 0.02, 0.06  # s
DAMPING = 400.0  # 1/s
STEPS = 2  # between two looks at the edge


@dataclass(frozen=True)
class Inflated:
    """What the solver made of a disc at each pressure."""

    height: FloatArray  # [mm]
    stretch: FloatArray  # at the pole
    r: FloatArray  # meridian of the last level [mm]
    z: FloatArray


def inflate(options: Options, element: float, pressures: list[float], radius: float = RADIUS) -> Inflated:
    """Blow up a disc of cells of `element` [mm] to each pressure [MPa] in turn."""
    line = disc_lines(radius, element, 2)
    edge = Edge(line, radius, clamped=False)
    sheet = rubber_sheet(options, (line, line), edge.beyond, thickness=THICKNESS)
    time, load = [0.0], [0.0]
    for p in pressures:
        time += [time[-1] + RAMP, time[-1] + RAMP + HOLD]
        load += [p, p]
    bench = assemble([sheet], ramped_load(time, load, DAMPING))
    sim, x, v = bench.simulation(options.threads), bench.x(), bench.v()
    middle, sizes, got = line.size // 2, np.diff(line), []
    for end in time[2::2]:
        while sim.time < end - 1e-9:
            edge.drive(x, v, sheet.start, STEPS * bench.model.dt)
            sim.advance(STEPS)
        metric = cell_metric(x, sizes, sizes)[0][middle - 1 : middle + 1, middle - 1 : middle + 1]
        got.append((x[2, middle, middle], np.sqrt(metric.mean())))
    sim.close()
    height, stretch = np.array(got).T
    inside = ~edge.beyond[:, middle]
    return Inflated(height, stretch, x[0, inside, middle].copy(), x[2, inside, middle].copy())


def _known(options: Options, stretches: tuple[float, ...]) -> list[Bulge]:
    """Known answers on the rising branch."""
    terms = rubber_of(options).abaqus_terms
    rising: list[Bulge] = []
    for stretch in stretches:
        state = bulge(terms, RADIUS, THICKNESS, stretch)
        if not rising or state.pressure > rising[-1].pressure:
            rising.append(state)
    return rising


def solve(options: Options) -> Answer:
    """Height and stretch of the pole at several pressures; the finest size is judged."""
    stretches = (1.1, 1.5) if options.quick else STRETCHES
    sizes = (options.element_mm,) if options.element_mm else (8.0,) if options.quick else SIZES
    known = _known(options, stretches)
    pressures = [state.pressure for state in known]
    solved = [inflate(options, size, pressures) for size in sizes]
    fine, kpa = solved[-1], 1e3 * np.array(pressures)
    checks = []
    for k, state in enumerate(known):
        checks.append(Check(f"pole height at {kpa[k]:.3f} kPa", "mm", state.height, float(fine.height[k]), BOUND))
        checks.append(Check(f"pole stretch at {kpa[k]:.3f} kPa", "-", stretches[k], float(fine.stretch[k]), BOUND))
    notes = [
        f"{size:g} mm: height {100 * (s.height[-1] / known[-1].height - 1):+.3f} %, stretch "
        f"{100 * (s.stretch[-1] / stretches[len(known) - 1] - 1):+.3f} % at {kpa[-1]:.2f} kPa"
        for size, s in zip(sizes, solved, strict=True)
    ]
    if len(sizes) > 1:
        off = [abs(s.height[-1] / known[-1].height - 1) for s in (solved[0], solved[-1])]
        notes.append(f"observed order of the height: {log(off[0] / off[1]) / log(sizes[0] / sizes[-1]):.2f}")
    last = known[-1]
    r, z = np.concatenate([-last.r[::-1], last.r]), np.concatenate([last.z[::-1], last.z])
    curves = (Curve(f"known, {kpa[-1]:.2f} kPa", r, z), Curve(f"solver, {sizes[-1]:g} mm", fine.r, fine.z, True))
    figure = Figure("x [mm]", "z [mm]", curves, equal_axes=True)
    table = {
        "pressure_kPa": kpa, "known_height_mm": np.array([s.height for s in known]), "height_mm": fine.height,
        "known_stretch": np.array(stretches[: len(known)]), "stretch": fine.stretch,
    }  # fmt: skip
    return Answer(tuple(checks), figure, table, tuple(notes))


PROBLEM = Problem(
    "diaphragm-bulge", "Clamped disc of diaphragm under pressure",
    "axisymmetric membrane equations (Adkins and Rivlin 1952), integrated", solve,
)  # fmt: skip
