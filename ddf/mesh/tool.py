"""The tool's surface: primitives with fillets, or a STEP or STL file, as a closed triangle mesh.

Tool frame: the platform is z = 0, the axis or apex is on x = y = 0 (a file keeps its own x and y).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ddf.errors import MeshError
from ddf.mesh.gmsh_session import gmsh_session
from ddf.mesh.solids import SOLIDS, Dimensions, add_solid
from ddf.mesh.triangles import (
    TriangleMesh,
    check_watertight,
    compact,
    orient_outward,
    read_tool,
    write_tool,
)

__all__ = ["SHAPES", "UNITS", "TriangleMesh", "build_tool", "read_tool", "write_step", "write_tool"]

SHAPES = (*SOLIDS, "file")
"""Names that `build_tool` knows."""

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}
"""Units of a tool file, in mm."""

PLANAR_FACTOR = 4.0
"""Triangles on flat faces may be this much larger than `size_mm`: they are exact at any size."""


def build_tool(
    shape: str,
    *,
    height_mm: float = 82.0,
    radius_mm: float = 60.0,
    length_mm: float = 120.0,
    width_mm: float = 80.0,
    fillet_mm: float = 5.0,
    file: str | Path | None = None,
    unit: str = "mm",
    size_mm: float = 2.0,
    chord_mm: float = 0.02,
) -> TriangleMesh:
    """Closed surface of the tool with outward normals, continued below the platform z = 0.

    `shape` is one of SHAPES. cube-corner-tetrahedron and regular-tetrahedron: `height_mm` of the sharp solid,
    base corners at polar angles 90, 210, 330 deg; the fillet lowers the apex, see `top_mm`. hemisphere:
    `radius_mm`. box: `length_mm` (x), `width_mm` (y), `height_mm`. cylinder: `radius_mm`, `height_mm`. All
    edges above the platform get the radius `fillet_mm` (0: sharp; hemisphere: none to round). file: a STEP or
    STL `file` in the tool frame, its numbers times `unit`; a STEP file's own unit is first turned to mm by
    the reader. `size_mm` is the largest triangle on curved faces, `chord_mm` the largest distance of a
    triangle from a fillet or the hemisphere. Raises MeshError for impossible measures, a fillet that fails, a
    surface not closed.
    """
    if shape == "file":
        mesh = _from_file(file, unit, size_mm, chord_mm)
    else:
        size = Dimensions(height_mm, radius_mm, length_mm, width_mm, fillet_mm)
        with gmsh_session(f"tool {shape}") as gmsh:
            add_solid(gmsh, shape, size)
            mesh = _mesh_surface(gmsh, size_mm, chord_mm, f"the {shape}")
    if mesh.top_mm <= 0.0:
        raise MeshError("the tool is all below its platform z = 0", "check the file's origin and unit")
    return mesh


def write_step(shape: str, path: str | Path, **dimensions: float) -> None:
    """Write the solid of a primitive as a STEP file; `dimensions` are those of `Dimensions` [mm]."""
    with gmsh_session(f"tool {shape}") as gmsh:
        add_solid(gmsh, shape, Dimensions(**dimensions))
        gmsh.write(str(path))


def _from_file(file: str | Path | None, unit: str, size_mm: float, chord_mm: float) -> TriangleMesh:
    """The surface in a STEP or STL file, in mm; MeshError if it is missing, unknown or not closed."""
    if file is None:
        raise MeshError("a tool of shape 'file' needs the name of a file", "give a STEP or STL file")
    if unit not in UNITS:
        raise MeshError(f"the unit of a tool file cannot be {unit!r}", f"units: {', '.join(UNITS)}")
    path, scale = Path(file), UNITS[unit]
    if not path.is_file():
        raise MeshError(f"there is no tool file {path}")
    if path.suffix.lower() == ".stl":
        mesh = read_tool(path)
    elif path.suffix.lower() in {".step", ".stp"}:
        with gmsh_session(f"tool {path.name}") as gmsh:
            gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
            gmsh.model.occ.importShapes(str(path))
            gmsh.model.occ.synchronize()
            mesh = _mesh_surface(gmsh, size_mm / scale, chord_mm / scale, str(path))
    else:
        raise MeshError(f"{path.name} is not a STEP or STL file", "use .step, .stp or .stl")
    return TriangleMesh(mesh.points * scale, mesh.triangles)


def _mesh_surface(gmsh: Any, size: float, chord: float, what: str) -> TriangleMesh:
    """Triangulate all surfaces of the current model and return them as one closed mesh, normals outward."""
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    if not surfaces:
        raise MeshError(f"{what} holds no surfaces")
    _set_sizes(gmsh, surfaces, size, chord)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    index = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    index[tags.astype(np.int64)] = np.arange(tags.size)
    parts = [index[gmsh.model.mesh.getElementsByType(2, tag)[1].astype(np.int64)].reshape(-1, 3) for tag in surfaces]
    patch = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    points, triangles = coordinates.reshape(-1, 3), np.concatenate(parts)
    mesh = compact(points, triangles)
    if len(mesh.triangles) != len(triangles):
        raise MeshError(f"{what}: {len(triangles) - len(mesh.triangles)} triangles of its mesh are empty")
    mesh = orient_outward(mesh, patch)
    check_watertight(mesh, what)
    return mesh


def _set_sizes(gmsh: Any, surfaces: list[int], size: float, chord: float) -> None:
    """Mesh size of each surface: `size` on curved ones, PLANAR_FACTOR more on flat ones, less on fillets.

    An equilateral triangle of side l inscribed in a sphere of radius r lies s = l^2/(6 r) under it. Sides
    come out up to a fifth longer than asked, so l = sqrt(4 r s) for s = chord, r the smallest on the surface.
    """
    mesh = gmsh.model.mesh
    for option in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", PLANAR_FACTOR * size)
    fields = []
    for tag in surfaces:
        radius = _smallest_radius(gmsh, tag)
        here = min(size, (4.0 * radius * chord) ** 0.5) if np.isfinite(radius) else PLANAR_FACTOR * size
        fields.append(_constant_field(mesh, tag, here, PLANAR_FACTOR * size))
    least = mesh.field.add("Min")
    mesh.field.setNumbers(least, "FieldsList", fields)
    mesh.field.setAsBackgroundMesh(least)


def _constant_field(mesh: Any, surface: int, inside: float, outside: float) -> int:
    """A size field: `inside` on the surface and its boundary, `outside` elsewhere."""
    field = mesh.field.add("Constant")
    mesh.field.setNumbers(field, "SurfacesList", [surface])
    mesh.field.setNumber(field, "VIn", inside)
    mesh.field.setNumber(field, "VOut", outside)
    mesh.field.setNumber(field, "IncludeBoundary", 1)
    return field


def _smallest_radius(gmsh: Any, surface: int) -> float:
    """Smallest radius of curvature [mm] over 5 x 5 places of a surface; infinite if it is flat."""
    if gmsh.model.getType(2, surface) == "Plane":
        return np.inf
    low, high = gmsh.model.getParametrizationBounds(2, surface)
    u, v = (np.linspace(a, b, 7)[1:-1] for a, b in zip(low, high, strict=True))
    places = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1)
    curvature = np.abs(gmsh.model.getCurvature(2, surface, places)).max()
    return 1.0 / curvature if curvature > 1e-9 else np.inf
