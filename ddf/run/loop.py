"""The loop of a run: advance to the next event, observe, write; stop with a reason.

Observers never change physics. Batches of steps end at multiples of `solver.check_interval_steps`, in a run
that is resumed as in one that is not; everything that is written is written at the end of a batch.

Where a guard finds that the solver has lost its hold, the run goes back to its last good state and on with a smaller
step, `solver.step_cuts` times at most, and says so. (That state is a few hundred steps old. A run that was interrupted
since goes back to where it was resumed: only there do a resumed run and one that was not differ.)
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import replace
from logging import Logger
from typing import Any

import numpy as np

from ddf.errors import UnstableError
from ddf.fidelity import Choice
from ddf.model import State
from ddf.monitors.energy import Energies, energies
from ddf.monitors.passage import check_passage
from ddf.monitors.stability import check_state
from ddf.output.checkpoint import load_checkpoint, save_checkpoint
from ddf.output.folder import RunFolder
from ddf.output.snapshot import take_snapshot
from ddf.output.tables import HistoryWriter
from ddf.output.vtu import FrameWriter
from ddf.run.interrupt import Interrupt
from ddf.run.progress import Progress, Stopwatch
from ddf.scene import Scene
from ddf.simulate import Simulation

REPORT_EVERY_S = 1.0
"""Wall time between two progress reports [s]."""

REMEMBERED = 4
"""Checks between two copies of a good state: copying takes a few percent of the time of one check's steps."""


STEP_CUT = 0.7
"""What is left of the step where it is cut."""


