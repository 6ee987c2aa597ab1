"""The scripts that try to break ddf, for a short while."""

import importlib.util
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def _script(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / f"scripts/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_fuzzed_cases_are_refused_or_make_sense():
    counts, finds = _script("fuzz_cases").fuzz(seconds=4.0, seed=1, deep=False)
    assert not finds, finds[0]
    assert counts["refused"] > 50
    assert counts["accepted"] > 5


def test_the_fuzzer_sees_nonsense(tmp_path):
    """A case with a load path that goes nowhere is refused; one that raises what it must not is found."""
    fuzzer = _script("fuzz_cases")
    data = (ROOT / "cases/flat-stack.toml").read_bytes()
    assert fuzzer.judged(data, tmp_path, deep=False) == ("accepted", "")
    assert fuzzer.judged(data.replace(b"duration_s", b"duration"), tmp_path, deep=False) == ("refused", "")
    fuzzer.examine = lambda case: 1 / 0
    what, why = fuzzer.judged(data, tmp_path, deep=False)
    assert what == "found"
    assert "ZeroDivisionError" in why


def test_killed_runs_resume_to_the_same_bits(tmp_path):
    script = [sys.executable, ROOT / "scripts/kill_runs.py", "--kills", "3", "--seed", "2", "--folder", tmp_path]
    done = subprocess.run(script, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
