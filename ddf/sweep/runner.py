"""Run a sweep's cases in local processes, several at once, and keep account of how each stands."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time as clock
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from ddf.output.atomic import write_errors
from ddf.sweep.manifest import FAILED, FINISHED, INTERRUPTED, Entry, Outcome, SweepFolder
from ddf.sweep.plan import Plan

TELL_EVERY_S = 2.0
MOST_THREADS = 8  # of a case, as `ddf run` takes by default
LAST_WORDS = 300  # characters of a crashed process' log in its reason


@dataclass(frozen=True)
class SweepProgress:
    """How a sweep stands."""

    cases: int
    finished: int
    failed: int
    running: dict[str, float]  # share done of each case that runs, 0..1
    elapsed_s: float


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_out(cases: int, workers: int | None, threads: int | None, available: int) -> tuple[int, int]:
    """Cases at once and threads of each: all cores in use and no more, unless more is asked for."""
    if workers is None:
        workers = max(1, available // (threads or 1))
    workers = max(1, min(workers, cases))
    return workers, threads or max(1, min(MOST_THREADS, available // workers))


class Runner:
    """Runs what is to do. The first process goes ahead alone until it steps: it compiles the kernels for all."""

    def __init__(self, folder: SweepFolder, entries: list[Entry]) -> None:
        self.folder = folder
        self.outcomes = {entry.name: folder.standing(entry) for entry in entries}
        self.entries = {entry.name: entry for entry in entries}
        self.shares: dict[str, float] = {}
        self._processes: dict[str, subprocess.Popen[str]] = {}
        self._lock = threading.Lock()
        self._warm = threading.Event()
        self._stopping = False

    def to_do(self) -> list[str]:
        """Cases that have not finished."""
        return [name for name, outcome in self.outcomes.items() if outcome.state != FINISHED]

    def run(self, plan: Plan, report: Callable[[SweepProgress], None] | None = None) -> None:
        """Run all that is to do; on KeyboardInterrupt the cases write their checkpoints, and it goes on its way."""
        todo = self.to_do()
        if not todo:
            return
        began = clock.perf_counter()
        workers, threads = share_out(len(todo), plan.workers, plan.threads, cores())
        with _interruptible(), ThreadPoolExecutor(workers) as pool:
            waiting: set[Future[None]] = {
                pool.submit(self._one, name, threads, number == 0) for number, name in enumerate(todo)
            }
            try:
                while waiting:
                    done, waiting = wait(waiting, TELL_EVERY_S, FIRST_COMPLETED)
                    for future in done:
                        future.result()
                    if report is not None:
                        report(self._progress(clock.perf_counter() - began))
            except BaseException:
                self._stop()
                raise

    def _one(self, name: str, threads: int, first: bool) -> None:
        if not first:
            self._warm.wait()
        if self._stopping:
            return
        began = clock.perf_counter()
        state, reason = self._process(name, threads)
        self._warm.set()
        with self._lock:
            self.shares.pop(name, None)
            self.outcomes[name] = Outcome(name, state, reason, clock.perf_counter() - began)
            self.folder.write_outcomes(self.outcomes)

    def _process(self, name: str, threads: int) -> tuple[str, str]:
        """Run a case's process to its end; its state and, where it failed, why."""
        how = "go-on" if self.outcomes[name].state == INTERRUPTED else "anew"
        log = self.folder.log_file(name)
        with write_errors(log):
            log.parent.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, "-m", "ddf.sweep.worker", str(self.folder.case_file(name)),
                   str(self.folder.run_folder(name)), str(threads), how]  # fmt: skip
        limits = {key: str(threads) for key in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
        end: dict[str, Any] = {}
        with log.open("w", encoding="utf-8") as errors:
            process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors, text=True,
                env=os.environ | limits,
            )  # fmt: skip
            with self._lock:
                self._processes[name] = process
                self.shares[name] = 0.0
            assert process.stdout is not None
            for line in process.stdout:
                words = _words(line)
                if "steps" in words:
                    self._warm.set()
                    self.shares[name] = words["step"] / max(words["steps"], 1)
                end = words if "end" in words else end
            code = process.wait()
            if process.stdin is not None:
                with suppress(OSError):
                    process.stdin.close()
        with self._lock:
            self._processes.pop(name)
        if end.get("end") in (FINISHED, INTERRUPTED):
            return end["end"], ""
        if end:
            return FAILED, end["message"]
        if self._stopping:
            return INTERRUPTED, ""
        said = log.read_text(encoding="utf-8", errors="replace").strip()[-LAST_WORDS:]
        return FAILED, f"its process ended with code {code}" + (f": {said}" if said else "")

    def _stop(self) -> None:
        """Ask all cases to write a checkpoint and end."""
        self._stopping = True
        self._warm.set()
        with self._lock:
            for process in self._processes.values():
                process.terminate()

    def _progress(self, elapsed: float) -> SweepProgress:
        with self._lock:
            states = [outcome.state for outcome in self.outcomes.values()]
            # a failed case that runs again counts as running
            running = dict(self.shares)
            failed = sum(o.state == FAILED and name not in running for name, o in self.outcomes.items())
            return SweepProgress(len(states), states.count(FINISHED), failed, running, elapsed)


@contextmanager
def _interruptible() -> Iterator[None]:
    """SIGINT and SIGTERM as KeyboardInterrupt, also where the shell had SIGINT ignored (a job in the background)."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    old: dict[int, Any] = {}
    with suppress(ValueError):  # not in the main thread: leave signals alone
        for number in (signal.SIGINT, signal.SIGTERM):
            old[number] = signal.signal(number, stop)
    try:
        yield
    finally:
        for caught, handler in old.items():
            signal.signal(caught, handler)


def _words(line: str) -> dict[str, Any]:
    """A JSON line of a worker; empty for anything else that a library prints."""
    try:
        words = json.loads(line)
    except ValueError:
        return {}
    return words if isinstance(words, dict) else {}
