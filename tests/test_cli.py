"""What the command line says and returns where nothing is formed."""

import json

import pytest
from click.testing import CliRunner

import ddf.case.load
from ddf.cli import main


@pytest.fixture
def ddf_():
    return lambda *arguments: CliRunner().invoke(main, list(arguments))


def test_help_keeps_the_lines_of_its_examples(ddf_):
    """And every command has an example."""
    text = ddf_("--help").output
    assert "\n  ddf init my-case.toml " in text
    assert "\n  ddf check my-case.toml " in text
    for name in main.commands:
        assert f"ddf {name}" in ddf_(name, "--help").output.split("Options:")[0].split("Usage:")[1].split("\n", 1)[1]


def test_schema_for_people_and_for_editors(ddf_):
    assert "| `ply_ply` |" in ddf_("schema").output
    assert "Friction" in json.loads(ddf_("schema", "--json").output)["$defs"]
    assert "| `samples` |" in ddf_("schema", "--sweep").output


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (MemoryError(), 1, "out of memory"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (RuntimeError("cannot cache function 'f': no locator available for file 'x'"), 1, "DDF_CACHE_DIR"),
    ],
)
def test_what_can_happen_anywhere_ends_in_words(ddf_, monkeypatch, error, code, words):
    def fail(*_):
        raise error

    monkeypatch.setattr(ddf.case.load, "load_source", fail)
    done = ddf_("check", "flat-stack")
    assert (done.exit_code, words in done.output) == (code, True)
    assert "Traceback" not in done.output


def test_an_error_of_ddf_itself_is_not_hidden(ddf_, monkeypatch):
    monkeypatch.setattr(ddf.case.load, "load_source", lambda *_: 1 / 0)
    assert isinstance(ddf_("check", "flat-stack").exception, ZeroDivisionError)


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "flat-stack", "--resume", "--force"),
        ("run", "flat-stack", "--threads", "0"),
        ("compare", ".", ".", "--align"),
        ("report", "nowhere"),
        ("verify", "no-such-problem"),
        ("sweep", "frition"),
        ("init", "/", "--force", "--case", "no-such-case"),
    ],
)
def test_misuse_is_exit_code_2(ddf_, arguments):
    done = ddf_(*arguments)
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.output


def test_a_sweep_lists_its_cases_and_runs_nothing(ddf_, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = ddf_("sweep", "friction", "--list")
    assert done.exit_code == 0
    assert "friction-0.28" in done.output
    assert not list(tmp_path.iterdir())


def test_an_unwritable_place_for_a_new_case_is_said(ddf_, tmp_path):
    (tmp_path / "file").write_text("")
    done = ddf_("init", str(tmp_path / "file/case.toml"))
    assert done.exit_code == 1
    assert "cannot write" in done.output
