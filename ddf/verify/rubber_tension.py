"""The diaphragm in uniaxial, planar and equibiaxial tension.

Incompressible Ogden rubber in plane stress, principal stretches l1, l2, l3 = 1/(l1 l2), has the Biot stress (force
per reference area)  P1 = sum 2 mu/alpha (l1^(alpha-1) - l3^alpha / l1).  In uniaxial tension l2 = l3 = l^(-1/2), in
planar tension l2 = 1, in equibiaxial l2 = l (Ogden 1972, doi 10.1098/rspa.1972.0026; Treloar, The Physics of Rubber
Elasticity, ch. 4).

Uniaxial: a strip with free long edges between two grips, the force of the grip against the stretch measured in the
middle, 2.5 widths from either grip. Planar and equibiaxial: a sheet on an uneven grid whose edge nodes go with the
stretch; its inner nodes start where the last stretch left them and must find the same stretch, and the force on an
edge is that of the holder.
"""

from __future__ import annotations

import numpy as np

from ddf.elements.rubber import cell_metric
from ddf.materials.ogden import biot_stress
from ddf.verify.bench import Bench, assemble, come_to_rest, drive
from ddf.verify.bench_sheets import (
    FloatArray,
    Sheet,
    constant_load,
    edges,
    even_line,
    flat_start,
    rubber_of,
    rubber_sheet,
)
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem

BOUND = 1e-3
DAMPING = 1500.0  # 1/s
SPEED = 0.02  # mm/s at which a sheet counts as at rest
STRETCHES = (1.05, 1.1, 1.3, 1.5, 2.0)
MODES = ("uniaxial", "planar", "equibiaxial")
STRIP = (50.0, 10.0)  # mm


def _strip(options: Options) -> Sheet:
    element = options.element_mm or 2.5
    lines = (even_line(STRIP[0], element), even_line(STRIP[1], element))
    return rubber_sheet(options, lines, edges(lines, "left", "right"))


def _square(options: Options) -> Sheet:
    lines = (np.array([0.0, 2.0, 5.0, 9.0, 12.0, 14.5, 20.0]), np.array([0.0, 3.0, 5.0, 9.0, 13.0, 16.0, 20.0]))
    return rubber_sheet(options, lines, edges(lines, "left", "right", "front", "back"))


def _affine(sheet: Sheet, stretch: float, mode: str) -> FloatArray:
    target = flat_start(sheet.lines)
    target[0] *= stretch
    if mode == "equibiaxial":
        target[1] *= stretch
    return target


def _edge_force(bench: Bench) -> float:
    """Force of the holder on the last line of nodes along x [N]."""
    return float(-bench.f()[0, -1].sum())


def _middle_stretch(bench: Bench, sheet: Sheet) -> float:
    """Stretch along x in the middle column of cells, at mid-width."""
    dx, dy = (np.diff(line) for line in sheet.lines)
    c11 = cell_metric(bench.x(), dx, dy)[0]
    n, m = c11.shape
    return float(np.sqrt(c11[(n - 1) // 2 : n // 2 + 1, (m - 1) // 2 : m // 2 + 1]).mean())


def pull(options: Options, mode: str, stretches: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    """Stretches measured in the middle, and Biot stresses [MPa] of the edge, at the grips' stretches."""
    sheet = _strip(options) if mode == "uniaxial" else _square(options)
    bench = assemble([sheet], constant_load(damping=DAMPING))
    sim = bench.simulation(options.threads)
    section = sheet.thickness * float(np.ptp(sheet.lines[1]))
    got = []
    for stretch in stretches:
        drive(bench, sim, 0, _affine(sheet, stretch, mode), 0.01)
        come_to_rest(bench, sim, SPEED, 0.2)
        got.append((_middle_stretch(bench, sheet), _edge_force(bench) / section))
    sim.close()
    measured, stress = np.array(got).T
    return measured, stress


def solve(options: Options) -> Answer:
    """Stress against stretch in the three modes."""
    stretches = (1.1, 2.0) if options.quick else STRETCHES
    line = np.linspace(1.0, 2.05, 60)
    terms = rubber_of(options).abaqus_terms
    checks, curves = [], []
    table: dict[str, FloatArray] = {}
    for mode in MODES:
        measured, stress = pull(options, mode, stretches)
        known = biot_stress(terms, measured, mode)
        checks += [
            Check(f"{mode} stress at stretch {a:.4g}", "kPa", 1e3 * float(k), 1e3 * float(s), BOUND)
            for a, k, s in zip(measured, known, stress, strict=True)
        ]
        curves.append(Curve(mode, line, 1e3 * biot_stress(terms, line, mode)))
        curves.append(Curve(f"{mode}, solver", measured, 1e3 * stress, True))
        table |= {f"{mode}_stretch": measured, f"{mode}_stress_kPa": 1e3 * stress, f"{mode}_known_kPa": 1e3 * known}
    return Answer(tuple(checks), Figure("stretch", "Biot stress [kPa]", tuple(curves)), table)


PROBLEM = Problem(
    "diaphragm-tension", "Diaphragm in uniaxial, planar and equibiaxial tension",
    "closed form of Ogden's energy in plane stress", solve,
)  # fmt: skip
