"""The gridded distance field of a tool against its exact distance.

The field comes from the tool's triangle mesh; rounded tetrahedra, box, cylinder and hemisphere have closed forms
(`ddf.mesh.analytic`). Compared are random points from 0.5 mm inside to 4 mm outside the surface, where a diaphragm
touches. A point is at a face where the exact gradient is the same to 0.1 at 1.5 mm to all six sides of it, and at a
fillet otherwise.
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from ddf.mesh.analytic import primitive_distance
from ddf.mesh.distance import distance_field
from ddf.mesh.solids import Dimensions
from ddf.mesh.tool import build_tool
from ddf.verify.problem import Answer, Check, Curve, Figure, FloatArray, Options, Problem

FACE_BOUND, FILLET_BOUND = 0.05, 0.2  # mm
INSIDE, OUTSIDE = 0.5, 4.0  # mm
AROUND, FLAT = 1.5, 0.1  # mm, change of the unit gradient
POINTS = 60_000
SPACING = 1.0  # mm
TOOLS: dict[str, Dimensions] = {
    "cube-corner-tetrahedron": Dimensions(height_mm=30.0),
    "regular-tetrahedron": Dimensions(height_mm=30.0),
    "hemisphere": Dimensions(radius_mm=25.0),
    "box": Dimensions(height_mm=20.0, length_mm=45.0, width_mm=35.0),
    "cylinder": Dimensions(height_mm=20.0, radius_mm=25.0),
}
QUICK = ("cube-corner-tetrahedron", "cylinder")


def exact_gradient(shape: str, points: FloatArray, size: Dimensions, step: float = 1e-4) -> FloatArray:
    """Gradient (k, 3) of the exact distance."""
    parts = [primitive_distance(shape, points + s * a, size) for a in step * np.eye(3) for s in (1.0, -1.0)]
    return np.stack([(a - b) / (2.0 * step) for a, b in zip(parts[::2], parts[1::2], strict=True)], axis=1)


def on_faces(shape: str, points: FloatArray, size: Dimensions) -> np.ndarray:
    """(k,) bool: points at a face."""
    here = exact_gradient(shape, points, size)
    flat = np.ones(len(points), bool)
    for step in AROUND * np.concatenate([np.eye(3), -np.eye(3)]):
        flat &= np.linalg.norm(exact_gradient(shape, points + step, size) - here, axis=1) < FLAT
    return flat


def compare(shape: str, size: Dimensions, spacing: float) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Exact and gridded distances of points near the surface [mm], and which are at a face."""
    field = distance_field(build_tool(shape, **asdict(size)), spacing)
    high = field.origin + field.spacing * (np.array(field.values.shape[:3]) - 1)
    low = np.array([field.origin[0], field.origin[1], 0.0])
    points = low + (high - low) * np.random.default_rng(0).random((POINTS, 3)) * (1.0 - 1e-9)
    exact = primitive_distance(shape, points, size)
    points = points[(exact > -INSIDE) & (exact < OUTSIDE)]
    exact = primitive_distance(shape, points, size)
    return exact, field.distance(points), on_faces(shape, points, size)


def solve(options: Options) -> Answer:
    """Largest error at faces and at fillets of every tool."""
    checks, curves, rows = [], [], []
    for number, shape in enumerate(QUICK if options.quick else TOOLS):
        exact, got, face = compare(shape, TOOLS[shape], options.element_mm or SPACING)
        error = np.abs(got - exact)
        checks.append(
            Check(f"error at faces, {shape}", "mm", 0.0, float(error[face].max()), FACE_BOUND, relative=False)
        )
        if not face.all():
            worst = float(error[~face].max())
            checks.append(Check(f"error at fillets, {shape}", "mm", 0.0, worst, FILLET_BOUND, relative=False))
        some = np.argsort(-error)[:80]
        curves.append(Curve(shape, exact[some], (got - exact)[some], True))
        rows += [(number, e, g, f) for e, g, f in zip(exact[some], got[some], face[some], strict=True)]
    line = np.array([-INSIDE, OUTSIDE])
    curves.append(Curve("known", line, np.zeros(2)))
    curves.append(Curve("bound at faces", line, np.full(2, FACE_BOUND)))
    names = ("tool", "exact_mm", "gridded_mm", "at_face")
    table = dict(zip(names, np.array(rows, dtype=float).T, strict=True))
    figure = Figure("exact distance [mm], the 80 worst points of each tool", "error of the field [mm]", tuple(curves))
    return Answer(tuple(checks), figure, table)


PROBLEM = Problem("tool-distance", "Distance field of the tool", "closed forms of rounded solids", solve)
