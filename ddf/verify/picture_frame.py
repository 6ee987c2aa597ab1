"""A picture frame to 60 degrees: the normalised shear force out of the frame against the law that was entered.

A frame of side L with pinned corners turns its arms so that the fibres make 90 deg - g = 2 phi with each other: with
b = g/2, e1 = (cos b, sin b), e2 = (sin b, cos b) a point (X, Y) goes to X e1 + Y e2. Across the corners the frame
measures L sqrt 2 (cos b + sin b), so the crosshead moves by

    d = L (2 cos(45 deg - b) - sqrt 2),   dd/dg = L sin(phi)

The force F on the crosshead does the work of all forces f on the frame's nodes, F dd = -sum f . dx, and

    N_s = F / (2 cos(phi) L)

(J. Cao et al., Composites Part A 39 (2008) 1037). The frame turns slowly and halts every 5 degrees until
the ply is at rest; f are the forces that the step exerts on the held nodes.
"""

from __future__ import annotations

import numpy as np

from ddf.case.schema import WovenMaterial
from ddf.elements.shear import shear_sine
from ddf.simulate import Simulation
from ddf.verify.probe import acting_forces
from ddf.verify.problem import (
    LATTICE,
    SHELL_MEMBRANE,
    Answer,
    Check,
    Curve,
    Figure,
    FloatArray,
    Options,
    Problem,
    worst,
)
from ddf.verify.scenes import damped, entered_law, fabric_of, held, lead, ply_scene, positions, settle

SIDE_MM = 100.0
ELEMENT_MM = 10.0
QUICK_ELEMENT_MM = 20.0
ANGLES_DEG = np.arange(5.0, 60.1, 5.0)
LEADS = 10  # straight pieces of a node's way every 5 degrees
SPEED_MM_S = 300.0
DAMPING_1_S = 300.0
NOISE = 1e-3  # in-plane, of an element: something for an instability to grow from
BOUND = 0.005
EVEN_BOUND_DEG = 0.05
UNSTABLE = "N_s cos g falls: unstable"


def _turned(start: FloatArray, angle: float) -> tuple[FloatArray, FloatArray]:
    """Positions at a shear angle [rad] and their derivatives by it, for points (3, k) of the square."""
    b = 0.5 * angle
    first, second = np.array([np.cos(b), np.sin(b), 0.0]), np.array([np.sin(b), np.cos(b), 0.0])
    first_rate, second_rate = 0.5 * np.array([-np.sin(b), np.cos(b), 0.0]), 0.5 * np.array([np.cos(b), -np.sin(b), 0.0])
    return np.outer(first, start[0]) + np.outer(second, start[1]), np.outer(first_rate, start[0]) + np.outer(
        second_rate, start[1]
    )


def shear_frame(fabric: WovenMaterial, element_mm: float, formulation: str = LATTICE) -> tuple[FloatArray, FloatArray]:
    """N_s [N/mm] out of the frame at ANGLES_DEG, and how far any cell is off the frame's angle there [deg]."""
    scene = damped(ply_scene(fabric, (SIDE_MM, SIDE_MM), element_mm, formulation=formulation), DAMPING_1_S)
    start = positions(scene).copy()
    edge = np.ones(start.shape[1:], bool)
    edge[1:-1, 1:-1] = False
    scene = held(scene, edge)
    noise = np.random.default_rng(1).uniform(-NOISE, NOISE, start[:2, ~edge].shape)
    positions(scene)[:2, ~edge] += element_mm * noise
    sim, forces, uneven = Simulation(scene), [], []
    angle = 0.0
    for end in np.deg2rad(ANGLES_DEG):
        for step in np.linspace(angle, end, LEADS + 1)[1:]:
            target = _turned(start[:, edge], step)[0]
            way = float(np.abs(target - positions(scene)[:, edge]).max())
            lead(sim, edge, target, 1 + round(way / SPEED_MM_S / scene.model.dt))
        angle = end
        sim.state.v[:] = 0.0
        settle(sim, 1e-3, 5.0)
        phi = 0.25 * np.pi - 0.5 * angle
        work = -np.sum(acting_forces(scene)[:, edge] * _turned(start[:, edge], angle)[1])
        forces.append(work / (SIDE_MM * np.sin(phi)) / (2.0 * np.cos(phi) * SIDE_MM))
        uneven.append(np.rad2deg(np.abs(np.arcsin(shear_sine(positions(scene))) - angle).max()))
    return np.array(forces), np.array(uneven)


def solve(options: Options) -> Answer:
    """Both shear laws of the fabric."""
    element = options.element_mm or (QUICK_ELEMENT_MM if options.quick else ELEMENT_MM)
    at = [f"{angle:g} deg" for angle in ANGLES_DEG]
    checks, curves, table = [], [], {"shear_angle_deg": ANGLES_DEG}
    notes = []
    for law in ("published", "monotone"):
        fabric = fabric_of(options).model_copy(update={"shear_law": law})
        angle, entered = entered_law(fabric)
        expected = np.interp(np.deg2rad(ANGLES_DEG), angle, entered)
        got, uneven = shear_frame(fabric, element, options.formulation)
        checks.append(worst(f"N_s, {law} law", "N/mm", at, expected, got, BOUND))
        off = float(uneven.max())
        checks.append(Check(f"cells off the frame's angle, {law} law", "deg", 0.0, off, EVEN_BOUND_DEG, relative=False))
        shown = (angle > np.deg2rad(1.0)) & (angle < np.deg2rad(61.0))
        degrees, force = np.rad2deg(angle[shown]), entered[shown]
        curves.append(Curve(f"entered, {law}", degrees, force))
        curves.append(Curve(f"ddf, {law}", ANGLES_DEG, got, points=True))
        falling = np.flatnonzero(np.diff(force * np.cos(angle[shown])) < 0.0)
        if falling.size:
            range_ = degrees[falling[[0, -1]]]
            curves.append(Curve(f"{UNSTABLE} ({law})", degrees[falling], force[falling]))
            notes.append(f"{law} law: N_s cos g falls from {range_[0]:.1f} to {range_[1]:.1f} deg: unstable there")
        table |= {f"entered_{law}_N_mm": expected, f"measured_{law}_N_mm": got, f"uneven_{law}_deg": uneven}
    shown_last = tuple(sorted(curves, key=lambda curve: curve.name.startswith(UNSTABLE)))
    figure = Figure("shear angle [deg]", "normalised shear force N_s [N/mm]", shown_last, log_y=True)
    return Answer(tuple(checks), figure, table, tuple(notes))


PROBLEM = Problem(
    "picture-frame",
    "Picture frame to 60 deg, both shear laws",
    "the entered law; Cao et al. 2008",
    solve,
    (LATTICE, SHELL_MEMBRANE),
)
