"""Zero-energy modes of a free flat ply, by the eigenvalues of its tangent stiffness.

Six are rigid. The fabric has no twisting stiffness and no curvature along its families for w = x y (x, y along them),
so that is a seventh. Any other, an hourglass of cells say, is a fault. On a lattice of n x m nodes deflections
without second differences along both families are w = (a + b x)(c + d y): four, three of them rigid; in the plane
the bars of both families and the shear of the cells leave only three rigid motions.
"""

from __future__ import annotations

import numpy as np

from ddf.scene import Scene
from ddf.verify.probe import Probe
from ddf.verify.problem import Answer, Check, Curve, Figure, FloatArray, Options, Problem
from ddf.verify.scenes import fabric_of, ply_scene, positions

CELLS = (7, 6)
ELEMENT_MM = 2.0
NOTHING = 1e-4
"""An eigenvalue is zero below this, in the plane over the shear's, out of it over the bending's."""
TWIST_BOUND = 1e-6
WAY_MM = {(0, 1): 1e-5, (2,): 1e-6}


def spectra(scene: Scene) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Eigenvalues [N/mm] in the plane and out of it, ascending; the latter's modes (nodes, k); (2, nodes) places."""
    x = positions(scene)
    exists = np.flatnonzero(scene.model.mass > 0.0)
    found = []
    for components, way in WAY_MM.items():
        matrix = Probe(scene).stiffness(x, components, way).toarray()
        size = matrix.shape[0] // len(components)
        kept = np.concatenate([exists + k * size for k in range(len(components))])
        found.append(np.linalg.eigh(matrix[np.ix_(kept, kept)]))
    places = x[:2].reshape(2, -1)[:, exists]
    return found[0][0], found[1][0], found[1][1], places


def solve(options: Options) -> Answer:
    """A whole rectangle along the fibres, and one cut at 45 degrees."""
    fabric, element = fabric_of(options, bending=True), options.element_mm or ELEMENT_MM
    checks, curves, table = [], [], {}
    for name, angle in (("0/90", 0.0), ("+-45", 45.0)):
        scene = ply_scene(fabric, (CELLS[0] * element, CELLS[1] * element), element, angle)
        plane, out, modes, places = spectra(scene)
        scale = (float(scene.model.shear_tables[0, 0, 1] / scene.model.shear_tables[0, -1, 0]), _bending(scene))
        zero = int(np.sum(np.abs(plane) < NOTHING * scale[0])), int(np.sum(np.abs(out) < NOTHING * scale[1]))
        c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
        u, v = c * places[0] + s * places[1], c * places[1] - s * places[0]
        twist = (u - u.mean()) * (v - v.mean())
        lost = twist - modes[:, : zero[1]] @ (modes[:, : zero[1]].T @ twist)
        share = float(np.linalg.norm(lost) / np.linalg.norm(twist))
        checks += [
            Check(f"zero modes in the plane, {name}", "1", 3, zero[0], 0.0),
            Check(f"zero modes out of the plane, {name}", "1", 4, zero[1], 0.0),
            Check(f"part of x y outside them, {name}", "1", 0.0, share, TWIST_BOUND, False),
        ]  # fmt: skip
        for part, values, size in (("in plane", plane, scale[0]), ("out of plane", out, scale[1])):
            number = np.arange(1, 13).astype(float)
            curves.append(Curve(f"{part}, {name}", number, np.maximum(np.abs(values[:12]) / size, 1e-18), points=True))
            table[f"{part.replace(' ', '_')}_{name}_N_mm"] = values[:12]
    line = np.array([1.0, 12.0])
    curves.insert(0, Curve("taken as zero below", line, np.full(2, NOTHING)))
    figure = Figure("eigenvalue", "over the shear's / the bending's stiffness", tuple(curves), log_y=True)
    return Answer(tuple(checks), figure, table)


def _bending(scene: Scene) -> float:
    """D / a^2 [N/mm]."""
    sheet = scene.model.sheets[0]
    return float(sheet["bend1"]) / float(sheet["a1"]) ** 2


PROBLEM = Problem("zero-energy-modes", "Zero-energy modes of a free ply", "six rigid motions and the twist x y", solve)
