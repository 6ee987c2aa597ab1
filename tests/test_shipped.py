"""Shipped cases and tools by their names."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from ddf.case import load_case
from ddf.cli import main
from ddf.errors import CaseError
from ddf.shipped import shipped_file, shipped_names
from ddf.sweep.sweep import make_plan

ROOT = Path(__file__).parents[1]


def test_names_are_those_of_the_source_tree():
    assert shipped_names("cases") == sorted(path.stem for path in (ROOT / "cases").glob("*.toml"))
    assert shipped_names("meshes") == sorted(path.stem for path in (ROOT / "meshes").glob("*.step"))


def test_a_case_by_its_name_from_anywhere(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert load_case("flat-stack") == load_case(ROOT / "cases/flat-stack.toml")
    assert make_plan("friction").points
    (tmp_path / "flat-stack").mkdir()  # a folder of that name, such as a run's, is not in the way
    assert load_case("flat-stack").title


def test_what_looks_like_a_path_never_meets_a_shipped_file(monkeypatch, tmp_path):
    """Or a run from the wrong folder would take another case of the same name for the user's."""
    monkeypatch.chdir(tmp_path)
    for name in ("flat-stack.toml", "./flat-stack", "cases/flat-stack", "../cases/flat-stack", ""):
        assert shipped_file("cases", name) is None
    with pytest.raises(CaseError, match="did you mean 'flat-stack'"):
        load_case("flat-stack.toml")


def test_a_tool_by_its_name(tmp_path):
    file = tmp_path / "case.toml"
    text = (ROOT / "cases/hemisphere.toml").read_text()
    start, end = text.index("[tool]"), text.index("[[process")
    file.write_text(text[:start] + '[tool]\nshape = "file"\nfile = "hemisphere"\n\n' + text[end:])
    assert load_case(file).tool.file == str(ROOT / "meshes/hemisphere.step")
    (tmp_path / "sweep.toml").write_text('case = "box"\nmethod = "grid"\n[vary]\n"friction.ply_ply" = [0.1, 0.2]\n')
    assert make_plan(str(tmp_path / "sweep.toml")).case == ROOT / "cases/box.toml"


def test_init_writes_shipped_cases(tmp_path):
    runner = CliRunner()
    assert "flat-stack" in runner.invoke(main, ["init", "--list"]).output
    assert runner.invoke(main, ["init", str(tmp_path / "a.toml"), "--case", "box"]).exit_code == 0
    assert load_case(tmp_path / "a.toml") == load_case("box")
    assert runner.invoke(main, ["init", str(tmp_path / "b.toml"), "--case", "bx"]).exit_code == 2
