"""Faults: each kind alone, all of a nasty file at once with their lines, and files that are no case."""

import contextlib
import re
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ddf.case import case_from_dict, load_case
from ddf.errors import CaseError

STEP = Path(__file__).parents[2] / "meshes/box.step"
HEAD = """\
[[plies]]
size_mm = [350, 350]

[tool]
shape = "cube-corner-tetrahedron"

[[process.stages]]
name = "lift"
duration_s = 0.1
tool_lift_mm = 82
"""
WEAVE = '[materials.w]\nkind = "woven"\nbase = "plain-weave-6k-320"\n'


def faults_of(tmp_path, text, overrides=()):
    path = tmp_path / "case.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    began = time.process_time()
    with pytest.raises(CaseError) as caught:
        load_case(path, overrides)
    assert time.process_time() - began < 1.0
    assert all(fault.file in (str(path), "--set") for fault in caught.value.faults)
    return caught.value.faults


def add(text):
    return HEAD + text


def swap(old, new):
    assert old in HEAD
    return HEAD.replace(old, new)


SHEAR = WEAVE + "shear_table = {angle_deg = %s, normalised_shear_force_N_mm = %s}\n"
POINTS = "[process.breakpoints]\ntime_s = %s\ntool_lift_mm = %s\n"


def points(times, lifts):
    return HEAD[: HEAD.index("[[process")] + POINTS % (times, lifts)


def polygon(text, rest=""):
    return swap("size_mm = [350, 350]", f"polygon_mm = {text}\n{rest}")


