"""Cases whose every key is allowed and that make no sense all the same: refused with exit code 2, or warned of."""

import re
import time
from pathlib import Path

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

from ddf.case import load_case
from ddf.cli import main
from ddf.plausible import cost, examine
from ddf.plausible.mesh import fold_radius_mm

ROOT = Path(__file__).parents[2]
COARSE, FLAT = ROOT / "cases/tetrahedron-0-90-coarse.toml", ROOT / "cases/flat-stack.toml"
LIFT, HOLD = "process.stages.1.", "process.stages.3."
WEAVE = "materials.w={kind='woven', base='plain-weave-6k-320', %s}"
RUBBER = "materials.r={kind='hyperelastic', ogden=[%s]}"

FAULTS = {
    "nothing happens": (FLAT, ["process.stages.0.cavity_pressure_kPa=101.325"], "process.stages", "nothing happens"),
    "a tool like a bullet": (COARSE, [LIFT + "duration_s=1e-5"], LIFT + "tool_lift_mm", "moves at 1.0"),
    "a torn diaphragm": (COARSE, [LIFT + "tool_lift_mm=2000"], LIFT + "tool_lift_mm", "stretch the diaphragm"),
    "in-plane bending that the elements lack": (
        COARSE,
        [WEAVE % "in_plane_bending_Nmm=0.1", "plies.0.material=w", "plies.0.formulation=shell-membrane"],
        "plies.0.formulation",
        "no in-plane bending",
    ),
    "more memory than there is": (
        COARSE,
        ["plies.0.element_mm=0.2", "plies.0.size_mm=[9000, 9000]", "frame.length_mm=10000", "frame.width_mm=10000"],
        "plies.0.element_mm",
        "GiB of memory",
    ),
}
WARNINGS = {
    "coarse ply": (COARSE, ["plies.0.element_mm=10"], "plies.0.element_mm", "cannot resolve"),
    "coarse diaphragm": (COARSE, ["diaphragms.element_mm=15"], "diaphragms.element_mm", "smeared"),
    "vacuum over a deep box": (
        COARSE,
        ["process.stages.0.box_pressure_kPa=0.0"],
        "diaphragms.element_max_mm",
        "platform is 82 mm below",
    ),
    "sharp tool": (COARSE, ["tool.fillet_mm=0.5"], "tool.fillet_mm", "far below"),
    "fast tool": (COARSE, [LIFT + "duration_s=0.005"], LIFT + "tool_lift_mm", "moves at"),
    "lift past the tool": (COARSE, [LIFT + "tool_lift_mm=150"], LIFT + "tool_lift_mm", "far above the frame"),
    "tool not lifted": (COARSE, [LIFT + "tool_lift_mm=0"], "tool", "never lifted"),
    "box before cavity": (
        COARSE,
        ["process.stages.0={name='box', duration_s=0.02, box_pressure_kPa=0.0}"],
        "process.stages.0.box_pressure_kPa",
        "blown apart",
    ),
    "blown up": (COARSE, [HOLD + "cavity_pressure_kPa=150.0"], HOLD + "cavity_pressure_kPa", "above the atmosphere"),
    "atmosphere in bar": (COARSE, ["process.atmosphere_kPa=1.013"], "process.atmosphere_kPa", "is it in kPa"),
    "heavy fabric": (
        COARSE,
        [WEAVE % "areal_density_gsm=5000.0", "plies.0.material=w"],
        "materials.w.areal_density_gsm",
        "unusual",
    ),
    "rigidity in N m": (
        COARSE,
        [WEAVE % "bending_rigidity_Nmm=500.0", "plies.0.material=w"],
        "materials.w.bending_rigidity_Nmm",
        "solid plate",
    ),
    "rigidity in N m the other way": (
        COARSE,
        [WEAVE % "bending_rigidity_Nmm=0.00034", "plies.0.material=w"],
        "materials.w.bending_rigidity_Nmm",
        "not N m",
    ),
    "angles in radians": (
        COARSE,
        [
            "materials.w={kind='woven', base='plain-weave-6k-320', shear_table={angle_deg=[0.0, 0.35, 0.7, 1.05], "
            "normalised_shear_force_N_mm=[0.0, 0.02, 0.1, 0.33]}}",
            "plies.0.material=w",
        ],
        "materials.w.shear_table.angle_deg",
        "radians",
    ),
    "no vacuum in the box": (
        COARSE,
        ["process.stages.2.box_pressure_kPa=101.325", HOLD + "box_pressure_kPa=101.325"],
        "process.stages",
        "nothing presses",
    ),
    "no vacuum in the cavity": (
        COARSE,
        ["process.stages.0.cavity_pressure_kPa=101.325"],
        "process.stages",
        "nothing clamps",
    ),
    "lift before the cavity": (
        COARSE,
        ["process.stages.0={name='first', duration_s=0.02, tool_lift_mm=20.0}", LIFT + "cavity_pressure_kPa=0.0"],
        "process.stages.0.tool_lift_mm",
        "not clamped yet",
    ),
    "a lift in cm": (COARSE, [LIFT + "tool_lift_mm=8.2"], LIFT + "tool_lift_mm", "below the frame"),
    "minutes of process": (COARSE, [HOLD + "duration_s=60.0"], "process.stages", "shop floor"),
    "rubber in kPa": (
        COARSE,
        [RUBBER % "{mu_MPa=960.0, alpha=2.0}", "diaphragms.material=r"],
        "materials.r.ogden",
        "not that of a rubber",
    ),
    "rubber that softens": (
        COARSE,
        [RUBBER % "{mu_MPa=1.0, alpha=-0.9}, {mu_MPa=-0.5, alpha=3.0}", "diaphragms.material=r"],
        "materials.r.ogden",
        "force falls",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_nonsense_is_refused_at_once(name):
    path, overrides, key, words = FAULTS[name]
    began = time.process_time()
    found = examine(load_case(path, overrides))
    assert time.process_time() - began < 1.0
    assert [".".join(map(str, fault.path)) for fault in found.faults] == [key]
    assert words in found.faults[0].problem
    assert found.faults[0].allowed


@pytest.mark.parametrize("name", WARNINGS)
def test_doubtful_cases_are_warned_of(name):
    path, overrides, key, words = WARNINGS[name]
    found = examine(load_case(path, overrides))
    assert not found.faults
    fitting = [warning for warning in found.warnings if ".".join(map(str, warning.path)) == key]
    assert fitting, found.warnings
    assert words in fitting[0].problem


@pytest.mark.parametrize("path", sorted((ROOT / "cases").glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_cases_raise_no_eyebrow(path):
    found = examine(load_case(path))
    assert not found.faults + found.warnings


def test_a_fold_of_the_published_stack_is_as_tight_as_those_seen():
    """Plies of 0.34 N mm between two skins of 1.1 N mm at 0.1 MPa: (2.5/0.1)^(1/3) = 2.9 mm."""
    case = load_case(ROOT / "cases/tetrahedron-0-90.toml")
    from ddf.build import load_path

    assert fold_radius_mm(case, load_path(case)) == pytest.approx(2.93, abs=0.05)


def test_memory_is_estimated_within_a_factor_of_two(make_scene):
    scene = make_scene("tetrahedron-0-90-coarse", "solver.symmetry=off")  # what is halved is meshed whole first
    nodes = sum(int(s["rows"] * s["cols"]) for s in scene.model.sheets)
    counts = cost.node_counts(scene.case)
    assert sum(counts.values()) + counts["a diaphragm"] == pytest.approx(nodes, rel=0.1)


CUBE = np.array([[x, y, z] for z in (-10.0, 30.0) for y in (-40.0, 40.0) for x in (-40.0, 40.0)])
SIDES = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
         [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]  # fmt: skip
TOOL = "tool={shape='file', file='%s'%s}"
FILES = {
    "sound": (CUBE, SIDES, "", None, ""),
    "open": (CUBE, SIDES[:-1], "", "tool.file", "not watertight"),
    "in metres": (CUBE / 1000, SIDES, "", "tool.unit", "too small"),
    "taken for metres": (CUBE, SIDES, ", unit='m'", "tool.file", "beyond the frame"),
    "below its platform": (CUBE - [0, 0, 50], SIDES, "", "tool.file", "below its platform"),
}


@pytest.mark.parametrize("name", FILES)
def test_tool_files(name, tmp_path):
    points, sides, more, key, words = FILES[name]
    meshio.Mesh(points, [("triangle", np.array(sides))]).write(tmp_path / "tool.stl", binary=True)
    case = load_case(COARSE, [TOOL % (tmp_path / "tool.stl", more)])
    began = time.process_time()
    found = examine(case)
    assert time.process_time() - began < 1.0
    assert [".".join(map(str, fault.path)) for fault in found.faults] == ([key] if key else [])
    if key:
        assert words in found.faults[0].problem
    if name in ("in metres", "taken for metres"):
        assert found.faults[0].suggestion == ('unit = "m"' if name == "in metres" else 'unit = "mm"')


@pytest.mark.parametrize("data", [b"", b"solid\nendsolid\n", b"\0" * 200, b"facet normal nan nan nan\n"])
@pytest.mark.parametrize("suffix", ["stl", "step"])
def test_files_that_are_no_tool(data, suffix, tmp_path):
    path = tmp_path / f"tool.{suffix}"
    path.write_bytes(data)
    result = CliRunner().invoke(main, ["check", str(COARSE), "--set", TOOL % (path, "")])
    assert result.exit_code == 2, result.output
    assert "tool.file" in result.output
    assert result.exception is None or isinstance(result.exception, SystemExit)


SMALL = ["plies.0.element_mm=25", "diaphragms.element_mm=25", "diaphragms.element_max_mm=80"]
MESHED = {
    "a year of steps": ([HOLD + "duration_s=3600"] * 1 + [LIFT + "duration_s=3600"], "process.stages", "steps"),
    "a step too long": (["solver.step_s=0.001"], "solver.step_s", "over the stable step"),
    "a blow": ([HOLD + "duration_s=1e-6"], "process.stages.3.duration_s", "a blow, not a stage"),
    "a fillet that does not fit": (["tool.fillet_mm=50"], "tool.fillet_mm", "does not fit"),
}


@pytest.mark.parametrize("name", MESHED)
def test_what_only_the_meshes_tell(name):
    overrides, key, words = MESHED[name]
    options = [part for item in SMALL + overrides for part in ("--set", item)]
    result = CliRunner().invoke(main, ["check", str(COARSE), *options])
    lines = [line for line in result.output.splitlines() if words in line]
    assert lines, result.output
    assert re.search(rf":\d+: {re.escape(key)}: ", lines[0])
    assert result.exit_code == (0 if name == "a year of steps" else 2), result.output
