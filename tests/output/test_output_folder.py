from __future__ import annotations

import errno
import json
import os

import pytest

from ddf.errors import DdfError, UsageError
from ddf.output import atomic
from ddf.output.folder import RunFolder


def test_a_folder_with_files_is_refused_and_force_removes_only_what_ddf_wrote(tmp_path):
    folder = RunFolder.create(tmp_path / "a/b")
    folder.write_json("run.json", {})
    folder.write_bytes("frames/ply-1-0000.vtu", b"x")
    folder.write_bytes("pictures/mine.txt", b"x")
    folder.write_text("notes.txt", "mine")
    with pytest.raises(UsageError, match="not empty"):
        RunFolder.create(folder.path)
    RunFolder.create(folder.path, resume=True)
    assert (folder / "run.json").exists()
    RunFolder.create(folder.path, force=True)
    left = sorted(str(p.relative_to(folder.path)) for p in folder.path.rglob("*") if p.is_file())
    assert left == ["notes.txt", "pictures/mine.txt"]
    assert not (folder / "frames").exists()


def test_force_leaves_a_folder_that_held_no_run_as_it_is(tmp_path):
    (tmp_path / "case.toml").write_text("mine")
    RunFolder.create(tmp_path, force=True)
    assert (tmp_path / "case.toml").read_text() == "mine"


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="is a file"):
        RunFolder.create(tmp_path / "file")


@pytest.mark.parametrize(("code", "words"), [(errno.ENOSPC, "disk is full"), (errno.EROFS, "read-only")])
def test_a_failed_write_keeps_the_old_file_and_names_the_path(folder, monkeypatch, code, words):
    folder.write_text("log.txt", "old")

    def fail(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(atomic.os, "fsync", fail)
    with pytest.raises(DdfError, match=words) as raised:
        folder.write_text("log.txt", "new")
    assert str(folder / "log.txt") in str(raised.value)
    assert (folder / "log.txt").read_text() == "old"
    assert [p.name for p in folder.path.iterdir()] == ["log.txt"]


def test_json_has_no_nan(folder):
    folder.write_json("run.json", {"a": float("nan"), "b": (1, 2.5), "c": folder.path})
    assert json.loads((folder / "run.json").read_text()) == {"a": None, "b": [1, 2.5], "c": str(folder.path)}