FAULTS = {
    "unknown top-level key": (swap("[tool]", "[tol]"), "tol", 4, "unknown key", "tool"),
    "unknown key": (add("[solver]\nthread = 2\n"), "solver.thread", 12, "unknown key", "threads"),
    "key of another section": (
        add("[frame]\nply_ply = 1\n"),
        "frame.ply_ply",
        12,
        "unknown key",
        "friction.ply_ply",
    ),
    "missing plies": ("title = 'x'\n[process]\nstages=[{name='a',duration_s=1}]", "plies", 1, "missing", ""),
    "missing process": ("[[plies]]\nsize_mm=[100,100]\n", "process", 1, "missing", ""),
    "missing stage key": (swap("duration_s = 0.1\n", ""), "process.stages.0.duration_s", 7, "missing", ""),
    "text for number": (add("[frame]\nwidth_mm = '620'\n"), "frame.width_mm", 12, "not the right type", ""),
    "boolean for number": (add("[frame]\nwidth_mm = true\n"), "frame.width_mm", 12, "not the right type", ""),
    "number for boolean": (add("[output]\nvtu = 1\n"), "output.vtu", 12, "not the right type", ""),
    "number for integer": (add("[solver]\nthreads = 1.5\n"), "solver.threads", 12, "not the right type", ""),
    "number for table": ("solver = 3\n" + HEAD, "solver", 1, "not the right type", ""),
    "date for number": (
        add("[frame]\nwidth_mm = 2020-01-01 10:00:00\n"),
        "frame.width_mm",
        12,
        "right type",
        "",
    ),
    "nan": (add("[friction]\nply_ply = nan\n"), "friction.ply_ply", 12, "not a finite number", ""),
    "infinite": (add("[solver]\nmass_scaling = inf\n"), "solver.mass_scaling", 12, "not a finite", ""),
    "too large": (add("[friction]\nply_ply = 6\n"), "friction.ply_ply", 12, "out of range", ""),
    "too small": (add("[diaphragms]\npre_stretch = 0.5\n"), "diaphragms.pre_stretch", 12, "out of range", ""),
    "pressure": (
        add("box_pressure_kPa = 1001\n"),
        "process.stages.0.box_pressure_kPa",
        11,
        "out of range",
        "",
    ),
    "literal": (add('ramp = "smoth"\n'), "process.stages.0.ramp", 11, "not one of", "smooth"),
    "list too short": (swap("[350, 350]", "[350]"), "plies.0.size_mm", 2, "has 1 item", ""),
    "list too long": (swap("[350, 350]", "[1, 2, 3]"), "plies.0.size_mm", 2, "has 3 items", ""),
    "item type": (swap("[350, 350]", "[350, 'x']"), "plies.0.size_mm.1", 2, "not the right type", ""),
    "no plies": ("plies = []\n" + HEAD[HEAD.index("[tool]") :], "plies", 1, "has 0 items", ""),
    "no outline": (swap("size_mm = [350, 350]\n", ""), "plies.0.size_mm", 1, "is required", ""),
    "two outlines": (
        swap("350]\n", "350]\npolygon_mm = [[0,0],[9,0],[0,9]]\n"),
        "plies.0.polygon_mm",
        3,
        "together",
        "",
    ),
    "name with a slash": (swap('"lift"', '"a/b"'), "process.stages.0.name", 8, "is not a name", ""),
    "same ply name": (
        swap("[tool]", "[[plies]]\nname = 'ply-1'\nsize_mm = [9, 9]\n[tool]"),
        "plies.1.name",
        5,
        "already",
        "",
    ),
    "same stage name": (
        add("[[process.stages]]\nname = 'Lift'\nduration_s = 1\n"),
        "process.stages.1.name",
        12,
        "already",
        "",
    ),
    "ply beyond the frame": (
        swap("[350, 350]", "[350, 600]"),
        "plies.0.size_mm",
        2,
        "10 mm too far along y",
        "",
    ),
    "ply moved out": (swap("350]\n", "350]\noffset_mm = [500, 0]\n"), "plies.0.offset_mm", 3, "along x", ""),
    "coarse ply": (
        swap("350]\n", "350]\nelement_mm = 20\n").replace("350]", "30]"),
        "plies.0.element_mm",
        3,
        "",
        "",
    ),
    "crossing edges": (polygon("[[0,0],[9,9],[9,0],[0,9]]"), "plies.0.polygon_mm", 2, "edges 1 and 3", ""),
    "folded edge": (polygon("[[0,0],[90,0],[40,0],[40,90]]"), "plies.0.polygon_mm", 2, "cross or touch", ""),
    "closed polygon": (
        polygon("[[0,0],[90,0],[0,90],[0,0]]"),
        "plies.0.polygon_mm",
        2,
        "corners 4 and 1",
        "",
    ),
    "hole outside": (
        swap("350]\n", "350]\nholes_mm = [[[170,0],[180,0],[170,9]]]\n"),
        "plies.0.holes_mm.0",
        3,
        "not inside",
        "",
    ),
    "hole in a notch": (
        polygon("[[-90,-90],[90,-90],[90,90],[0,-50],[-90,90]]", "holes_mm = [[[-5,50],[5,50],[0,60]]]"),
        "plies.0.holes_mm.0",
        3,
        "not inside",
        "",
    ),
    "holes overlap": (
        swap("350]\n", "350]\nholes_mm = [[[0,0],[50,0],[0,50]],\n [[1,1],[9,1],[1,9]]]\n"),
        "plies.0.holes_mm.1",
        4,
        "overlaps",
        "",
    ),
    "crossing hole": (
        swap("350]\n", "350]\nholes_mm = [[[0,0],[9,9],[9,0],[0,9]]]\n"),
        "plies.0.holes_mm.0",
        3,
        "edges 1",
        "",
    ),
    "slit outside": (
        swap("350]\n", "350]\nslits_mm = [[[0,0],[0,176]]]\n"),
        "plies.0.slits_mm.0",
        3,
        "not inside",
        "",
    ),
    "unknown material": (
        swap("350]\n", "350]\nmaterial = 'plain-weave'\n"),
        "plies.0.material",
        3,
        "no material",
        "plain-weave-6k-320",
    ),
    "rubber ply": (
        swap("350]\n", "350]\nmaterial = 'silicone-ogden'\n"),
        "plies.0.material",
        3,
        "not woven",
        "",
    ),
    "woven diaphragm": (
        add("[diaphragms]\nmaterial = 'plain-weave-6k-320'\n"),
        "diaphragms.material",
        12,
        "not hyperelastic",
        "",
    ),
    "mesh sizes": (add("[diaphragms]\nelement_max_mm = 1\n"), "diaphragms.element_max_mm", 12, "smaller", ""),
    "no kind": (add("[materials.w]\nbase = 'silicone-ogden'\n"), "materials.w.kind", 11, "missing", ""),
    "unknown kind": (add("[materials.w]\nkind = 'wovn'\n"), "materials.w.kind", 12, "not one of", "woven"),
    "unknown base": (
        add(WEAVE.replace("320", "32")),
        "materials.w.base",
        13,
        "no preset",
        "plain-weave-6k-320",
    ),
    "base of another kind": (
        add(WEAVE.replace('"woven"', '"hyperelastic"')),
        "materials.w.base",
        13,
        "is woven",
        "",
    ),
    "negative modulus": (
        add(WEAVE + "membrane_modulus_N_mm = -1\n"),
        "materials.w.membrane_modulus_N_mm",
        14,
        "out of range",
        "",
    ),
    "no shear": (
        add(
            "[materials.w]\nkind='woven'\nthickness_mm=1\nareal_density_gsm=1\nmembrane_modulus_N_mm=1\n"
            "bending_rigidity_Nmm=1\n"
        ),
        "materials.w.shear_modulus_polynomial_MPa",
        11,
        "one of",
        "",
    ),
    "two shear curves": (
        add(SHEAR % ([0, 9], [0, 1]) + "shear_modulus_polynomial_MPa = [1]\n"),
        "materials.w.shear_table",
        14,
        "together",
        "",
    ),
    "shear table lengths": (
        add(SHEAR % ([0, 9], [0, 1, 2])),
        "materials.w.shear_table.normalised_shear_force_N_mm",
        14,
        "3 items",
        "",
    ),
    "shear table start": (
        add(SHEAR % ([1, 9], [0, 1])),
        "materials.w.shear_table.angle_deg",
        14,
        "starts at 1",
        "",
    ),
    "shear table order": (
        add(SHEAR % ([0, 9, 9], [0, 1, 2])),
        "materials.w.shear_table.angle_deg.2",
        14,
        "follows",
        "",
    ),
    "shear at rest": (
        add(SHEAR % ([0, 9], [1, 2])),
        "materials.w.shear_table.normalised_shear_force_N_mm",
        14,
        "starts at",
        "",
    ),
    "soft rubber": (
        add("[materials.r]\nkind='hyperelastic'\nogden=[{mu_MPa=-1, alpha=2}]\n"),
        "materials.r.ogden",
        13,
        "not positive",
        "",
    ),
    "zero exponent": (
        add("[materials.r]\nkind='hyperelastic'\nogden=[\n{mu_MPa=1, alpha=0}]\n"),
        "materials.r.ogden.0.alpha",
        14,
        "out of range",
        "",
    ),
    "unknown shape": (
        swap("cube-corner", "cube-corned"),
        "tool.shape",
        5,
        "not one",
        "cube-corner-tetrahedron",
    ),
    "no radius": (swap("cube-corner-tetrahedron", "hemisphere"), "tool.radius_mm", 4, "required", ""),
    "unused tool key": (
        swap("\n\n[[proc", "\nradius_mm = 9\n\n[[proc"),
        "tool.radius_mm",
        6,
        "means nothing",
        "",
    ),
    "no tool file": (
        swap('"cube-corner-tetrahedron"', '"file"\nfile = "part.step"'),
        "tool.file",
        6,
        "no such file",
        "",
    ),
    "tool file with a zero": (
        swap('"cube-corner-tetrahedron"', '"file"\nfile = "a\\u0000.step"'),
        "tool.file",
        6,
        "cannot|no such",
        "",
    ),
    "tool moved out": (
        swap("\n\n[[proc", "\nposition_mm = [0, 250]\n\n[[proc"),
        "tool.position_mm",
        6,
        "beyond the frame",
        "",
    ),
    "tool too wide": (
        swap("\n\n[[proc", "\nheight_mm = 300\n\n[[proc"),
        "tool.shape",
        5,
        "beyond the frame",
        "",
    ),
    "turned box": (
        swap('"cube-corner-tetrahedron"', '"box"\nlength_mm=700\nwidth_mm=50\nheight_mm=9\nturn_deg=90'),
        "tool.position_mm|tool.shape",
        5,
        "along y",
        "",
    ),
    "fillet": (
        swap('"cube-corner-tetrahedron"', '"box"\nlength_mm=50\nwidth_mm=8\nheight_mm=9'),
        "tool.fillet_mm",
        4,
        "too large",
        "",
    ),
    "lift without a tool": (
        HEAD.replace('[tool]\nshape = "cube-corner-tetrahedron"\n', ""),
        "process.stages.0.tool_lift_mm",
        8,
        "no tool",
        "",
    ),
    "stages and breakpoints": (add(POINTS % ([0, 1], [0, 1])), "process.breakpoints", 11, "together", ""),
    "no loading": (HEAD[: HEAD.index("[[process")] + "[process]\n", "process.stages", 7, "required", ""),
    "breakpoint lengths": (points([0, 1], [0, 1, 2]), "process.breakpoints.tool_lift_mm", 9, "3 items", ""),
    "breakpoint start": (points([1, 2], [0, 1]), "process.breakpoints.time_s", 8, "starts at 1", ""),
    "breakpoint order": (points([0, 2, 1], [0, 1, 2]), "process.breakpoints.time_s.2", 8, "follows", ""),
    "step and scaling": (
        add("[solver]\nmass_scaling = 2\ntarget_step_s = 1e-6\n"),
        "solver.target_step_s",
        13,
        "together",
        "",
    ),
    "negative number": (add("[diaphragms]\nthickness_mm = -1.5\n"), "diaphragms.thickness_mm", 12, "out of range", ""),
    "zero number": (add("[diaphragms]\nthickness_mm = 0\n"), "diaphragms.thickness_mm", 12, "out of range", ""),
    "huge number": (add("[friction]\nply_ply = 1e300\n"), "friction.ply_ply", 12, "out of range", ""),
    "huge integer": (add(f"[solver]\nthreads = {10**40}\n"), "solver.threads", 12, "so large a number", ""),
    "stage of no length": (swap("duration_s = 0.1", "duration_s = 0"), "process.stages.0.duration_s", 9, "range", ""),
    "pressure in pascal": (
        add("cavity_pressure_kPa = 101325\n"),
        "process.stages.0.cavity_pressure_kPa",
        11,
        "out of range",
        "",
    ),
    "unit left out of the key": (
        add("[diaphragms]\nthickness = 1.5\n"),
        "diaphragms.thickness",
        12,
        "unknown key",
        "thickness_mm",
    ),
    "another unit in the key": (
        swap("duration_s = 0.1", "duration_s = 0.1\nbox_pressure_Pa = 0"),
        "process.stages.0.box_pressure_Pa",
        10,
        "unknown key",
        "box_pressure_kPa",
    ),
    "upper-case key": (add("[Solver]\nthreads = 1\n"), "Solver", 11, "unknown key", "solver"),
    "table for number": (add("[frame.width_mm]\nvalue = 3\n"), "frame.width_mm", 11, "a table is not", ""),
    "list for number": (add("[frame]\nwidth_mm = [620]\n"), "frame.width_mm", 12, "a list is not", ""),
    "number for text": (add("[diaphragms]\nmaterial = 3\n"), "diaphragms.material", 12, "not the right type", ""),
    "number for list": (swap("[350, 350]", "350"), "plies.0.size_mm", 2, "not the right type", ""),
    "ply that is no table": ("plies = [3]\n" + HEAD[HEAD.index("[tool]") :], "plies.0", 1, "not the right type", ""),
    "empty name": (swap('"lift"', '""'), "process.stages.0.name", 8, "too short", ""),
    "name with a line end": (swap('"lift"', '"lift\\n"'), "process.stages.0.name", 8, "is not a name", ""),
    "name with dots": (swap('"lift"', '"../lift"'), "process.stages.0.name", 8, "is not a name", ""),
    "name of the run's files": (swap("350]\n", "350]\nname = 'Tool'\n"), "plies.0.name", 3, "taken by", ""),
    "one corner twice": (polygon("[[0,0],[90,0],[90,0],[0,90]]"), "plies.0.polygon_mm", 2, "corners 2 and 3", ""),
    "polygon of two corners": (polygon("[[0,0],[90,0]]"), "plies.0.polygon_mm", 2, "has 2 items", ""),
    "corner of three numbers": (polygon("[[0,0],[90,0,1],[0,90]]"), "plies.0.polygon_mm.1", 2, "has 3 items", ""),
    "corner far away": (polygon("[[0,0],[1e9,0],[0,90]]"), "plies.0.polygon_mm.1.0", 2, "out of range", ""),
    "flat polygon": (polygon("[[0,0],[90,0],[45,0]]"), "plies.0.polygon_mm", 2, "cross or touch", ""),
    "cuts of too many points": (
        swap("350]\n", f"350]\nslits_mm = {[[[k, 0] for k in range(150)]] * 70}\n"),
        "plies.0.slits_mm",
        3,
        "10500 points",
        "",
    ),
    "coarse diaphragm for the ply": (
        add("[diaphragms]\nelement_mm = 90\nelement_max_mm = 90\n").replace("[350, 350]", "[150, 350]"),
        "diaphragms.element_mm",
        12,
        "too large for the smallest ply",
        "",
    ),
    "coarse ply for the tool": (
        swap("\n\n[[proc", "\nheight_mm = 20\n\n[[proc").replace("350]\n", "350]\nelement_mm = 40\n"),
        "plies.0.element_mm",
        3,
        "too large for a tool",
        "",
    ),
    "gap within the plies": (add("[diaphragms]\ngap_mm = 0.4\n"), "diaphragms.gap_mm", 12, "start inside", ""),
    "thickness in metres": (add(WEAVE + "thickness_mm = 0.0005\n"), "materials.w.areal_density_gsm", 11, "density", ""),
    "density in g per cm3": (
        add("[materials.r]\nkind='hyperelastic'\nbase='silicone-ogden'\ndensity_kg_m3=1.1\n"),
        "materials.r.density_kg_m3",
        14,
        "out of range",
        "",
    ),
    "negative lift": (
        swap("tool_lift_mm = 82", "tool_lift_mm = -82"),
        "process.stages.0.tool_lift_mm",
        10,
        "range",
        "",
    ),
    "breakpoint gap": (points([0, float("nan"), 1], [0, 1, 2]), "process.breakpoints.time_s.1", 8, "finite", ""),
    "tool file of another format": (
        swap('"cube-corner-tetrahedron"', f'"file"\nfile = {str(__file__)!r}'),
        "tool.file",
        6,
        "not a known format",
        "",
    ),
    "tool file in another unit": (
        swap('"cube-corner-tetrahedron"', f'"file"\nfile = {str(STEP)!r}\nunit = "feet"'),
        "tool.unit",
        7,
        "not one of",
        "",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_one_fault(name, tmp_path):
    text, key, line, words, suggestion = FAULTS[name]
    faults = faults_of(tmp_path, text)
    fitting = [fault for fault in faults if re.fullmatch(key, fault.key)]
    assert fitting, [str(fault) for fault in faults]
    assert fitting[0].line == line
    assert re.search(words, fitting[0].problem)
    assert fitting[0].suggestion == suggestion
    # A misspelt table also means that there is no tool to lift.
    assert len(faults) == (2 if name == "unknown top-level key" else 1), [str(fault) for fault in faults]


NASTY = '''\
title = 3
tooling = """
[frame]
length_mm = 1
"""

[frame]
length_mm = nan

[diaphragms]
thicknes_mm = 1.5          # "quoted" comment

[materials."my weave"]
kind = "woven"
base = "plain-weave-6k-320"
bending_rigidity_Nmm = [0.3, -0.3]
shear_table.angle_deg = [0, 20, 10]
shear_table.normalised_shear_force_N_mm = [0,
  1]

[[plies]]
size_mm = [350, 350]
element_mm = true

[[plies]]
name = "ply-1"
polygon_mm = [
  [-10, -10],   # a comment with ]
  [10, 10],
  [10, -10],
  [-10, 10],
]
material = "my weav"

[tool]
shape = "hemisphere"
height_mm = 3

[process]
stages = [
  {name = "a", duration_s = 0},
  {name = "b", duration_s = 1, ramp = "smoth"},
]
'''


def test_every_fault_at_once(tmp_path):
    faults = faults_of(tmp_path, NASTY, ["solver.threads=0"])
    assert [(fault.line, fault.key) for fault in faults] == [
        (1, "title"),
        (2, "tooling"),
        (8, "frame.length_mm"),
        (11, "diaphragms.thicknes_mm"),
        (16, "materials.my weave.bending_rigidity_Nmm.1"),
        (17, "materials.my weave.shear_table.angle_deg.2"),
        (18, "materials.my weave.shear_table.normalised_shear_force_N_mm"),
        (23, "plies.0.element_mm"),
        (26, "plies.1.name"),
        (27, "plies.1.polygon_mm"),
        (33, "plies.1.material"),
        (35, "tool.radius_mm"),
        (37, "tool.height_mm"),
        (41, "process.stages.0.duration_s"),
        (42, "process.stages.1.ramp"),
        (1, "solver.threads"),
    ]
    assert str(faults[3]).endswith("did you mean 'thickness_mm'?")


@pytest.mark.parametrize(
    ("data", "line", "words"),
    [
        (b"", 1, "empty"),
        (b"\xef\xbb\xbf \n\n", 1, "empty"),
        (b"title = 'x'\ny = '\xff'\n", 2, "UTF-8"),
        (b"title = 'x'\n[frame\n", 2, "TOML"),
        (b"a = 1\na = 2\n", 2, "TOML"),
        (b"x = " + b"[" * 5000, 1, "TOML"),
        (b"x = " + b"9" * 5000, 1, "TOML"),
        (b"#" * 10_000_001, 1, "too large"),
    ],
    ids=["empty", "blank", "latin", "broken", "twice", "deep", "digits", "large"],
)
def test_not_a_case_at_all(data, line, words, tmp_path):
    (fault,) = faults_of(tmp_path, data)
    assert (fault.line, fault.key) == (line, "")
    assert words in fault.problem


def test_no_file(tmp_path):
    (tmp_path / "case.toml").write_text(HEAD)
    with pytest.raises(CaseError, match=r"no such file.*did you mean 'case.toml'"):
        load_case(tmp_path / "cas.toml")
    with pytest.raises(CaseError, match="is a directory"):
        load_case(tmp_path)
    with pytest.raises(CaseError):
        load_case("a\0b")
    with pytest.raises(CaseError):
        load_case("x" * 5000)


def test_windows_line_ends_and_byte_order_mark(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + HEAD.replace("\n", "\r\n").encode())
    assert load_case(path).tool.height_mm == 82
    faults = faults_of(tmp_path, swap("350]", "'x']").replace("\n", "\r\n"))
    assert faults[0].line == 2


def test_deep_but_valid_toml(tmp_path):
    assert faults_of(tmp_path, "x = " + "[" * 150 + "]" * 150 + "\n" + HEAD)[0].line == 1


KEYS = st.sampled_from(
    [
        "title",
        "frame",
        "plies",
        "tool",
        "process",
        "stages",
        "solver",
        "materials",
        "kind",
        "base",
        "shape",
        "file",
        "size_mm",
        "polygon_mm",
        "holes_mm",
        "slits_mm",
        "offset_mm",
        "element_mm",
        "name",
        "duration_s",
        "tool_lift_mm",
        "ogden",
        "shear_table",
        "angle_deg",
        "breakpoints",
        "time_s",
        "mass_scaling",
        "target_step_s",
        "gap_mm",
        "orientation_deg",
        "membrane_modulus_N_mm",
        "material",
        "friction",
    ]
)
WORDS = st.sampled_from(
    ["woven", "hyperelastic", "box", "file", "cylinder", "hemisphere", "silicone-ogden", "plain-weave-6k-320"]
)
LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | WORDS | st.text(max_size=5) | st.datetimes()
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(KEYS | st.text(max_size=3), inner, max_size=5),
    max_leaves=20,
)
QUICK = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@QUICK
@given(st.text(max_size=200) | st.binary(max_size=200))
def test_random_text_gives_nothing_but_case_errors(tmp_path, text):
    path = tmp_path / "fuzz.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass"))
    with pytest.raises(CaseError):
        load_case(path)


