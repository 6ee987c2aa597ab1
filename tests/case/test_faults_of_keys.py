"""Faults of keys, types and ranges."""

import pytest
from fault_files import HEAD, add, check_fault, swap

FAULTS = {
    "unknown top-level key": (swap("[tool]", "[tol]"), "tol", 4, "unknown key", "tool"),
    "unknown key": (add("[solver]\nthread = 2\n"), "solver.thread", 12, "unknown key", "threads"),
    "key of another section": (add("[frame]\nply_ply = 1\n"), "frame.ply_ply", 12, "unknown key", "friction.ply_ply"),
    "missing plies": ("title = 'x'\n[process]\nstages=[{name='a',duration_s=1}]", "plies", 1, "missing", ""),
    "missing process": ("[[plies]]\nsize_mm=[100,100]\n", "process", 1, "missing", ""),
    "missing stage key": (swap("duration_s = 0.1\n", ""), "process.stages.0.duration_s", 7, "missing", ""),
    "text for number": (add("[frame]\nwidth_mm = '620'\n"), "frame.width_mm", 12, "not the right type", ""),
    "boolean for number": (add("[frame]\nwidth_mm = true\n"), "frame.width_mm", 12, "not the right type", ""),
    "number for boolean": (add("[output]\nvtu = 1\n"), "output.vtu", 12, "not the right type", ""),
    "number for integer": (add("[solver]\nthreads = 1.5\n"), "solver.threads", 12, "not the right type", ""),
    "number for table": ("solver = 3\n" + HEAD, "solver", 1, "not the right type", ""),
    "date for number": (add("[frame]\nwidth_mm = 2020-01-01 10:00:00\n"), "frame.width_mm", 12, "right type", ""),
    "nan": (add("[friction]\nply_ply = nan\n"), "friction.ply_ply", 12, "not a finite number", ""),
    "infinite": (add("[solver]\nmass_scaling = inf\n"), "solver.mass_scaling", 12, "not a finite", ""),
    "too large": (add("[friction]\nply_ply = 6\n"), "friction.ply_ply", 12, "out of range", ""),
    "too small": (add("[diaphragms]\npre_stretch = 0.5\n"), "diaphragms.pre_stretch", 12, "out of range", ""),
    "list too short": (swap("[350, 350]", "[350]"), "plies.0.size_mm", 2, "has 1 item", ""),
    "list too long": (swap("[350, 350]", "[1, 2, 3]"), "plies.0.size_mm", 2, "has 3 items", ""),
    "item type": (swap("[350, 350]", "[350, 'x']"), "plies.0.size_mm.1", 2, "not the right type", ""),
    "no plies": ("plies = []\n" + HEAD[HEAD.index("[tool]") :], "plies", 1, "has 0 items", ""),
    "name with a slash": (swap('"lift"', '"a/b"'), "process.stages.0.name", 8, "is not a name", ""),
    "negative number": (add("[diaphragms]\nthickness_mm = -1.5\n"), "diaphragms.thickness_mm", 12, "out of range", ""),
    "zero number": (add("[diaphragms]\nthickness_mm = 0\n"), "diaphragms.thickness_mm", 12, "out of range", ""),
    "huge number": (add("[friction]\nply_ply = 1e300\n"), "friction.ply_ply", 12, "out of range", ""),
    "huge integer": (add(f"[solver]\nthreads = {10**40}\n"), "solver.threads", 12, "so large a number", ""),
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
}


@pytest.mark.parametrize("name", FAULTS)
def test_one_fault(name, tmp_path):
    check_fault(tmp_path, name, *FAULTS[name])
