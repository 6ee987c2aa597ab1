"""Faults of the tool, the process and the solver."""

import pytest
from fault_files import HEAD, POINTS, STEP, add, check_fault, points, swap

FAULTS = {
    "stage below the time's rounding": (
        swap("duration_s = 0.1", "duration_s = 5e-324"),
        "process.stages.0.duration_s",
        9,
        "out of range",
        "",
    ),
    "pressure": (add("box_pressure_kPa = 1001\n"), "process.stages.0.box_pressure_kPa", 11, "out of range", ""),
    "literal": (add('ramp = "smoth"\n'), "process.stages.0.ramp", 11, "not one of", "smooth"),
    "same stage name": (
        add("[[process.stages]]\nname = 'Lift'\nduration_s = 1\n"),
        "process.stages.1.name",
        12,
        "already",
        "",
    ),
    "mesh sizes": (add("[diaphragms]\nelement_max_mm = 1\n"), "diaphragms.element_max_mm", 12, "smaller", ""),
    "unknown shape": (swap("cube-corner", "cube-corned"), "tool.shape", 5, "not one", "cube-corner-tetrahedron"),
    "no radius": (swap("cube-corner-tetrahedron", "hemisphere"), "tool.radius_mm", 4, "required", ""),
    "unused tool key": (swap("\n\n[[proc", "\nradius_mm = 9\n\n[[proc"), "tool.radius_mm", 6, "means nothing", ""),
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
    "tool too wide": (swap("\n\n[[proc", "\nheight_mm = 300\n\n[[proc"), "tool.shape", 5, "beyond the frame", ""),
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
    "stage of no length": (swap("duration_s = 0.1", "duration_s = 0"), "process.stages.0.duration_s", 9, "range", ""),
    "pressure in pascal": (
        add("cavity_pressure_kPa = 101325\n"),
        "process.stages.0.cavity_pressure_kPa",
        11,
        "out of range",
        "",
    ),
    "coarse diaphragm for the ply": (
        add("[diaphragms]\nelement_mm = 90\nelement_max_mm = 90\n").replace("[350, 350]", "[150, 350]"),
        "diaphragms.element_mm",
        12,
        "too large for the smallest ply",
        "",
    ),
    "gap within the plies": (add("[diaphragms]\ngap_mm = 0.4\n"), "diaphragms.gap_mm", 12, "start inside", ""),
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
    check_fault(tmp_path, name, *FAULTS[name])
