"""Where kernels are cached."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from ddf.errors import DdfError
from ddf.kernel_cache import IMPORT, cache_note, kernel_sources, source_digest, use_cache, warm_kernels

PACKAGE = Path(__file__).parents[1] / "ddf"


def test_a_process_started_by_ddf_uses_the_same_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("DDF_CACHE_DIR", str(tmp_path))
    folder = use_cache()
    assert folder == tmp_path / source_digest(PACKAGE)
    assert not cache_note()
    monkeypatch.delenv("DDF_CACHE_DIR")
    program = "import ddf, os; print(os.environ['NUMBA_CACHE_DIR'])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=os.environ)
    assert Path(done.stdout.strip()) == folder


def test_without_a_home_to_write_to_the_next_process_finds_the_kernels_again(monkeypatch, tmp_path):
    """A file where a folder should be stops even root; the fallback is the same each time and nobody else's."""
    home = tmp_path / "home"
    home.write_text("")
    for name in ("DDF_CACHE_DIR", "NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, "")  # so that it is set back after the test
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = use_cache()
    assert folder is not None
    assert folder.parent.parent == tmp_path
    assert folder.parent.stat().st_mode & 0o777 == 0o700
    assert str(folder) in cache_note()
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    assert use_cache() == folder
    folder.parent.chmod(0o777)  # others may put code there
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    assert use_cache().parent != folder.parent


def test_without_any_folder_to_write_to_it_says_so(monkeypatch, tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv("DDF_CACHE_DIR", str(file / "cache"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.setattr(tempfile, "tempdir", str(file / "tmp"))
    assert use_cache() is None
    with pytest.raises(DdfError, match="DDF_CACHE_DIR"):
        warm_kernels()


def test_imports_over_several_lines_are_followed():
    found = IMPORT.findall("from ddf.a import b\nfrom ddf.c import (\n    d,\n    e,\n)\n")
    assert [module for module, _ in found] == ["ddf.a", "ddf.c"]
    assert PACKAGE / "model.py" in kernel_sources(PACKAGE)
