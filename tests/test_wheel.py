"""The wheel, installed apart from the source tree."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def test_an_installed_wheel_finds_what_is_shipped(tmp_path):
    """Built without an index; what ddf needs comes from this environment, ddf itself from the wheel."""
    pytest.importorskip("hatchling")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", tmp_path / "dist"]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    there = tmp_path / "a place ü"
    install = [sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--target", there, wheel]
    subprocess.run(install, check=True, capture_output=True)

    def said(*command):
        environment = os.environ | {"PYTHONPATH": str(there), "DDF_CACHE_DIR": str(tmp_path / "cache")}
        done = subprocess.run(
            [sys.executable, *command], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    listed = "*s.shipped_names('cases'), *s.shipped_names('meshes')"
    program = f"import ddf, ddf.shipped as s; print(ddf.__file__); print({listed})"
    file, names = said("-c", program).splitlines()
    assert Path(file).is_relative_to(there)
    shipped = {path.stem for path in [*ROOT.glob("cases/*.toml"), *ROOT.glob("meshes/*.step")]}
    assert set(names.split()) == shipped
    said("-m", "ddf", "init", "case.toml")
    plan = tmp_path / "sweep.toml"
    plan.write_text('case = "flat-stack"\nmethod = "grid"\n[vary]\n"friction.ply_diaphragm" = [0.1, 0.2]\n')
    assert "ply_diaphragm-0.2" in said("-m", "ddf", "sweep", "sweep.toml", "--list")
