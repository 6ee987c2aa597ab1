"""Run a sweep's cases in local processes, several at once, and keep account of how each stands."""

from __future__ import annotations

import os
import signal
import threading
import time as clock
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from ddf.sweep.cluster import run_on_cluster
from ddf.sweep.manifest import FAILED, FINISHED, INTERRUPTED, Entry, Outcome, SweepFolder
from ddf.sweep.plan import Plan
from ddf.sweep.process import CaseProcess

TELL_EVERY_S = 2.0
MOST_THREADS = 8  # of a case, as `ddf run` takes by default


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
        self._processes: dict[str, CaseProcess] = {}
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
        self._note(Outcome(name, state, reason, clock.perf_counter() - began))

    def _process(self, name: str, threads: int) -> tuple[str, str]:
        """Run a case's process to its end; its state and, where it failed, why."""
        place, go_on = self.folder, self.outcomes[name].state == INTERRUPTED
        process = CaseProcess(place.case_file(name), place.run_folder(name), place.log_file(name), threads, go_on)
        with self._lock:
            self._processes[name] = process
            self.shares[name] = 0.0

        def told(share: float) -> None:
            self._warm.set()
            self.shares[name] = share

        try:
            return process.follow(told)
        finally:
            with self._lock:
                self._processes.pop(name)

    def run_on_cluster(self, address: str, plan: Plan, report: Callable[[SweepProgress], None] | None = None) -> None:
        """Run all that is to do on a Dask cluster. Raises UsageError where there is none."""
        todo = [self.outcomes[name] for name in self.to_do()]
        began = clock.perf_counter()
        for outcome in todo:
            self.shares[outcome.name] = 0.0

        def look() -> None:
            if report is not None:
                report(self._progress(clock.perf_counter() - began))

        run_on_cluster(address, self.folder, todo, plan.threads or 1, self._note, look)

    def _note(self, outcome: Outcome) -> None:
        with self._lock:
            self.shares.pop(outcome.name, None)
            self.outcomes[outcome.name] = outcome
            self.folder.write_outcomes(self.outcomes)

    def _stop(self) -> None:
        """Ask all cases to write a checkpoint and end."""
        self._stopping = True
        self._warm.set()
        with self._lock:
            for process in self._processes.values():
                process.stop()

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
