"""Random text, lines, tables and overrides: nothing but CaseError."""

import contextlib

import pytest
from fault_files import HEAD
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nasty_file import NASTY

from ddf.case import case_from_dict, load_case
from ddf.errors import CaseError

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
