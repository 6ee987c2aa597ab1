"""Run a case: advance to the next event, observe, write; stop with a reason.

Observers never change physics. Batches of steps end at multiples of `solver.check_interval_steps`, in a run
that is resumed as in one that is not; everything that is written is written at the end of a batch.
"""

from __future__ import annotations

import os
import signal
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from logging import Logger
from pathlib import Path
from typing import Any

import numpy as np

from ddf.case import Case, resolved_toml
from ddf.case.load import Source
from ddf.errors import UnstableError
from ddf.kernel_cache import warm_kernels
from ddf.monitors.audit import Check
from ddf.monitors.energy import Energies, energies
from ddf.monitors.stability import check_state
from ddf.net_run import run_net
from ddf.output.checkpoint import CHECKPOINT, load_checkpoint, save_checkpoint
from ddf.output.folder import RunFolder
from ddf.output.lock import folder_lock
from ddf.output.log import run_log
from ddf.output.snapshot import take_snapshot
from ddf.output.tables import HistoryWriter
from ddf.output.vtu import FrameWriter
from ddf.plausible import prepare
from ddf.postprocess import finish_folder, report_of
from ddf.provenance import provenance
from ddf.scene import Scene
from ddf.simulate import Simulation

REPORT_EVERY_S = 1.0
"""Wall time between two progress reports [s]."""

WORK_WORTH_MENTIONING = 1.0e4
"""Energy errors are judged against at least this much work [N mm] (10 J)."""


@dataclass
class Progress:
    """What a run tells while it goes on."""

    stage: str
    step: int
    steps: int
    time_s: float
    step_s: float
    energy_error_percent: float
    kinetic_percent: float
    elapsed_s: float
    remaining_s: float

    def __str__(self) -> str:
        return (
            f"{self.stage:>16}  {self.time_s:8.5f} s  step {self.step}/{self.steps}  dt {self.step_s:.2e} s  "
            f"energy error {self.energy_error_percent:+.2f} %  kinetic/internal {self.kinetic_percent:.2g} %  "
            f"elapsed {self.elapsed_s:.0f} s  left {self.remaining_s:.0f} s"
        )


@dataclass
class RunResult:
    """How a run ended."""

    folder: Path
    stop_reason: str  # "finished" or "interrupted"
    step: int
    time_s: float
    wall_s: dict[str, float]
    checks: list[Check] = field(default_factory=list)
    plies: list[dict[str, Any]] = field(default_factory=list)  # metrics, bottom ply first
    notes: list[str] = field(default_factory=list)


class _Stopwatch:
    """Wall time by phase."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, phase: str) -> Iterator[None]:
        start = clock.perf_counter()
        try:
            yield
        finally:
            self.seconds[phase] = self.seconds.get(phase, 0.0) + clock.perf_counter() - start


class _Interrupt:
    """SIGINT and SIGTERM: while `noting`, the first is only noted; else, and from the second on, KeyboardInterrupt.

    Compilers and meshers do not survive an exception out of nowhere: while they work signals are noted.
    """

    def __init__(self) -> None:
        self.noting = False
        self.caught = False
        self._old: dict[int, Any] = {}

    def __enter__(self) -> _Interrupt:
        for number in (signal.SIGINT, signal.SIGTERM):
            try:
                self._old[number] = signal.signal(number, self._note)
            except ValueError:  # not in the main thread: leave signals alone
                return self
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._old.items():
            signal.signal(number, handler)

    def _note(self, *_: object) -> None:
        if self.caught or not self.noting:
            raise KeyboardInterrupt
        self.caught = True


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
    be compiled beforehand. A case of the model "kinematic" is draped as a net instead (`net_run`), in one go.
    """
    if case.model == "kinematic":
        net = run_net(case, folder, case_text=case_text, replace=force or resume)
        return RunResult(Path(folder), "finished", 0, 0.0, net.wall_s, plies=net.plies, notes=net.notes)
    watch, warnings = _Stopwatch(), list[str]()
    with _Interrupt() as interrupt:
        RunFolder(folder).refuse(force=force, resume=resume)
        if not compiled:
            with watch("compile"):
                warm_kernels()
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
            again = resume and (out / CHECKPOINT).exists()
            if force or (resume and out.started and not again):  # stopped before its first checkpoint: start anew
                out.empty()
            elif resume and not again:
                load_checkpoint(out, scene)  # says that there is nothing to resume
            with run_log(out) as log:
                count = threads or case.solver.threads or default_threads()
                log.info("%s: %s on %d threads", "resumed" if again else "started", case.title or "no title", count)
                for text in warnings:
                    log.warning("%s", text.removeprefix("warning: "))
                runner = _Runner(scene, out, count, watch, report, log)
                text = case_text if case_text is not None else resolved_toml(case)
                return _run(runner, text, again, interrupt)


