from pathlib import Path

import numpy as np
import pytest

from ddf.errors import MeshError
from ddf.mesh.analytic import primitive_distance
from ddf.mesh.solids import SOLIDS, Dimensions
from ddf.mesh.tool import build_tool, read_tool, write_tool
from ddf.mesh.triangles import TriangleMesh, check_watertight

MESHES = Path(__file__).parents[2] / "meshes"
HEIGHT = {"cube-corner-tetrahedron": 82.0, "regular-tetrahedron": 82.0, "hemisphere": 1.0}


def small_cube(side=10.0):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return TriangleMesh(side * (corners - [0.5, 0.5, 0.0]), np.array(triangles))


@pytest.mark.parametrize("shape", SOLIDS)
@pytest.mark.parametrize("fillet", [0.0, 3.0])
def test_vertices_lie_on_the_primitive(shape, fillet):
    size = Dimensions(height_mm=HEIGHT.get(shape, 40.0), fillet_mm=fillet)
    mesh = build_tool(shape, height_mm=size.height_mm, fillet_mm=fillet)
    above = mesh.points[mesh.points[:, 2] > -size.depth_mm + 1e-6]
    assert np.abs(primitive_distance(shape, above, size)).max() < 1e-5
    centres = mesh.points[mesh.triangles].mean(axis=1)
    centres = centres[centres[:, 2] > -size.depth_mm + 1e-6]
    assert np.abs(primitive_distance(shape, centres, size)).max() < 0.02
    assert mesh.points[:, 2].min() == pytest.approx(-size.depth_mm)
    assert mesh.volume_mm3 > 0.0


@pytest.mark.parametrize(
    ("shape", "lowered"), [("cube-corner-tetrahedron", 3**0.5 - 1.0), ("regular-tetrahedron", 2.0)]
)
def test_fillet_lowers_the_apex(shape, lowered):
    mesh = build_tool(shape, height_mm=50.0, fillet_mm=4.0)
    assert mesh.top_mm == pytest.approx(50.0 - 4.0 * lowered, abs=0.03)


def test_cube_corner_faces_are_mutually_perpendicular():
    mesh = build_tool("cube-corner-tetrahedron", fillet_mm=0.0)
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    faces = np.unique(np.round(normals[normals[:, 2] > -0.5], 6), axis=0)
    assert len(faces) == 3
    np.testing.assert_allclose(faces @ faces.T, np.eye(3), atol=1e-5)


def test_sharp_volumes():
    h, depth = 82.0, 12.0
    for shape, ratio in (("cube-corner-tetrahedron", 2**0.5), ("regular-tetrahedron", 0.5**0.5)):
        base = 0.75 * 3**0.5 * (ratio * (h + depth)) ** 2
        assert build_tool(shape, fillet_mm=0.0).volume_mm3 == pytest.approx(base * (h + depth) / 3, rel=1e-9)


@pytest.mark.parametrize("shape", SOLIDS)
def test_shipped_step_agrees_with_the_primitive(shape):
    mesh = build_tool("file", file=MESHES / f"{shape}.step")
    size = Dimensions(height_mm=HEIGHT.get(shape, 40.0))
    above = mesh.points[mesh.points[:, 2] > -size.depth_mm + 1e-3]
    assert np.abs(primitive_distance(shape, above, size)).max() < 1e-4
    assert (MESHES / f"{shape}.step").stat().st_size < 300_000


@pytest.mark.parametrize(("unit", "scale"), [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("inch", 25.4)])
def test_units_of_a_file(tmp_path, unit, scale):
    write_tool(small_cube(10.0 / scale), tmp_path / "cube.stl")
    mesh = build_tool("file", file=tmp_path / "cube.stl", unit=unit)
    assert mesh.volume_mm3 == pytest.approx(1000.0, rel=1e-5)
    assert len(mesh.points) == 8


def test_unit_of_a_step_file():
    mesh = build_tool("file", file=MESHES / "cylinder.step", unit="cm", size_mm=60.0, chord_mm=2.0)
    assert mesh.top_mm == pytest.approx(400.0, abs=1e-3)


@pytest.mark.parametrize("ending", ["stl", "vtu"])
def test_write_and_read(tmp_path, ending):
    mesh = build_tool("box", height_mm=20.0, fillet_mm=0.0)
    write_tool(mesh, tmp_path / f"box.{ending}")
    again = read_tool(tmp_path / f"box.{ending}")
    assert len(again.triangles) == len(mesh.triangles)
    assert again.volume_mm3 == pytest.approx(mesh.volume_mm3, rel=1e-6)


def test_inward_normals_are_turned(tmp_path):
    cube = small_cube()
    write_tool(TriangleMesh(cube.points, cube.triangles[:, ::-1]), tmp_path / "cube.stl")
    assert build_tool("file", file=tmp_path / "cube.stl").volume_mm3 == pytest.approx(1000.0, rel=1e-6)


def test_open_surface_is_refused_with_its_open_edges(tmp_path):
    cube = small_cube()
    write_tool(TriangleMesh(cube.points, cube.triangles[1:]), tmp_path / "open.stl")
    with pytest.raises(MeshError, match="not watertight: 3 open edges"):
        build_tool("file", file=tmp_path / "open.stl")


def test_mixed_orientation_is_refused():
    cube = small_cube()
    cube.triangles[0] = cube.triangles[0, ::-1]
    with pytest.raises(MeshError, match="opposite orientation"):
        check_watertight(cube, "cube")


@pytest.mark.parametrize(
    ("shape", "options", "match"),
    [
        ("pyramid", {}, "no tool shape"),
        ("box", {"fillet_mm": 41.0, "height_mm": 60.0}, "does not fit"),
        ("regular-tetrahedron", {"fillet_mm": 30.0}, "under 27.33"),
        ("cylinder", {"radius_mm": -1.0}, "positive"),
        ("file", {}, "needs the name"),
        ("file", {"file": "nowhere.stl"}, "no tool file"),
        ("file", {"file": __file__}, "not a STEP or STL"),
        ("file", {"file": MESHES / "box.step", "unit": "furlong"}, "unit"),
    ],
)
def test_impossible_tools(shape, options, match):
    with pytest.raises(MeshError, match=match):
        build_tool(shape, **options)


def test_damaged_files_are_named(tmp_path):
    for name in ("bad.step", "bad.stl"):
        (tmp_path / name).write_text("nothing of the kind\n")
        with pytest.raises(MeshError):
            build_tool("file", file=tmp_path / name)


def test_tool_below_its_platform(tmp_path):
    cube = small_cube()
    write_tool(TriangleMesh(cube.points - [0, 0, 20.0], cube.triangles), tmp_path / "low.stl")
    with pytest.raises(MeshError, match="below its platform"):
        build_tool("file", file=tmp_path / "low.stl")
