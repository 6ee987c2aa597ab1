"""Kill a small run at random moments, resume it, and hold what it leaves against a run that was left alone.

    python scripts/kill_runs.py [--kills 50] [--seed 0] [--folder DIR]

After each kill every file that is there must be whole; the finished run must be the undisturbed one bit for bit.
Exit code 1 if one was not.
"""

from __future__ import annotations

import argparse
import csv
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from ddf.output.results import open_run, read_vtu
from ddf.output.vtu import read_pvd

ROOT = Path(__file__).resolve().parent.parent
CASE = ROOT / "cases/tetrahedron-0-90-coarse.toml"
SMALL = (
    "plies.0.element_mm=12.5", "diaphragms.element_mm=14", "tool.fillet_mm=15", "process.stages.0.duration_s=0.004",
    "process.stages.1.duration_s=0.012", "process.stages.2.duration_s=0.004", "process.stages.3.duration_s=0.002",
    "output.frames_per_stage=6", "solver.energy_error_limit_percent=100", "output.pictures=false",
    "output.checkpoint_interval_s=0.1", "output.history_interval_steps=50",
)  # fmt: skip
SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM)
KILLS_A_RUN = 4
TIMEOUT_S = 300.0


def command(folder: Path, *options: str) -> list[str]:
    """The command of the run, as a user would give it."""
    settings = [part for item in SMALL for part in ("--set", item)]
    run = ["run", str(CASE), "-o", str(folder), "--quiet", "--threads", "1"]
    return [sys.executable, "-m", "ddf", *run, *settings, *options]


def torn_files(folder: Path) -> list[str]:
    """What is wrong with the files of a run that was killed; temporary ones do not count."""
    found = []
    for file in sorted(folder.rglob("*")):
        if file.is_dir() or file.name.startswith(".ddf-"):
            continue
        try:
            if file.suffix == ".npz":
                with np.load(file) as data:
                    _ = [data[name].sum() for name in data.files if data[name].dtype.kind == "f"]
            elif file.suffix == ".json":
                json.loads(file.read_text())
            elif file.suffix == ".pvd":
                for _, name in read_pvd(file):
                    read_vtu(folder / name)
            elif file.suffix == ".toml":
                assert file.read_text().strip()
        except Exception as error:
            found.append(f"{file}: {type(error).__name__}: {error}")
    return found


def differences(folder: Path, whole: Path) -> list[str]:
    """In what a finished run differs from the undisturbed one."""
    found = []
    with np.load(folder / "checkpoint.npz") as a, np.load(whole / "checkpoint.npz") as b:
        names = [name for name in b.files if name.startswith("state_")]
        found += [name for name in names if a[name].tobytes() != b[name].tobytes()]
    if _history(folder) != _history(whole):
        found.append("history.csv")
    one, other = open_run(folder), open_run(whole)
    if one.metrics != other.metrics:
        found.append("metrics.json")
    for pvd in sorted(whole.glob("*.pvd")):
        frames, wanted = read_pvd(folder / pvd.name), read_pvd(pvd)
        same = frames == wanted and all((folder / f).read_bytes() == (whole / f).read_bytes() for _, f in wanted)
        if not same:
            found.append(pvd.name)
    for name in ("wrinkles.csv", "profiles/ply-1.csv", "case.toml", "case.resolved.toml"):
        if (folder / name).read_bytes() != (whole / name).read_bytes():
            found.append(name)
    listed = {file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()}
    found += sorted(listed ^ {file.relative_to(whole).as_posix() for file in whole.rglob("*") if file.is_file()})
    return found


def _history(folder: Path) -> list[dict[str, str]]:
    with open(folder / "history.csv", newline="") as stream:
        return [{key: value for key, value in row.items() if key != "wall_s"} for row in csv.DictReader(stream)]


def killed_run(folder: Path, kills: int, lasts_s: float, chance: random.Random) -> list[str]:
    """Run, kill and resume up to `kills` times, then finish; returns what was wrong on the way."""
    found = []
    resumed = False
    for _ in range(kills):
        process = subprocess.Popen(command(folder, *["--resume"] * resumed), stderr=subprocess.PIPE, cwd=ROOT)
        number = chance.choice(SIGNALS)
        try:
            process.wait(chance.uniform(0.3, 1.05) * lasts_s)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        _, message = process.communicate(timeout=TIMEOUT_S)
        code, text = process.returncode, message.decode(errors="replace")
        found += torn_files(folder)
        # Python itself ends by SIGINT, 130 to a shell, where that broke off an import
        allowed = (0, -signal.SIGKILL) if number == signal.SIGKILL else (0, 130, -signal.SIGINT)
        # before ddf has taken SIGTERM over, and once it is done and Python is closing down, the system ends it
        outside = code == -signal.SIGTERM and (not text or finished(folder))
        if (code not in allowed and not outside) or "Traceback" in text:
            found.append(f"signal {number.name}: exit code {code}: {text[-2000:]}")
        if code == 130 and (folder / "checkpoint.npz").exists() and "--resume" not in text:
            found.append(f"signal {number.name}: does not say how to go on: {text}")
        print(f"  {number.name:8} exit code {code:4}  {_place(folder)}", flush=True)
        resumed = folder.is_dir() and any(folder.iterdir())
        if code == 0:
            break
    done = subprocess.run(
        command(folder, *["--resume"] * resumed), cwd=ROOT, capture_output=True, timeout=TIMEOUT_S, check=False
    )
    if done.returncode != 0:
        found.append(f"the resumed run ended with {done.returncode}: {done.stderr.decode()[-2000:]}")
    return found


def finished(folder: Path) -> bool:
    """Whether the run in a folder says that it came to its end."""
    info = folder / "run.json"
    return info.is_file() and json.loads(info.read_text())["stop_reason"] == "finished"


def _place(folder: Path) -> str:
    try:
        with np.load(folder / "checkpoint.npz") as data:
            return f"checkpoint of step {int(data['step'])}"
    except OSError:
        return "no checkpoint"


def main() -> int:
    """Kill runs until enough have been killed; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, help="where to run  [default: a temporary folder]")
    args = parser.parse_args()
    chance = random.Random(args.seed)
    with tempfile.TemporaryDirectory(prefix="ddf-kill-") as temporary:
        base = args.folder or Path(temporary)
        whole = base / "whole"
        began = time.perf_counter()
        subprocess.run(command(whole), check=True, cwd=ROOT, timeout=TIMEOUT_S)
        lasts = time.perf_counter() - began
        began = time.perf_counter()
        subprocess.run(command(base / "again"), check=True, cwd=ROOT, timeout=TIMEOUT_S)  # now with compiled kernels
        lasts = min(lasts, time.perf_counter() - began)
        wrong = differences(base / "again", whole)
        done = number = 0
        while done < args.kills:
            number += 1
            folder, kills = base / f"run-{number}", min(chance.randint(1, KILLS_A_RUN), args.kills - done)
            print(f"run {number}", flush=True)
            faults = killed_run(folder, kills, lasts, chance)
            faults += [] if faults else [f"{folder}: differs: {name}" for name in differences(folder, whole)]
            for fault in faults:
                print(f"FAULT {fault}", flush=True)
            wrong += faults
            done += kills
    print(f"{done} kills in {number} runs of {lasts:.1f} s each: {len(wrong)} faults")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