def _existing(path: Path) -> Path:
    """The nearest folder that is there."""
    path = path.absolute()
    return next(place for place in (path, *path.parents) if place.is_dir())


def _run(runner: _Runner, case_text: str, again: bool, interrupt: _Interrupt) -> RunResult:
    """Run from the start or the checkpoint to the end, a signal or a guard."""
    scene, out, watch = runner.scene, runner.out, runner.watch
    try:
        if again:
            runner.resume()
        out.write_text("case.resolved.toml", resolved_toml(scene.case))
        out.write_text("case.toml", case_text)
        reason = runner.loop(interrupt)
    except UnstableError as error:
        runner.write_info("unstable", str(error))
        raise
    finally:
        runner.close()
    result = RunResult(out.path, reason, runner.sim.step, runner.sim.time, watch.seconds)
    if reason == "finished":
        with watch("post-processing"):
            result.checks, result.plies = finish_folder(scene, out, runner.energy, runner.sim.time, result.notes)
    runner.write_info(reason, "", result.checks)
    if reason == "finished":
        report_of(scene, out, result.notes)
    runner.sum_up(result)
    return result


class _Runner:
    """The loop and what observes it."""

    def __init__(
        self,
        scene: Scene,
        out: RunFolder,
        threads: int,
        watch: _Stopwatch,
        report: Callable[[Progress], None] | None,
        log: Logger,
    ) -> None:
        self.scene, self.out, self.threads, self.watch, self.report = scene, out, threads, watch, report
        self.log = log
        self.start_x = scene.state.x.copy()
        self.sim = Simulation(scene, threads)
        self.names = [sheet.name for sheet in scene.sheets]
        self.frames = FrameWriter(out, scene) if scene.case.output.vtu else None
        self.frame_times = _frame_times(scene)
        self.frames_done = 0
        self.energy: Energies = energies(scene.model, scene.state)
        self.earlier_wall = 0.0
        self.history: HistoryWriter | None = None

    def resume(self) -> None:
        """Go back to the folder's checkpoint."""
        extra = load_checkpoint(self.out, self.scene)
        self.out.sweep()
        self.frames_done = int(extra["frames_done"])
        self.earlier_wall = float(extra["wall_s"])
        self.sim.recount()
        self.energy = energies(self.scene.model, self.scene.state)
        self.history = HistoryWriter(self.out, self.names, self.sim.step)
        if self.frames is not None:
            self.frames.prune(self.sim.time)

    def loop(self, interrupt: _Interrupt) -> str:
        """Advance to the end of the process; returns the reason for stopping."""
        steps, interval = self.scene.steps, self.scene.case.solver.check_interval_steps
        began = last_report = clock.perf_counter()
        first_step = self.sim.step
        if self.history is None:
            self.history = HistoryWriter(self.out, self.names)
            self._observe(began)
        with self.watch("compile"):
            self._compile()
        if self.sim.step == 0:
            self._checkpoint(0.0)
        began = last_checkpoint = clock.perf_counter()
        while self.sim.step < steps:
            with self.watch("steps"):
                self.sim.advance(min(interval - self.sim.step % interval, steps - self.sim.step))
            self._guard()
            with self.watch("output"):
                self._observe(began)
            now = clock.perf_counter()
            if now - last_report > REPORT_EVERY_S or self.sim.step == steps:
                last_report = now
                progress = self._progress(began, first_step)
                self.log.info("%s", progress)
                if self.report is not None:
                    self.report(progress)
            due = now - last_checkpoint > self.scene.case.output.checkpoint_interval_s
            if interrupt.caught or due or self.sim.step == steps:
                with self.watch("output"):
                    self._checkpoint(now - began)
                last_checkpoint = now
            if interrupt.caught and self.sim.step < steps:
                return "interrupted"
        return "finished"

    def _compile(self) -> None:
        """Compile (or load) the kernels on a copy of nothing: zero steps."""
        self.sim.advance(0)

    def _guard(self) -> None:
        """Stop a run that has gone wrong."""
        sim = self.sim
        alarm = check_state(self.scene.model, self.scene.state, self.names, self.start_x)
        if alarm is not None:
            raise UnstableError(f"step {sim.step}, process time {sim.time:.6f} s: {alarm}", self._kept())

    def _kept(self) -> str:
        return f"output up to the last frame and checkpoint is in {self.out.path}"

    def _observe(self, began: float) -> None:
        """History, energy guard and frames that are due."""
        sim, output, scene = self.sim, self.scene.case.output, self.scene
        last = sim.step == scene.steps
        interval = scene.case.solver.check_interval_steps
        if sim.step % max(output.history_interval_steps, interval) < interval or last:
            self.energy = energies(scene.model, scene.state)
            wall = self.earlier_wall + clock.perf_counter() - began
            assert self.history is not None
            self.history.append(
                sim.step, sim.time, self._stage(), scene.path.at(sim.time), self.energy, scene.model.dt, wall
            )
            self._guard_energy()
        while self.frames_done < len(self.frame_times) and sim.time >= self.frame_times[self.frames_done] - 1e-12:
            if self.frames is not None:
                self.frames.write(take_snapshot(scene, scene.state))
            self.frames_done += 1

    def _guard_energy(self) -> None:
        energy, limit = self.energy, self.scene.case.solver.energy_error_limit_percent
        error = 100 * energy.error / max(abs(energy.total_work), WORK_WORTH_MENTIONING)
        if not abs(error) <= limit:
            raise UnstableError(
                f"step {self.sim.step}, process time {self.sim.time:.6f} s: energy error of {error:.1f} % of the "
                f"work done, over solver.energy_error_limit_percent = {limit:g}",
                f"try a smaller solver.step_safety; {self._kept()}",
            )

    def _checkpoint(self, wall: float) -> None:
        extra = {"frames_done": self.frames_done, "wall_s": self.earlier_wall + wall}
        save_checkpoint(self.out, self.scene, self.scene.state, extra)

    def _stage(self) -> str:
        path = self.scene.path
        return path.names[int(path.stage(self.sim.time))]

    def _progress(self, began: float, first_step: int) -> Progress:
        elapsed = clock.perf_counter() - began
        done = max(1, self.sim.step - first_step)
        left = elapsed / done * (self.scene.steps - self.sim.step)
        energy = self.energy
        error = 100 * energy.error / max(abs(energy.total_work), WORK_WORTH_MENTIONING)
        return Progress(
            self._stage(), self.sim.step, self.scene.steps, self.sim.time, self.scene.model.dt, error,
            100 * energy.kinetic_share(), elapsed, left,
        )  # fmt: skip

    def write_info(self, reason: str, message: str, checks: list[Check] | None = None) -> None:
        """run.json: where it came from, how long it took, how it ended."""
        model = self.scene.model
        info = provenance() | {
            "case": self.scene.case.title,
            "threads": self.threads,
            "stop_reason": reason,
            "message": message,
            "step": self.sim.step,
            "steps": self.scene.steps,
            "process_time_s": self.sim.time,
            "step_s": model.dt,
            "step_limit_s": self.scene.step_limit,
            "wall_s": {key: round(value, 3) for key, value in self.watch.seconds.items()},
            "mesh": mesh_summary(self.scene),
            "audit": checks or [],
        }
        self.out.write_json("run.json", info)

    def sum_up(self, result: RunResult) -> None:
        """The log's last lines: checks that failed, what is missing, how the run ended."""
        for check in result.checks:
            if not check["ok"]:
                self.log.warning("%s: %.3g %s (limit %g)", *(check[key] for key in ("name", "value", "unit", "limit")))
        for note in result.notes:
            self.log.warning("%s", note)
        wall = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result.wall_s.items())
        self.log.info("%s at %.6g s, step %d; wall time: %s", result.stop_reason, result.time_s, result.step, wall)

    def close(self) -> None:
        """End the solver's threads."""
        self.sim.close()


def mesh_summary(scene: Scene) -> dict[str, Any]:
    """Sheets and their grids, with added mass, for people and run.json."""
    sheets = {}
    for info, sheet in zip(scene.sheets, scene.model.sheets, strict=True):
        sheets[info.name] = {
            "rows": int(sheet["rows"]),
            "cols": int(sheet["cols"]),
            "mass_g": info.true_mass * 1e6,
            "added_mass_g": info.added_mass * 1e6,
        }
    return {"sheets": sheets, "contact_nodes": int(np.count_nonzero(scene.model.exposed))}


def _frame_times(scene: Scene) -> list[float]:
    """Process times of the frames: the start, then `frames_per_stage` evenly in each stage."""
    count = scene.case.output.frames_per_stage
    edges = scene.path.time
    times = [0.0]
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        times += [float(a + (b - a) * (k + 1) / count) for k in range(count)]
    times[-1] = (scene.steps - 0.5) * scene.model.dt
    return times
