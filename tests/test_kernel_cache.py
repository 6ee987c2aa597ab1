"""Where kernels are cached."""

import os
import subprocess
import sys
from pathlib import Path

from ddf.kernel_cache import IMPORT, kernel_sources, source_digest, use_cache

PACKAGE = Path(__file__).parents[1] / "ddf"


def test_a_process_started_by_ddf_uses_the_same_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("DDF_CACHE_DIR", str(tmp_path))
    folder = use_cache()
    assert folder == tmp_path / source_digest(PACKAGE)
    monkeypatch.delenv("DDF_CACHE_DIR")
    program = "import ddf, os; print(os.environ['NUMBA_CACHE_DIR'])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=os.environ)
    assert Path(done.stdout.strip()) == folder


def test_imports_over_several_lines_are_followed():
    found = IMPORT.findall("from ddf.a import b\nfrom ddf.c import (\n    d,\n    e,\n)\n")
    assert [module for module, _ in found] == ["ddf.a", "ddf.c"]
    assert PACKAGE / "model.py" in kernel_sources(PACKAGE)
