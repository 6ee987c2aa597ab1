"""Case files with a fault each: what they are made of, and what must be said of them."""

import re
import time
from pathlib import Path

import pytest

from ddf.case import load_case
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
SHEAR = WEAVE + "shear_table = {angle_deg = %s, normalised_shear_force_N_mm = %s}\n"
POINTS = "[process.breakpoints]\ntime_s = %s\ntool_lift_mm = %s\n"


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


def points(times, lifts):
    return HEAD[: HEAD.index("[[process")] + POINTS % (times, lifts)


def polygon(text, rest=""):
    return swap("size_mm = [350, 350]", f"polygon_mm = {text}\n{rest}")


def check_fault(tmp_path, name, text, key, line, words, suggestion):
    """The text has one fault: at this key and line, in these words, with this suggestion."""
    faults = faults_of(tmp_path, text)
    fitting = [fault for fault in faults if re.fullmatch(key, fault.key)]
    assert fitting, [str(fault) for fault in faults]
    assert fitting[0].line == line
    assert re.search(words, fitting[0].problem)
    assert fitting[0].suggestion == suggestion
    # A misspelt table also means that there is no tool to lift.
    assert len(faults) == (2 if name == "unknown top-level key" else 1), [str(fault) for fault in faults]
