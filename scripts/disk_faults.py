"""Run out of disk, and meet a folder that cannot be written to, in the middle of a run; resume and compare bit for bit.

    python scripts/disk_faults.py [--folder DIR]

The disk is a small file system in memory, in a mount namespace of its own (Linux, as root or where users may make
them). Each fault must end the run with exit code 1, words instead of a traceback, and files that are whole; once there
is room again the resumed run must be the undisturbed one. Exit code 1 if it was not, 77 where there is no such disk.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from kill_runs import ROOT, TIMEOUT_S, command, differences, torn_files

INSIDE = "DDF_DISK_FAULTS"
SHARES = (0.0, 0.3, 0.8)  # of the frames, before something else fills the disk
FULL = re.compile("disk (is )?full")
ROOM = "size=64M"
SKIPPED = 77


def attempt(folder: Path, *options: str) -> tuple[int, str]:
    """Exit code and stderr of a run."""
    done = subprocess.run(
        command(folder, *options), cwd=ROOT, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    return done.returncode, done.stderr


def mount(*options: str) -> None:
    """Mount or change a file system."""
    subprocess.run(["mount", *options], check=True)


def judged(folder: Path, code: int, text: str, words: str | re.Pattern[str]) -> list[str]:
    """What is wrong with how a run ended that could not write."""
    found = torn_files(folder) if folder.is_dir() else []
    if code != 1 or not re.search(words, text) or "Traceback" in text:
        found.append(f"{words}: exit code {code}: {text[-2000:]}")
    print(f"  {next((line for line in text.splitlines() if line.startswith('ddf: ')), 'no message')}", flush=True)
    return found


def fill(disk: Path) -> Path:
    """Take all the room that is left."""
    ballast = disk / "ballast"
    with contextlib.suppress(OSError), ballast.open("wb", buffering=0) as stream:
        while True:
            stream.write(bytes(4096))
    return ballast


def full_disk(disk: Path, whole: Path, share: float) -> list[str]:
    """Faults of a run whose disk something else fills on the way, and of the same run once there is room."""
    mount("-t", "tmpfs", "-o", ROOM, "none", str(disk))
    try:
        run, frames = disk / "run", share * len(list(whole.glob("frames/*")))
        process = subprocess.Popen(command(run), cwd=ROOT, stderr=subprocess.PIPE, text=True)
        while process.poll() is None and not (run.is_dir() and len(list(run.glob("frames/*"))) >= frames):
            time.sleep(0.005)
        ballast = fill(disk)
        _, text = process.communicate(timeout=TIMEOUT_S)
        found = judged(run, process.returncode, text, FULL)
        code, text = attempt(run, "--resume")
        found += judged(run, code, text, FULL) if share else []
        ballast.unlink()
        return found + (_resumed(run, whole) if not found else [])
    finally:
        subprocess.run(["umount", disk], check=True)


def read_only(disk: Path, whole: Path) -> list[str]:
    """Faults of runs in a folder that cannot be written to, new and resumed."""
    mount("-t", "tmpfs", "-o", f"{ROOM},ro", "none", str(disk))
    try:
        run = disk / "run"
        found = judged(run, *attempt(run), "read-only")
        mount("-o", "remount,rw", str(disk))
        process = subprocess.Popen(command(run), cwd=ROOT, stderr=subprocess.DEVNULL)
        while process.poll() is None and not (run / "checkpoint.npz").exists():
            time.sleep(0.005)
        process.kill()
        process.wait()
        mount("-o", "remount,ro", str(disk))
        found += judged(run, *attempt(run, "--resume"), "read-only")
        mount("-o", "remount,rw", str(disk))
        return found + (_resumed(run, whole) if not found else [])
    finally:
        subprocess.run(["umount", disk], check=True)


def _resumed(run: Path, whole: Path) -> list[str]:
    code, text = attempt(run, "--resume")
    if code != 0:
        return [f"the resumed run ended with {code}: {text[-2000:]}"]
    return [f"{run}: differs: {name}" for name in differences(run, whole)]


def main() -> int:
    """Try every fault; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, help="where to run  [default: a temporary folder]")
    args = parser.parse_args()
    if INSIDE not in os.environ:
        namespace = ["unshare", "--mount"] if os.getuid() == 0 else ["unshare", "--mount", "--map-root-user"]
        if subprocess.run([*namespace, "true"], capture_output=True, check=False).returncode != 0:
            print("no mount namespace can be had here")
            return SKIPPED
        again = [*namespace, sys.executable, *sys.argv]
        return subprocess.run(again, env=os.environ | {INSIDE: "1"}, check=False).returncode
    with tempfile.TemporaryDirectory(prefix="ddf-disk-") as temporary:
        base = (args.folder or Path(temporary)).absolute()
        whole, disk = base / "whole", base / "disk"
        disk.mkdir(parents=True)
        code, text = attempt(whole)
        wrong = [] if code == 0 else [f"the undisturbed run ended with {code}: {text}"]
        for share in SHARES if code == 0 else ():
            print(f"a disk that is full after {100 * share:.0f} % of the frames", flush=True)
            wrong += full_disk(disk, whole, share)
        print("a read-only folder", flush=True)
        wrong += read_only(disk, whole) if code == 0 else []
    for fault in wrong:
        print(f"FAULT {fault}")
    print(f"{len(wrong)} faults")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
