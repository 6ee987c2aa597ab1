"""Run a case: prepare the folder and the scene, run the loop, end."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from ddf.case import Case, resolved_toml
from ddf.case.load import Source
from ddf.errors import UnstableError
from ddf.fidelity import choose
from ddf.kernel_cache import cache_note, warm_kernels
from ddf.net_run import run_net
from ddf.output.checkpoint import CHECKPOINT, load_checkpoint
from ddf.output.folder import RunFolder
from ddf.output.lock import folder_lock
from ddf.output.log import run_log
from ddf.plausible import prepare
from ddf.run.ending import finish, write_info
from ddf.run.interrupt import Interrupt
from ddf.run.loop import Runner
from ddf.run.progress import Progress, RunResult, Stopwatch
from ddf.scene import Scene


def default_threads() -> int:
    """As many threads as this process may use processors, at most 8."""
    return min(8, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


def run_case(
    case: Case,
    folder: str | Path,
    *,
    case_text: str | None = None,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    report: Callable[[Progress], None] | None = None,
    source: Source | None = None,
    warn: Callable[[str], None] | None = None,
    compiled: bool = False,
) -> RunResult:
    """Run a case into a folder and return how it ended.

    Raises CaseError, MeshError, UsageError before anything in the folder is changed, UnstableError when a guard
    stops the run (all output so far and the last good checkpoint are kept). On SIGINT or SIGTERM a checkpoint is
    written and stop_reason is "interrupted"; before the first step, and on a second signal, KeyboardInterrupt is
    raised. `resume=True` goes on, bit for bit as if nothing had happened.
    Warnings about the case go to `warn`; its problems are placed by `source`. `compiled` says that kernels need not
    be compiled beforehand. A case of the model "kinematic" is draped as a net instead (`net_run`), in one go. Of a case
    whose fidelity is "auto" the rung is chosen first (`fidelity`).
    """
    count = threads or case.solver.threads or default_threads()
    choice, asked = None, case_text if case_text is not None else resolved_toml(case)
    if case.fidelity == "auto":
        choice = choose(case, count, Path(folder) if resume else None)
        case = choice.case
        if warn is not None:
            warn("\n".join(choice.lines()))
    if case.model == "kinematic":
        chosen = {} if choice is None else {"fidelity": choice.record()}
        notes = [] if choice is None else choice.lines()[:1]
        net = run_net(case, folder, case_text=asked, replace=force or resume, notes=notes, more=chosen)
        return RunResult(Path(folder), "finished", 0, 0.0, net.wall_s, plies=net.plies, notes=net.notes)
    watch, warnings = Stopwatch(), [f"note: {note}"] if (note := cache_note()) else list[str]()
    with Interrupt() as interrupt:
        RunFolder(folder).refuse(force=force, resume=resume)
        if not compiled:
            with watch("compile"):
                warm_kernels(warn)
        interrupt.noting = True
        with watch("mesh"):
            scene = prepare(case, source, warnings.append, None if resume else _existing(Path(folder)))
        if interrupt.caught:
            raise KeyboardInterrupt
        for text in warnings:
            if warn is not None:
                warn(text)
        out = RunFolder.create(folder, force=True, resume=True)
        with folder_lock(out.path):
            again = _make_ready(out, scene, resume, force)
            with run_log(out) as log:
                log.info("%s: %s on %d threads", "resumed" if again else "started", case.title or "no title", count)
                for text in warnings:
                    log.warning("%s", text.removeprefix("warning: "))
                for line in choice.lines() if choice is not None else ():
                    log.info("%s", line)
                runner = Runner(scene, out, count, watch, report, log, choice)
                return _run(runner, asked, again, interrupt)


def _make_ready(out: RunFolder, scene: Scene, resume: bool, force: bool) -> bool:
    """Clear the folder of an earlier run that is not gone on with; returns whether there is a checkpoint to go on from.

    Raises UsageError where there is nothing to resume.
    """
    again = resume and (out / CHECKPOINT).exists()
    if force or (resume and out.started and not again):  # stopped before its first checkpoint: start anew
        out.empty()
    elif resume and not again:
        load_checkpoint(out, scene)  # says that there is nothing to resume
    return again


def _existing(path: Path) -> Path:
    """The nearest folder that is there."""
    path = path.absolute()
    return next(place for place in (path, *path.parents) if place.is_dir())


def _run(runner: Runner, case_text: str, again: bool, interrupt: Interrupt) -> RunResult:
    """Run from the start or the checkpoint to the end, a signal or a guard."""
    try:
        if again:
            runner.resume()
        runner.out.write_text("case.resolved.toml", resolved_toml(runner.scene.case))
        runner.out.write_text("case.toml", case_text)
        reason = runner.loop(interrupt)
    except UnstableError as error:
        runner.keep_last_good()
        write_info(runner, "unstable", str(error))
        raise
    finally:
        runner.close()
    return finish(runner, reason)
