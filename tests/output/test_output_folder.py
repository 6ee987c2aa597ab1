from __future__ import annotations

import errno
import json
import os
import re
import warnings

import pytest

from ddf.errors import DdfError, UsageError
from ddf.output import atomic
from ddf.output.folder import RunFolder
from ddf.output.lock import folder_lock
from ddf.output.log import run_log


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


def test_two_runs_do_not_share_a_folder(folder):
    with folder_lock(folder.path), pytest.raises(UsageError, match="another run"), folder_lock(folder.path):
        pass
    with folder_lock(folder.path):
        pass


def test_refusing_changes_nothing_and_leftovers_of_a_kill_are_swept(folder):
    folder.write_text("run.json", "{}")
    (folder / "frames").mkdir()
    (folder / "frames/.ddf-x.vtu").write_text("torn")
    folder.refuse(force=True)
    with pytest.raises(UsageError):
        folder.refuse()
    assert (folder / "run.json").exists()
    folder.sweep()
    assert not (folder / "frames/.ddf-x.vtu").exists()


def _failing(folder, message, disk=None):
    with run_log(folder) as log:
        if disk is not None:
            log.handlers[-1].stream = open(disk, "w")  # noqa: SIM115
        log.info("at work")
        warnings.warn("careful", stacklevel=1)
        raise UsageError(message)


def test_the_log_tells_how_a_run_ended(folder):
    with pytest.raises(UsageError):
        _failing(folder, "of no use")
    text = (folder / "log.txt").read_text()
    assert re.search(r"^\d{4}-.*INFO at work\n.*WARNING .*careful(?s:.*)ERROR of no use$", text, re.MULTILINE)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full")
def test_a_full_disk_under_the_log_does_not_hide_the_error(folder):
    with pytest.raises(UsageError, match="the first"):
        _failing(folder, "the first", "/dev/full")
