"""A case in a process of its own, from its start to its end."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from ddf.output.atomic import write_errors
from ddf.sweep.manifest import FAILED, FINISHED, INTERRUPTED

LAST_WORDS = 300  # characters of a crashed process' log in its reason
LIBRARIES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class CaseProcess:
    """Runs `ddf.sweep.worker`; what it says beside its progress goes to a log file."""

    def __init__(self, case_file: Path, folder: Path, log: Path, threads: int, go_on: bool) -> None:
        self.log = log
        self.stopping = False
        how = "go-on" if go_on else "anew"
        command = [sys.executable, "-m", "ddf.sweep.worker", str(case_file), str(folder), str(threads), how]
        with write_errors(log):
            log.parent.mkdir(parents=True, exist_ok=True)
            with log.open("w", encoding="utf-8") as errors:
                self.process = subprocess.Popen(
                    command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors, text=True,
                    env=os.environ | dict.fromkeys(LIBRARIES, str(threads)),
                )  # fmt: skip

    def follow(self, told: Callable[[float], None] = lambda _: None) -> tuple[str, str]:
        """Wait for the end; its state and, where it failed, why. `told`: called with the share done, 0..1."""
        end: dict[str, Any] = {}
        assert self.process.stdout is not None
        for line in self.process.stdout:
            words = _words(line)
            if "steps" in words:
                told(words["step"] / max(words["steps"], 1))
            end = words if "end" in words else end
        code = self.process.wait()
        if self.process.stdin is not None:
            with suppress(OSError):
                self.process.stdin.close()
        if end.get("end") in (FINISHED, INTERRUPTED):
            return end["end"], ""
        if end:
            return FAILED, end["message"]
        if self.stopping:
            return INTERRUPTED, ""
        said = self.log.read_text(encoding="utf-8", errors="replace").strip()[-LAST_WORDS:]
        return FAILED, f"its process ended with code {code}" + (f": {said}" if said else "")

    def stop(self) -> None:
        """Ask the case to write its checkpoint and end."""
        self.stopping = True
        self.process.terminate()


def _words(line: str) -> dict[str, Any]:
    """A JSON line of a worker; empty for anything else that a library prints."""
    try:
        words = json.loads(line)
    except ValueError:
        return {}
    return words if isinstance(words, dict) else {}
