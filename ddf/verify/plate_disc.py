"""A clamped circular plate under pressure: the bending of the diaphragm where its membrane has nothing to say.

Kirchhoff's plate of rigidity D and radius a, clamped at its edge, under the pressure p, bends to

    w = p a^4 / (64 D) (1 - r^2/a^2)^2                     (Timoshenko and Woinowsky-Krieger, 2nd ed., section 16)

for deflections small against its thickness; here w/t = 0.005, where the membrane takes about 1e-5 of the load. The
plate lies on a square grid and is continued beyond its edge as in `disc.py`.
"""

from __future__ import annotations

import numpy as np

from ddf.verify.bench import assemble
from ddf.verify.bench_sheets import FloatArray, ramped_load, rubber_sheet
from ddf.verify.disc import Edge, disc_lines
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem

BOUND = 1e-2
RADIUS = 20.0  # mm
SIZES = (2.0, 1.5, 1.0)  # mm
DEFLECTION = 0.005  # of the thickness
SPEED = 2.0  # of mass damping, in critical ones of the lowest mode
STEPS = 2  # between two looks at the edge


def bend(options: Options, element: float) -> tuple[float, FloatArray, FloatArray, float]:
    """Deflection of the middle, radii and deflections of all nodes [mm], and the known one of the middle."""
    line = disc_lines(RADIUS, element, 3)
    edge = Edge(line, RADIUS, clamped=True)
    sheet = rubber_sheet(options, (line, line), edge.beyond, bending=True)
    known = DEFLECTION * sheet.thickness
    pressure = 64.0 * sheet.rigidity * known / RADIUS**4
    lowest = 10.2 / RADIUS**2 * np.sqrt(sheet.rigidity / sheet.areal_mass)  # [1/s]
    end = 12.0 / lowest
    bench = assemble([sheet], ramped_load([0.0, 0.1 * end, end], [0.0, pressure, pressure], SPEED * lowest))
    sim, x = bench.simulation(options.threads), bench.x()
    while sim.time < end:
        edge.drive(x, bench.v(), sheet.start, STEPS * bench.model.dt)
        sim.advance(STEPS)
    sim.close()
    inside = ~edge.beyond
    middle = line.size // 2
    return float(x[2, middle, middle]), np.hypot(x[0], x[1])[inside], x[2][inside], known


def solve(options: Options) -> Answer:
    """Deflection of the middle and of the whole plate."""
    sizes = (options.element_mm,) if options.element_mm else (1.5,) if options.quick else SIZES
    notes = []
    for size in sizes:
        middle, r, w, known = bend(options, size)
        notes.append(f"{size:g} mm: deflection of the middle {100 * (middle / known - 1):+.3f} %")
    shape = known * (1.0 - (r / RADIUS) ** 2) ** 2
    worst = float(np.abs(w - shape).max() / known)
    checks = (
        Check("deflection of the middle", "mm", known, middle, BOUND),
        Check("largest error of the shape over the middle's", "-", 0.0, worst, BOUND, relative=False),
    )
    if len(sizes) > 1:
        notes.append("no order is given: the error changes sign on the way")
    at = np.linspace(0.0, RADIUS, 60)
    line = 1e3 * known * (1.0 - (at / RADIUS) ** 2) ** 2
    curves = (Curve("known", at, line), Curve(f"solver, {size:g} mm", r, 1e3 * w, True))
    table = {"r_mm": r, "known_deflection_mm": shape, "deflection_mm": w}
    return Answer(checks, Figure("r [mm]", "deflection [um]", curves), table, tuple(notes))


PROBLEM = Problem(
    "plate-disc", "Clamped circular plate under pressure",
    "Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells", solve,
)  # fmt: skip
