"""Advance a scene: the solver's loop in batches of steps, with the work of the pressures kept between them."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np

from ddf.contact.self_search import SelfContact
from ddf.dynamics.handle import held
from ddf.dynamics.pace import Pace
from ddf.dynamics.phases import largest_square
from ddf.dynamics.step import advance
from ddf.dynamics.team import Team
from ddf.dynamics.work import make_work
from ddf.elements.rubber import cone_volume
from ddf.model import DIAPHRAGM, PRESSURE_BOTTOM, PRESSURE_TOP, PRESSURE_WORK, TOOL_SPEED, sheet_vectors
from ddf.scene import Scene

BATCH = 10  # steps between two looks at how fast the sheets are
REACH_SPEED = 500.0  # mm/s: least relative speed that sleeping cells and resting nodes allow for


class Simulation:
    """A scene in motion. `advance(n)` runs n steps; all results are in `scene.state`."""

    def __init__(self, scene: Scene, threads: int = 1) -> None:
        self.scene = scene
        self.model, self.state = scene.model, scene.state
        self.team, self.pace = Team(threads), Pace(threads)
        self.work = make_work(scene.model, threads)
        self._followed = np.where(scene.model.exposed, 0, -1).astype(np.int8)
        self._self_contact = SelfContact(self.model, self.state, self.work.packed, self.work.rest, self.work.idle)
        self.handles = held(self.model), held(self.state), held(self.work)
        self._volumes = self._swept()

    @property
    def step(self) -> int:
        """Steps done."""
        return int(self.state.clock[0])

    @property
    def time(self) -> float:
        """Process time [s]."""
        return float(self.state.clock[1])

    def _swept(self) -> dict[int, float]:
        diaphragms = np.flatnonzero(self.model.sheets["kind"] == DIAPHRAGM)
        swept = {}
        for k in diaphragms:
            x = sheet_vectors(self.model, self.state.x, int(k))
            if self.model.mirror >= 0:  # what the cones from the origin hold lies on one side of the plane too
                node = self.model.plane - int(self.model.sheets[k]["node"])
                row, col = np.divmod(node[(node >= 0) & (node < x[0].size)], x.shape[2])
                x = np.ascontiguousarray(x[:, row.min() :, col.min() :])
            swept[int(k)] = cone_volume(x, 0, x.shape[1])
        return swept

    def time_of(self, step: Any) -> Any:
        """Process time [s] at step numbers from now on, with the step as it is."""
        first, begin = self.state.clock[2:4]
        return begin + (step - first) * self.model.dt

    def recount(self) -> None:
        """Take the state as it is now (after it was read from a checkpoint) as the start of the next batch."""
        self._volumes = self._swept()

    def seek(self, way: float) -> None:
        """Look for nodes that meet their own sheet, within the way that sheets can go in the next batch [mm]."""
        self._self_contact.seek(way, self.team.each)

    def fastest(self, k: int) -> float:
        """Largest speed in sheet k [mm/s]."""
        return float(np.sqrt(largest_square(sheet_vectors(self.model, self.state.v, k))))

    def advance(self, steps: int) -> None:
        """Run `steps` steps. Batches must be the same in a run that is resumed: they set who rests how long."""
        if steps == 0:
            self._batch(0)
        while steps > 0:
            self._batch(min(steps, BATCH))
            steps -= BATCH

    def _batch(self, steps: int) -> None:
        model, state = self.model, self.state
        times = self.time_of(np.arange(self.step, self.step + steps, dtype=np.float64))
        schedule = self.scene.path.schedule(times, self.scene.base_z, model.dt)
        self.work.sleep[:] = self.work.bed_sleep[:] = 0
        self.work.rest[:] = self._followed
        reach = self._reach_speed(schedule) * model.dt
        self.seek(reach * steps)
        began = perf_counter()
        self.team.run(advance, *self.handles, schedule, self.step, reach, members=self.pace.count)
        if steps:
            self.pace.took((perf_counter() - began) / steps)
        state.clock[0] += steps
        state.clock[1] = self.time_of(state.clock[0])
        if steps:
            self._account_pressure(schedule)

    def _reach_speed(self, schedule: np.ndarray) -> float:
        """Relative speed that nothing exceeds in this batch [mm/s]: twice today's, and what pressure can add."""
        fastest = max(self.fastest(k) for k in range(self.model.sheets.size))
        pressure = float(np.abs(schedule[:, [PRESSURE_TOP, PRESSURE_BOTTOM]]).max(initial=0.0))
        gain = 2.0 * pressure / self.model.tool_mass * BATCH * self.model.dt
        tool = float(np.abs(schedule[:, TOOL_SPEED]).max(initial=0.0))
        return max(REACH_SPEED, 4.0 * fastest + gain + tool)

    def _account_pressure(self, schedule: np.ndarray) -> None:
        """Work of the pressures over the batch: the mean of both ends times the swept volume."""
        after = self._swept()
        end = self.scene.path.schedule(np.array([self.time]), self.scene.base_z, self.model.dt)
        for k, volume in after.items():
            face = int(self.model.sheets[k]["face"])
            block = int(np.flatnonzero(self.model.blocks["sheet"] == k)[0])
            mean = 0.5 * (schedule[0, face] + end[0, face])
            self.state.ledger[block, PRESSURE_WORK] += mean * (volume - self._volumes[k])
        self._volumes = after

    def close(self) -> None:
        """End the team's threads."""
        self.team.close()
