"""Solids of the tools, made by gmsh's OpenCASCADE kernel in the tool frame.

Tool frame: the platform is the plane z = 0, the apex or axis is on x = y = 0. A tool stands on the platform,
so every solid is continued below z = 0 (by `depth` mm) and its base edges play no role.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ddf.errors import MeshError

BASE_ANGLES_DEG = (90.0, 210.0, 330.0)
"""Polar angles of the base corners of the tetrahedra: mirror symmetric in x."""

RADIUS_OVER_HEIGHT = {"cube-corner-tetrahedron": 2.0**0.5, "regular-tetrahedron": 0.5**0.5}
"""Circumradius of the base at z = 0 over the height of the sharp tetrahedron."""


@dataclass(frozen=True)
class Dimensions:
    """Measures of a tool [mm]; each shape uses those that it needs."""

    height_mm: float = 82.0
    """Height above the platform of the tetrahedra (sharp apex), the box and the cylinder."""
    radius_mm: float = 60.0
    """Radius of the hemisphere and the cylinder."""
    length_mm: float = 120.0
    """Size of the box along x."""
    width_mm: float = 80.0
    """Size of the box along y."""
    fillet_mm: float = 5.0
    """Radius of all edges above the platform; 0 is sharp. The hemisphere has none."""

    @property
    def depth_mm(self) -> float:
        """How far the solid goes on below the platform [mm]."""
        return self.fillet_mm + 12.0


def _fillet(gmsh: Any, volume: int, edges: list[int], radius: float) -> None:
    """Round edges of a volume; MeshError says the largest radius that works of a few smaller ones."""
    if radius == 0.0:
        gmsh.model.occ.synchronize()
        return
    for factor in (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1):
        try:
            gmsh.model.occ.fillet([volume], edges, [radius * factor])
            gmsh.model.occ.synchronize()
        except Exception:
            continue
        if factor == 1.0:
            return
        raise MeshError(f"a fillet of {radius:g} mm cannot be made", f"{radius * factor:.3g} mm works")
    raise MeshError(f"a fillet of {radius:g} mm cannot be made", "choose a much smaller fillet_mm, or 0")


def _tetrahedron(radius_over_height: float) -> Callable[[Any, Dimensions], None]:
    def build(gmsh: Any, size: Dimensions) -> None:
        """Three planes through (0, 0, h), cut at z = -depth; the edges from the apex rounded."""
        h, depth = size.height_mm, size.depth_mm
        occ = gmsh.model.occ
        apex = occ.addPoint(0.0, 0.0, h)
        radius = radius_over_height * (h + depth)
        angles = np.deg2rad(BASE_ANGLES_DEG)
        base = [occ.addPoint(radius * np.cos(a), radius * np.sin(a), -depth) for a in angles]
        ridges = [occ.addLine(apex, b) for b in base]
        rim = [occ.addLine(base[k], base[(k + 1) % 3]) for k in range(3)]
        loops = [occ.addCurveLoop([ridges[k], rim[k], -ridges[(k + 1) % 3]]) for k in range(3)]
        faces = [occ.addPlaneSurface([loop]) for loop in [*loops, occ.addCurveLoop(rim)]]
        volume = occ.addVolume([occ.addSurfaceLoop(faces)])
        occ.synchronize()
        _fillet(gmsh, volume, ridges, size.fillet_mm)

    return build


def _hemisphere(gmsh: Any, size: Dimensions) -> None:
    """Half sphere of `radius_mm` about the origin on a cylinder below: a profile turned about z."""
    r, depth, occ = size.radius_mm, size.depth_mm, gmsh.model.occ
    foot, axis, top = occ.addPoint(r, 0, -depth), occ.addPoint(0, 0, -depth), occ.addPoint(0, 0, r)
    side, centre = occ.addPoint(r, 0, 0), occ.addPoint(0, 0, 0)
    profile = [
        occ.addLine(axis, foot),
        occ.addLine(foot, side),
        occ.addCircleArc(side, centre, top),
        occ.addLine(top, axis),
    ]
    face = occ.addPlaneSurface([occ.addCurveLoop(profile)])
    occ.revolve([(2, face)], 0, 0, 0, 0, 0, 1, 2 * np.pi)
    occ.remove([(2, face)])
    occ.synchronize()


def _box(gmsh: Any, size: Dimensions) -> None:
    """Box of length x width x height; its four top edges and four upright ones rounded."""
    length, width, depth = size.length_mm, size.width_mm, size.depth_mm
    box = gmsh.model.occ.addBox(-length / 2, -width / 2, -depth, length, width, size.height_mm + depth)
    gmsh.model.occ.synchronize()
    _fillet(gmsh, box, _edges_off_base(gmsh, depth), size.fillet_mm)


def _cylinder(gmsh: Any, size: Dimensions) -> None:
    """Cylinder of `radius_mm` and `height_mm`; its top edge rounded."""
    depth = size.depth_mm
    body = gmsh.model.occ.addCylinder(0, 0, -depth, 0, 0, size.height_mm + depth, size.radius_mm)
    gmsh.model.occ.synchronize()
    rings = [edge for edge in _edges_off_base(gmsh, depth) if gmsh.model.getType(1, edge) == "Circle"]
    _fillet(gmsh, body, rings, size.fillet_mm)


def _edges_off_base(gmsh: Any, depth: float) -> list[int]:
    """Tags of the curves that do not lie in the plane z = -depth."""
    return [tag for dim, tag in gmsh.model.getEntities(1) if gmsh.model.getBoundingBox(dim, tag)[5] > -depth + 1e-3]


SOLIDS: dict[str, Callable[[Any, Dimensions], None]] = {
    "cube-corner-tetrahedron": _tetrahedron(RADIUS_OVER_HEIGHT["cube-corner-tetrahedron"]),
    "regular-tetrahedron": _tetrahedron(RADIUS_OVER_HEIGHT["regular-tetrahedron"]),
    "hemisphere": _hemisphere,
    "box": _box,
    "cylinder": _cylinder,
}
"""Function that adds the solid of a shape to the current gmsh model."""


def largest_fillet(shape: str, size: Dimensions) -> float:
    """The fillet radius [mm] that a shape cannot reach: its rounded faces would leave nothing above z = 0.

    For the tetrahedra the top is h - r (c - 1), with c = sqrt 3 (cube corner) or 3 (regular), which must stay
    above r; for box and cylinder half the plan's smaller measure, and the height.
    """
    if shape in RADIUS_OVER_HEIGHT:
        # 1/cos of a face normal's angle to the axis: the apex of the moved-in faces is c r lower.
        slope = RADIUS_OVER_HEIGHT[shape] / 2.0
        return size.height_mm / (1.0 + slope**-2) ** 0.5
    if shape == "box":
        return min(size.length_mm / 2, size.width_mm / 2, size.height_mm)
    if shape == "cylinder":
        return min(size.radius_mm, size.height_mm)
    return np.inf


def add_solid(gmsh: Any, shape: str, size: Dimensions) -> None:
    """Add the solid of `shape` to the current gmsh model; MeshError for impossible measures."""
    if shape not in SOLIDS:
        raise MeshError(f"no tool shape is called {shape!r}", f"shapes: {', '.join(SOLIDS)}, file")
    for name, value in vars(size).items():
        if not np.isfinite(value) or value < 0.0 or (value == 0.0 and name != "fillet_mm"):
            raise MeshError(f"tool: {name} is {value}", "it must be positive (fillet_mm may be 0)")
    limit = largest_fillet(shape, size)
    if size.fillet_mm >= limit:
        raise MeshError(
            f"a fillet of {size.fillet_mm:g} mm does not fit on the {shape}",
            f"it must be under {limit:.4g} mm",
        )
    SOLIDS[shape](gmsh, size)
