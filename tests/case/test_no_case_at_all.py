"""All faults of a nasty file at once, with their lines, and files that are no case."""

import pytest
from fault_files import HEAD, faults_of, swap
from nasty_file import NASTY

from ddf.case import load_case
from ddf.errors import CaseError


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
