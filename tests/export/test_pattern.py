"""Flat patterns: forming them again returns the trim line; what a ply does not reach is refused."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner
from nets import RADIUS, lattice

from ddf.cli import main
from ddf.errors import UsageError
from ddf.export.drawing import Drawing, Label, Line, dxf_text
from ddf.export.loops import chained, dense, parallel_line, read_trim_line, signed_distance, simplified
from ddf.export.part import FormedPly
from ddf.export.pattern import flat_pattern, foot_line, formed_points
from ddf.mesh.outline import signed_area
from ddf.metrics import PlySurface


def circle(radius, points=180, centre=(0.0, 0.0)):
    t = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return np.stack([radius * np.cos(t), radius * np.sin(t)], axis=1) + centre


def ply_of(x, x0, a):
    n, m = x.shape[1:]
    outline = np.array([[0.0, 0.0], [n - 1.0, 0.0], [n - 1.0, m - 1.0], [0.0, m - 1.0]])
    surface = PlySurface("p", x, x0, (a, a), np.ones((n, m), bool), np.ones((n - 1, m - 1)), [outline])
    return FormedPly(surface, 0.5, 0.0)


def folded(overhang):
    """A 120 mm ply with a fold along y at x = 0 that hangs over by `overhang` mm, its material kept along x."""
    a, half = 1.0, 60
    s = a * np.arange(2 * half + 1)
    plan = np.interp(s, [0, 50, 60, 70, 120], [-40, 6 + overhang, 0, -overhang + 6, 54])
    x0 = np.stack(np.meshgrid(s, s, [0.0], indexing="ij"))[..., 0]
    x = x0.copy()
    x[0] = plan[:, None]
    x[2] = np.interp(s, [0, 50, 60, 70, 120], [0, 8, 4, 0, 0])[:, None]
    return ply_of(x, x0, a)


def test_a_sheared_flat_ply_maps_back_in_closed_form():
    surface = lattice(1.0, 35.0, cells=60)
    ply = ply_of(surface.x, surface.x0, 2.0)
    trim = circle(20.0, centre=(70.0, 50.0))
    pattern = flat_pattern(ply, trim)
    g = np.radians(35.0)
    expected = np.stack([trim[:, 0] - trim[:, 1] * np.tan(g), trim[:, 1] / np.cos(g)], axis=1)
    assert len(pattern.flat) == 1
    assert np.abs(signed_distance(pattern.flat[0], expected)).max() < 0.005
    assert np.abs(signed_distance(expected, pattern.flat[0])).max() < 0.03
    assert pattern.area_mm2 == pytest.approx(abs(signed_area(trim)) / np.cos(g), rel=1e-3)


@pytest.mark.parametrize("overhang", [0.0, 2.0, 8.0])
def test_a_knife_cuts_every_layer_of_a_fold(overhang):
    ply = folded(overhang)
    trim = np.array([[-25.0, 20.0], [30.0, 20.0], [30.0, 90.0], [-25.0, 90.0]])
    pattern = flat_pattern(ply, trim)
    assert pattern.error_mm < 1e-3
    formed = formed_points(ply.surface, pattern.grid[0])[:, :2]
    assert np.abs(signed_distance(dense(trim, 0.5), formed)).max() < 0.5  # corners are cut by less than an element
    x = ply.surface.x[0, :, 0]
    inside = (x > -25.0) & (x < 30.0)
    assert pattern.area_mm2 == pytest.approx(70.0 * inside.sum(), rel=0.03)  # with all that is in the fold


def test_a_trim_line_on_a_fold_gives_all_pieces():
    ply = folded(8.0)
    trim = np.array([[10.0, 20.0], [30.0, 20.0], [30.0, 90.0], [10.0, 90.0]])  # the fold's top reaches x = 14
    pattern = flat_pattern(ply, trim)
    assert len(pattern.flat) == 2
    assert "hangs over" in pattern.notes[0]
    assert pattern.error_mm < 1e-3


def test_the_net_on_a_hemisphere_forms_back_to_its_trim_line(part):
    ply = part.plies[0]
    trim = foot_line(part.tool, 3.0)
    np.testing.assert_allclose(np.linalg.norm(trim, axis=1), RADIUS + 3.0, atol=0.05)
    pattern = flat_pattern(ply, trim)
    assert pattern.error_mm < 1e-3
    formed = formed_points(ply.surface, pattern.grid[0])[:, :2]
    assert np.abs(signed_distance(dense(trim, 0.5), formed)).max() < 0.1
    # a line in space, on the dome: back on it within the chords of the lattice
    height = 30.0
    ring = np.insert(circle(np.sqrt(RADIUS**2 - height**2)), 2, height, axis=1)
    dome = flat_pattern(ply, ring)
    formed = formed_points(ply.surface, dome.grid[0])
    direction = formed / np.linalg.norm(formed, axis=1)[:, None]
    assert np.abs(RADIUS * direction[:, 2] - height).max() < 0.1
    assert dome.error_mm < 0.6  # 0.5 mm over the tool, by `kinematic.offset_mm`


def test_a_trim_line_off_the_ply_is_refused_with_places(part):
    ply = part.plies[0]
    with pytest.raises(UsageError, match=r"does not cover the trim line: .* from \(-?\d+, -?\d+\)"):
        flat_pattern(ply, circle(RADIUS + 25.0))
    with pytest.raises(UsageError, match=r"does not reach the trim line at \("):
        flat_pattern(ply, np.insert(circle(RADIUS + 25.0), 2, 0.0, axis=1))


def test_lines_parallel_simplified_and_chained():
    square = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 30.0], [0.0, 30.0]])
    outside = parallel_line(square, 5.0)
    assert abs(signed_area(outside)) == pytest.approx(1200.0 + 140.0 * 5.0 + 25.0 * np.pi, rel=1e-3)
    np.testing.assert_allclose(signed_distance(outside, square), 5.0, atol=0.02)
    assert len(simplified(dense(square, 0.5), 0.01)) == 4
    segments = np.stack([square, np.roll(square, -1, axis=0)], axis=1)[[2, 0, 3, 1]]
    segments[1] = segments[1, ::-1]
    (loop,) = chained(np.concatenate([segments, segments[:1] + 100.0]))
    assert abs(signed_area(loop)) == pytest.approx(1200.0)


@pytest.mark.parametrize("text", ["", "x,y\n1,2\n", "x_mm,y_mm\n0,0\n1,1\n0,1\n1,0\n", "x_mm,y_mm\n0,0\n1,nan\n2,2\n"])
def test_trim_files_that_are_none_are_refused(tmp_path, text):
    (tmp_path / "trim.csv").write_text(text)
    with pytest.raises(UsageError, match="no trim line"):
        read_trim_line(tmp_path / "trim.csv")


def test_dxf_is_pairs_of_code_and_value_with_what_was_drawn():
    drawing = Drawing("a\nb", [Line("CUT", np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 5.5]]))], [Label("°", (1.0, 2.0))])
    lines = dxf_text(drawing).splitlines()
    pairs = [(int(code), value) for code, value in zip(lines[::2], lines[1::2], strict=True)]
    assert pairs[-1] == (0, "EOF")
    assert pairs.count((0, "SECTION")) == pairs.count((0, "ENDSEC")) == 3
    start = pairs.index((0, "POLYLINE"))
    assert (70, "1") in pairs[start : start + 6]
    vertices = [k for k, pair in enumerate(pairs) if pair == (0, "VERTEX")]
    assert [(float(pairs[k + 2][1]), float(pairs[k + 3][1])) for k in vertices] == [(0, 0), (10, 0), (0, 5.5)]


def test_the_command_writes_both_drawings_to_scale(run, part, tmp_path):
    trim = tmp_path / "trim.csv"
    trim.write_text("x_mm,y_mm\n" + "".join(f"{x},{y}\n" for x, y in circle(RADIUS - 5.0)))
    done = CliRunner().invoke(main, ["export", "flat-pattern", str(run), "--trim", str(trim), "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert "ply-1:" in done.output
    root = ElementTree.parse(tmp_path / "pattern-ply-1.svg").getroot()
    size = [float(root.attrib[key].removesuffix("mm")) for key in ("width", "height")]
    assert root.attrib["viewBox"] == f"0 0 {size[0]:.3f} {size[1]:.3f}"
    groups = {group.attrib["id"]: group for group in root if group.tag.endswith("}g")}
    cut = np.array([[float(v) for v in p.split(",")] for p in groups["CUT"][0].attrib["points"].split()])
    dxf = (tmp_path / "pattern-ply-1.dxf").read_text()
    assert len(re.findall(r"VERTEX\n\s*8\nCUT\n", dxf)) == len(cut)
    expected = flat_pattern(part.plies[0], circle(RADIUS - 5.0)).area_mm2
    assert abs(signed_area(cut)) == pytest.approx(expected, rel=1e-5)
    assert CliRunner().invoke(main, ["export", "flat-pattern", str(run)]).exit_code == 2
    refused = CliRunner().invoke(main, ["export", "animation", str(run)])
    assert refused.exit_code == 2
    assert "kinematic" in refused.output
