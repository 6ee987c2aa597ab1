"""Patch tests of a ply: even stretch and shear, and even curvature, must be states without force inside.

Even deformation x = F X: inner nodes feel no force, and a ply whose edge is held there and whose inside was disturbed
comes to rest at F X.

Even curvature along a family: nodes on a circular cylinder of radius R, chords of one length l. Curvature is measured
in reference lengths, c/a^2 with c the second difference, so stretching a bent polygon bends it more and its
energy D/2 (l/(a R))^2 per area pulls on the fibres with D/R^2 per width. Inner forces vanish at the one
length l whose fibres push back by as much, T = -D/R^2 (a strain of 1e-8). That length is found, and all inner
nodes more than two from the edge must then be free of force. The energy is D A / (2 R^2), A the area of the bending
triples; errors are of the order (a/R)^2.
"""

from __future__ import annotations

import numpy as np

from ddf.model import sheet_scalars
from ddf.monitors.energy import sheet_strain
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.probe import Probe
from ddf.verify.problem import Answer, Check, Curve, Figure, FloatArray, Options, Problem
from ddf.verify.scenes import damped, fabric_of, held, ply_scene, positions, settle

CELLS = 10
ELEMENT_MM = 3.0
STRETCH = (1.004, 1.002)
SHEAR_DEG = 20.0
BEND = 0.1  # angle between the bars of a rolled ply
FORCE_BOUND = 1e-9
ROLL_BOUND = 1e-6  # bending forces are 1e-5 of what a fibre strain of 1e-9 makes: rounding shows
PLACE_BOUND = 1e-4
ENERGY_BOUND = 0.01


def _affine(x: FloatArray) -> FloatArray:
    """Stretched along both families and sheared."""
    b = 0.5 * np.deg2rad(SHEAR_DEG)
    first, second = np.array([np.cos(b), np.sin(b), 0.0]), np.array([np.sin(b), np.cos(b), 0.0])
    return np.multiply.outer(STRETCH[0] * first, x[0]) + np.multiply.outer(STRETCH[1] * second, x[1])


def _rolled(x: FloatArray, along: int, a: float, strain: float) -> FloatArray:
    """On a cylinder of radius a / BEND bent along an axis with nodes a apart, chords a (1 + strain) long."""
    rolled, radius = x.copy(), a / BEND
    angle = 2.0 * np.arcsin(0.5 * BEND * (1.0 + strain)) * x[along] / a
    rolled[along], rolled[2] = radius * np.sin(angle), radius * np.cos(angle)
    return rolled


def balanced_roll(probe: Probe, flat: FloatArray, along: int, a: float, guess: float) -> tuple[float, FloatArray]:
    """Strain of the chords at which the middle node of a rolled ply feels no force, by secants, and the shape."""
    middle = (2, flat.shape[1] // 2, flat.shape[2] // 2)
    strains = [0.0, guess]
    pushes = [probe.forces(_rolled(flat, along, a, strain))[middle] for strain in strains]
    for _ in range(3):
        if pushes[-1] == pushes[-2]:
            break
        slope = (pushes[-1] - pushes[-2]) / (strains[-1] - strains[-2])
        strains.append(float(strains[-1] - pushes[-1] / slope))
        pushes.append(probe.forces(_rolled(flat, along, a, strains[-1]))[middle])
    return strains[-1], _rolled(flat, along, a, strains[-1])


def _inside(force: FloatArray, margin: int) -> float:
    """Largest force on nodes `margin` or more from the edge over the largest of all."""
    inner = force[:, margin:-margin, margin:-margin]
    return float(np.abs(inner).max() / np.abs(force).max())


def _disturbed(scene: Scene, element_mm: float) -> float:
    """How far inner nodes come to rest from the even deformation [mm]."""
    x = positions(scene)
    even = _affine(x)
    x[:] = even
    x[:, 1:-1, 1:-1] += np.random.default_rng(5).uniform(-0.002, 0.002, x[:, 1:-1, 1:-1].shape) * element_mm
    edge = np.ones(x.shape[1:], bool)
    edge[1:-1, 1:-1] = False
    still = held(damped(scene, 2000.0), edge)
    settle(Simulation(still), 1e-3, 2.0)
    return float(np.abs(x - even).max())


def solve(options: Options) -> Answer:
    """All patches."""
    fabric, element = fabric_of(options, bending=True), options.element_mm or ELEMENT_MM
    scene = ply_scene(fabric, (CELLS * element, CELLS * element), element)
    flat, probe = positions(scene).copy(), Probe(scene)
    checks = [
        Check(
            "inner forces, even stretch and shear",
            "1",
            0.0,
            _inside(probe.forces(_affine(flat)), 1),
            FORCE_BOUND,
            False,
        )
    ]
    curves: list[Curve] = []
    table: dict[str, FloatArray] = {}
    for family in (1, 2):
        a, rigidity = float(scene.model.sheets[0][f"a{family}"]), fabric.bending_rigidity_Nmm[family - 1]
        stiff, push = fabric.membrane_modulus_N_mm[family - 1], -rigidity * (BEND / a) ** 2
        strain, rolled = balanced_roll(probe, flat, family - 1, a, push / stiff)
        force = probe.forces(rolled)
        checks.append(Check(f"inner forces, curvature {family}", "1", 0.0, _inside(force, 3), ROLL_BOUND, False))
        checks.append(Check(f"fibre force, curvature {family}", "N/mm", push, strain * stiff, ENERGY_BOUND))
        positions(scene)[:] = rolled
        area = float(sheet_scalars(scene.model, getattr(scene.model, f"triple{family}"), 0).sum())
        got = sheet_strain(scene.model, scene.state, 0)["bending"]
        checks.append(
            Check(f"energy, curvature {family}", "mJ", 0.5 * rigidity * area * (BEND / a) ** 2, got, ENERGY_BOUND)
        )
        row = np.moveaxis(np.abs(force).max(axis=0), family - 1, 0)
        size = row[:, row.shape[1] // 2] / row.max()
        at = np.arange(size.size).astype(float)
        curves.append(Curve(f"curvature {family}", at, np.maximum(size, 1e-20), points=True))
        table |= {"node": at, f"relative_force_{family}": size}
    positions(scene)[:] = flat
    place = _disturbed(scene, element) / element
    checks.append(Check("disturbed inside comes to rest off, elements", "1", 0.0, place, PLACE_BOUND, False))
    figure = Figure("node along the curvature", "force over the largest", tuple(curves), log_y=True)
    return Answer(tuple(checks), figure, table)


PROBLEM = Problem("patch-test", "Patch tests: even stretch, shear, curvature", "even states have no inner force", solve)
