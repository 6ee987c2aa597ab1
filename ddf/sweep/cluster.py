"""Run a sweep's cases on a Dask cluster whose workers see the sweep's folder under the same path."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from pathlib import Path

from ddf.errors import UsageError
from ddf.output.checkpoint import CHECKPOINT
from ddf.output.folder import RunFolder
from ddf.sweep.manifest import FAILED, Outcome, SweepFolder
from ddf.sweep.process import CaseProcess

CONNECT_S = 20
LOOK_EVERY_S = 2.0


def run_on_cluster(
    address: str, folder: SweepFolder, todo: list[Outcome], threads: int, done: Callable[[Outcome], None],
    look: Callable[[], None],
) -> None:  # fmt: skip
    """Hand all cases to the cluster and pass on each one's outcome; `look` is called every few seconds.

    A case whose worker is lost goes to another (as often as Dask's allowed-failures says, 3) and on from its
    checkpoint. Raises UsageError where there is no Dask or no cluster.
    """
    try:
        from distributed import Client, wait
    except ImportError as error:
        raise UsageError("--scheduler needs Dask, which is not installed", "pip install 'ddf[cluster]'") from error
    try:
        client = Client(address, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise UsageError(f"no Dask scheduler answers at {address}: {error}") from error
    began = clock.perf_counter()
    with client:
        waiting = {}
        for outcome in todo:
            if outcome.state == FAILED:  # what it left is not to be gone on with
                RunFolder(folder.run_folder(outcome.name)).empty()
            paths = [str(path.resolve()) for path in (
                folder.case_file(outcome.name), folder.run_folder(outcome.name), folder.log_file(outcome.name)
            )]  # fmt: skip
            key = f"ddf-{outcome.name}-{clock.time_ns()}"
            future = client.submit(run_here, *paths, threads, key=key, pure=False)
            waiting[future] = outcome.name
        while waiting:
            try:
                ended = wait(list(waiting), timeout=LOOK_EVERY_S, return_when="FIRST_COMPLETED").done
            except TimeoutError:
                ended = set()
            for future in ended:
                name = waiting.pop(future)
                state, reason = (FAILED, str(future.exception())) if future.status == "error" else future.result()
                done(Outcome(name, state, reason, clock.perf_counter() - began))
            look()


def run_here(case_file: str, folder: str, log: str, threads: int) -> tuple[str, str]:
    """On a worker: run the case, from its checkpoint where there is one."""
    process = CaseProcess(Path(case_file), Path(folder), Path(log), threads, (Path(folder) / CHECKPOINT).exists())
    return process.follow()