@QUICK
@given(st.lists(st.sampled_from(NASTY.splitlines() + HEAD.splitlines()), max_size=30))
def test_shuffled_lines_give_nothing_but_case_errors(tmp_path, lines):
    path = tmp_path / "fuzz.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    with contextlib.suppress(CaseError):
        load_case(path)


@QUICK
@given(st.dictionaries(KEYS, VALUES, max_size=6), st.data())
def test_random_tables_give_nothing_but_case_errors(tables, data):
    base = {
        "plies": [{"size_mm": [100, 100]} | data.draw(st.dictionaries(KEYS, VALUES, max_size=2))],
        "process": {"stages": [{"name": "a", "duration_s": 1}]},
        "tool": {"shape": "box"} | data.draw(st.dictionaries(KEYS, VALUES, max_size=3)),
        "materials": {"m": {"kind": "woven"} | data.draw(st.dictionaries(KEYS, VALUES, max_size=3))},
    }
    with contextlib.suppress(CaseError):
        case_from_dict(base | tables)


@QUICK
@given(st.text(max_size=40), st.sampled_from(["", "solver.threads=", "plies.0.", "tool.position_mm="]))
def test_random_overrides_give_nothing_but_case_errors(tmp_path, text, start):
    path = tmp_path / "case.toml"
    path.write_text(HEAD)
    with contextlib.suppress(CaseError):
        load_case(path, [start + text])
