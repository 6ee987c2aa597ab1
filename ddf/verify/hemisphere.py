"""A ply pressed on a ball without friction: the pin-jointed net.

A net of inextensible, crossing yarns on a sphere of radius R, with two great circles at right angles as generators
and arc coordinates u, v along the yarns in units of R, has a shear angle g of z = u v alone:

    z g'' + g' = cos g,   g(0) = 0,   g ~ z - z^3/18                    (Chebyshev's net; Mack and Taylor 1956)

A fabric of stiff fibres and little shear stiffness tends to it. Here a square ply lies on the ball and a diaphragm,
turned by 45 degrees to it, is drawn over both by its frame until the ply lies on (a corner still a few mm off, which
is why the comparison ends at u v = 0.8); there is no friction anywhere.

A net on a sphere is whatever its two generators are, and without friction only the symmetry of the load keeps them
great circles. The remaining difference is that of fabric and net: chords of the elements for arcs, shear stiffness,
and the corners' lift.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from ddf.elements.shear import shear_sine
from ddf.verify.bench import CHUNK, Bench, assemble, drive
from ddf.verify.bench_sheets import (
    FloatArray,
    Sheet,
    ToolContact,
    Touch,
    constant_load,
    edges,
    fabric_sheet,
    rubber_sheet,
)
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.tool_fields import gridded, sphere

BOUND = 2.0  # deg
LARGEST = 0.8  # u v up to which the ply is judged
RADIUS, HALF = 50.0, 52.5  # of the ball and half the ply's side [mm]
FRAME, DROP, RUBBER = 144.0, 90.0, 6.0  # the diaphragm's side, how far it is drawn, its element [mm]
ELEMENT, FINE = 5.0, 3.5  # of the ply [mm]
AXIS = 200.0  # height of the ball's centre above the platform [mm]
DRAW, REST = 0.15, 0.02  # s
DAMPING = 300.0  # 1/s
BETWEEN, ON_BALL = 0.5, 5.0  # contact stiffness of ply and diaphragm, ply and ball [N/mm3]


def net_shear(z: FloatArray) -> FloatArray:
    """Shear angle [rad] of the net at z = u v; odd in z. Started from the series at a small z."""
    size = np.abs(np.asarray(z, dtype=float))
    small = 1e-3
    last = max(float(size.max(initial=0.0)), 2.0 * small)
    curve = solve_ivp(
        lambda s, y: [y[1], (np.cos(y[0]) - y[1]) / s], (small, last),
        [small - small**3 / 18.0, 1.0 - small**2 / 6.0], dense_output=True, rtol=1e-10, atol=1e-12,
    )  # fmt: skip
    flat = size.ravel()
    g = np.where(flat < small, flat - flat**3 / 18.0, curve.sol(np.maximum(flat, small))[0])
    return np.sign(z) * g.reshape(size.shape)


def _scene(options: Options, element: float) -> tuple[Bench, Sheet]:
    """Ply (sheet 0, along x and y) on the ball, diaphragm (sheet 1, turned) over it."""
    count = 2 * round(HALF / element)
    line = np.linspace(-0.5, 0.5, count + 1) * count * element
    ply = fabric_sheet(options, (line, line))
    ply.start[2] = RADIUS + 0.5 * ply.thickness
    around = np.linspace(-0.5, 0.5, round(FRAME / RUBBER) + 1) * FRAME
    frame = edges((around, around), "left", "right", "front", "back")
    rubber = rubber_sheet(options, (around, around), frame, bending=True)
    x, y, _ = rubber.start
    z = np.full_like(x, RADIUS + ply.thickness + 0.51 * rubber.thickness)
    rubber = replace(rubber, start=np.array([(x - y) / np.sqrt(2.0), (x + y) / np.sqrt(2.0), z]))
    reach = RADIUS + 8.0
    field = gridded(sphere(RADIUS, AXIS), (-reach, -reach, AXIS - RADIUS), (reach, reach, AXIS + reach), 1.0)
    bench = assemble(
        [ply, rubber], constant_load(damping=DAMPING), [Touch(0, 1, -1.0, 0.0, BETWEEN)],
        ToolContact(field, 0.0, -AXIS, ON_BALL),
    )  # fmt: skip
    return bench, ply


def press(options: Options, element: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places u v, shear angle [deg] and height above the ball [mm] of every cell of the pressed ply."""
    bench, ply = _scene(options, element)
    sim = bench.simulation(options.threads)
    target = bench.x(1).copy()
    target[2] -= DROP
    drive(bench, sim, 1, target, DRAW)
    while sim.time < DRAW + REST:
        sim.advance(CHUNK)
    sim.close()
    x = bench.x(0)
    u, v = (0.5 * (line[1:] + line[:-1]) / RADIUS for line in ply.lines)
    shear = np.rad2deg(np.arcsin(np.clip(shear_sine(x), -1.0, 1.0)))
    middle = 0.25 * (x[:, 1:, 1:] + x[:, 1:, :-1] + x[:, :-1, 1:] + x[:, :-1, :-1])
    lift = np.linalg.norm(middle, axis=0) - RADIUS - 0.5 * ply.thickness
    return np.outer(u, v), shear, lift


def solve(options: Options) -> Answer:
    """Shear angles of the ply against those of the net."""
    sizes = (options.element_mm,) if options.element_mm else (ELEMENT,) if options.quick else (ELEMENT, FINE)
    notes = []
    for size in sizes:
        z, shear, lift = press(options, size)
        known = np.rad2deg(net_shear(z))
        error = np.abs(shear - known)
        inside = np.abs(z) <= LARGEST
        notes.append(
            f"{size:g} mm: shear angle off by {error[inside].max():.2f} deg at most, "
            f"{np.sqrt(np.mean(error[inside] ** 2)):.2f} deg rms, {error.max():.2f} deg at the corners; "
            f"ply {lift[inside].max():.2f} mm off the ball at most, {lift.max():.2f} mm at the corners"
        )
    checks = [
        Check(
            f"shear angle, largest error, u v {low:g} to {high:g}", "deg", 0.0, float(error[band].max()), BOUND, False
        )
        for low, high in ((0.0, 0.4), (0.4, LARGEST))
        if (band := (np.abs(z) >= low) & (np.abs(z) <= high)).any()
    ]
    line = np.linspace(0.0, float(np.abs(z).max()), 100)
    quarter = (z > 0.0) & (np.arange(z.shape[0])[:, None] >= z.shape[0] // 2)
    curves = (
        Curve("net", line, np.rad2deg(net_shear(line))),
        Curve("ply, every cell", z[quarter], shear[quarter], True),
    )
    table = {"uv": z.ravel(), "shear_deg": shear.ravel(), "net_deg": known.ravel(), "lift_mm": lift.ravel()}
    return Answer(tuple(checks), Figure("u v / R2", "shear angle [deg]", curves), table, tuple(notes))


PROBLEM = Problem(
    "hemisphere", "Ply pressed on a ball without friction", "pin-jointed net (Mack and Taylor 1956), integrated", solve
)