class Runner:
    """The loop and what observes it."""

    def __init__(
        self,
        scene: Scene,
        out: RunFolder,
        threads: int,
        watch: Stopwatch,
        report: Callable[[Progress], None] | None,
        log: Logger,
        choice: Choice | None = None,
    ) -> None:
        self.scene, self.out, self.threads, self.watch, self.report = scene, out, threads, watch, report
        self.log, self.choice = log, choice
        self.start_x = scene.state.x.copy()
        self.sim = Simulation(scene, threads)
        self.names = [sheet.name for sheet in scene.sheets]
        self.frames = FrameWriter(out, scene.whole()) if scene.case.output.vtu else None
        self.frame_times = _frame_times(scene)
        self.frames_done = 0
        self.steps = scene.steps
        self.energy: Energies = self._energies()
        self.earlier_wall = 0.0
        self.history: HistoryWriter | None = None
        self.good = State(*(array.copy() for array in scene.state))  # the last state that all guards have passed
        self.good_frames, self.saved_step = 0, -1
        self.cuts: list[dict[str, Any]] = []

    def resume(self) -> None:
        """Go back to the folder's checkpoint."""
        extra = load_checkpoint(self.out, self.scene)
        self.out.sweep()
        self.cuts = list(extra.get("cuts", []))
        self._use_step(float(extra["step_s"]))
        self.frames_done = int(extra["frames_done"])
        self.earlier_wall = float(extra["wall_s"])
        self.watch.seconds["steps"] = float(extra.get("steps_s", 0.0))
        self.saved_step = self.sim.step
        self._go_on()
        self._remember()

    def _use_step(self, step_s: float) -> None:
        """Go on with steps of this length [s]."""
        if step_s != self.scene.model.dt:
            self.scene = replace(self.scene, model=self.scene.model._replace(dt=step_s))
            self.sim.close()
            self.sim = Simulation(self.scene, self.threads)

    def _go_on(self) -> None:
        """Take the state as it is now for the run's, and drop what was written of a later one."""
        self.sim.recount()
        self.steps = self.scene.steps
        self.frame_times = _frame_times(self.scene)
        self.energy = self._energies()
        self.history = HistoryWriter(self.out, self.names, self.sim.step)
        self._end_if_settled()
        if self.frames is not None:
            self.frames.prune(self.sim.time)

    def loop(self, interrupt: Interrupt) -> str:
        """Advance to the end of the process; returns the reason for stopping."""
        interval = self.scene.case.solver.check_interval_steps
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
        while self.sim.step < self.steps:
            with self.watch("steps"):
                self.sim.advance(min(interval - self.sim.step % interval, self.steps - self.sim.step))
            try:
                self._guard()
                with self.watch("output"):
                    self._observe(began)
            except UnstableError as error:
                if not error.smaller_step or len(self.cuts) >= self.scene.case.solver.step_cuts:
                    raise
                self._cut_step(error)
                continue
            if self.sim.step // interval % REMEMBERED == 0:
                self._remember()
            now = clock.perf_counter()
            if now - last_report > REPORT_EVERY_S or self.sim.step == self.steps:
                last_report = now
                progress = self._progress(began, first_step)
                self.log.info("%s", progress)
                if self.report is not None:
                    self.report(progress)
            due = now - last_checkpoint > self.scene.case.output.checkpoint_interval_s
            if interrupt.caught or due or self.sim.step == self.steps:
                with self.watch("output"):
                    self._checkpoint(now - began)
                last_checkpoint = now
            if interrupt.caught and self.sim.step < self.steps:
                return "interrupted"
        return "finished"

    def _compile(self) -> None:
        """Compile (or load) the kernels on a copy of nothing: zero steps."""
        self.sim.advance(0)

    def _guard(self) -> None:
        """Stop a run that has gone wrong."""
        sim = self.sim
        lost = check_state(self.scene.model, self.scene.state, self.names, self.start_x)
        alarm = lost or check_passage(self.scene, sim.time)
        if alarm is not None:
            text = f"step {sim.step}, process time {sim.time:.6f} s: {alarm}"
            raise UnstableError(text, self._kept(), smaller_step=lost is not None)

    def _remember(self) -> None:
        """Keep a copy of a state that has passed all guards."""
        for kept, array in zip(self.good, self.scene.state, strict=True):
            np.copyto(kept, array)
        self.good_frames = self.frames_done

    def _cut_step(self, error: UnstableError) -> None:
        """Go back to the last good state and on with a smaller step."""
        for array, kept in zip(self.scene.state, self.good, strict=True):
            np.copyto(array, kept)
        self.scene.state.clock[2:4] = self.scene.state.clock[:2]
        self.frames_done = self.good_frames
        self._use_step(STEP_CUT * self.scene.model.dt)
        self._go_on()
        sim, dt = self.sim, self.scene.model.dt
        self.cuts.append({"step": sim.step, "time_s": sim.time, "step_s": dt, "reason": error.message})
        self.log.warning("%s", error.message)
        self.log.warning("back to step %d, %.6f s, and on with steps of %.3g s", sim.step, sim.time, dt)

    def keep_last_good(self) -> None:
        """Make the last good state the checkpoint, unless the one that is there is later."""
        if self.good.clock[0] > self.saved_step:
            extra = {"frames_done": self.good_frames, "wall_s": self.earlier_wall, "cuts": self.cuts}
            save_checkpoint(self.out, self.scene, self.good, extra)

    def _kept(self) -> str:
        return f"output up to the last frame, and the last good state as its checkpoint, are in {self.out.path}"

    def _observe(self, began: float) -> None:
        """History, energy guard and frames that are due."""
        sim, scene = self.sim, self.scene
        if self._is_history_step():
            self.energy = self._energies()
            wall = self.earlier_wall + clock.perf_counter() - began
            assert self.history is not None
            self.history.append(
                sim.step, sim.time, self._stage(), scene.path.at(sim.time), self.energy, scene.model.dt, wall
            )
            self._guard_energy()
            self._end_if_settled()
        if sim.step == self.steps:  # the frames that an early end leaves out are one
            self.frame_times[self.frames_done :] = [sim.time][: len(self.frame_times) - self.frames_done]
        due = int(np.searchsorted(self.frame_times, sim.time + 1e-12, side="right"))
        if due > self.frames_done:  # several may be due at a time: they are one
            if self.frames is not None:
                whole = scene.whole()
                self.frames.write(take_snapshot(whole, whole.state))
            self.frames_done = due

    def _energies(self) -> Energies:
        whole = self.scene.whole(places=False)
        return energies(whole.model, whole.state)

    def _is_history_step(self) -> bool:
        """Whether energies are looked at now."""
        interval = self.scene.case.solver.check_interval_steps
        every = max(self.scene.case.output.history_interval_steps, interval)
        return self.sim.step % every < interval or self.sim.step == self.scene.steps

    def _end_if_settled(self) -> None:
        """End here if loads are constant to the end and kinetic energy is below the case's `settled_percent`."""
        limit, begin = self.scene.case.process.settled_percent, self.scene.path.constant_from
        held = begin < self.sim.time and self._is_history_step()
        if held and limit > 0.0 and 100.0 * self.energy.kinetic_share() < limit and self.sim.step < self.steps:
            self.log.info("settled at %.6g s: the last stage ends here", self.sim.time)
            self.steps = self.sim.step

    def _guard_energy(self) -> None:
        error, limit = self.energy.error_percent, self.scene.case.solver.energy_error_limit_percent
        if not abs(error) <= limit:
            raise UnstableError(
                f"step {self.sim.step}, process time {self.sim.time:.6f} s: energy error of {error:.1f} % of the "
                f"work done, over solver.energy_error_limit_percent = {limit:g}",
                f"try a smaller solver.step_safety; {self._kept()}",
                smaller_step=True,
            )

    def _checkpoint(self, wall: float) -> None:
        steps = self.watch.seconds.get("steps", 0.0)
        extra = {
            "frames_done": self.frames_done, "wall_s": self.earlier_wall + wall, "steps_s": steps, "cuts": self.cuts,
        }  # fmt: skip
        save_checkpoint(self.out, self.scene, self.scene.state, extra)
        self.saved_step = self.sim.step

    def _stage(self) -> str:
        path = self.scene.path
        return path.names[int(path.stage(self.sim.time))]

    def _progress(self, began: float, first_step: int) -> Progress:
        elapsed = clock.perf_counter() - began
        done = max(1, self.sim.step - first_step)
        left = elapsed / done * (self.steps - self.sim.step)
        energy = self.energy
        return Progress(
            self._stage(), self.sim.step, self.steps, self.sim.time, self.scene.model.dt, energy.error_percent,
            100 * energy.kinetic_share(), elapsed, left,
        )  # fmt: skip

    def close(self) -> None:
        """End the solver's threads."""
        self.sim.close()


def _frame_times(scene: Scene) -> list[float]:
    """Process times of the frames: the start, then `frames_per_stage` evenly in each stage."""
    count = scene.case.output.frames_per_stage
    edges = scene.path.time
    times = [0.0]
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        times += [float(a + (b - a) * (k + 1) / count) for k in range(count)]
    first, begin = scene.state.clock[2:4]
    times[-1] = float(begin + (scene.steps - 0.5 - first) * scene.model.dt)
    return times
