"""Advance a scene: the solver's loop in batches of steps, with the work of the pressures kept between them."""

from __future__ import annotations

import numpy as np
from numba import njit

from ddf.dynamics.step import SCRATCH_ROWS, Work, advance
from ddf.dynamics.team import Team
from ddf.elements.rubber import cone_volume
from ddf.elements.tension import FAST
from ddf.model import DIAPHRAGM, PLY, PRESSURE_WORK, TOOL_SPEED, Model, sheet_vectors
from ddf.scene import Scene

REACH_SPEED = 500.0  # mm/s: least relative speed that sleeping cells and resting nodes allow for


@njit(**FAST)
def _largest_square(v):
    """Largest squared speed of a vector array (3, n, m); NaN if any component is."""
    top = 0.0
    for i in range(v.shape[1]):
        for j in range(v.shape[2]):
            s = v[0, i, j] ** 2 + v[1, i, j] ** 2 + v[2, i, j] ** 2
            if not s <= top:
                top = s
    return top


def make_work(model: Model, members: int) -> Work:
    """Scratch memory for a team of `members` threads."""
    widest = int(model.sheets["cols"].max()) + 2
    buffers = spans = 0
    for pair in model.pairs:
        n, m = (int(model.sheets[pair["master"]][key]) for key in ("rows", "cols"))
        blocks = int(np.sum(model.blocks["sheet"] == pair["slave"]))
        buffers = max(buffers, int(pair["buffer"]) + 3 * n * m * blocks)
        spans = max(spans, int(pair["span"]) + n * blocks)
    plies = np.flatnonzero(model.sheets["kind"] == PLY)
    tiles = []
    for k in plies:
        rows = int(model.sheets[k]["rows"])
        parts = min(max(1, -(-members // len(plies))), rows)
        cuts = np.linspace(0, rows, parts + 1).astype(int)
        tiles += [
            (k, a, b, max(0, a - model.inner), min(rows, b + model.inner))
            for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        ]
    table = np.array(tiles, dtype=np.int64).reshape(-1, 5)
    sizes = (table[:, 4] - table[:, 3]) * model.sheets["cols"][table[:, 0]]
    first = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    bottom = model.sheets[0]
    cells = (int(bottom["rows"]) - 1, int(bottom["cols"]) - 1)
    return Work(
        scratch=np.zeros((members, SCRATCH_ROWS * widest)), buffers=np.zeros(buffers),
        spans=np.zeros((spans, 2), np.int64), carry=np.zeros((model.blocks.size, 3, widest)),
        sleep=np.zeros(cells, np.int16), rest=np.zeros(model.exposed.size, np.int8), tiles=table, tile_x=np.zeros(3 * first[-1]), tile_v=np.zeros(3 * first[-1]),
        tile_green1=np.zeros(first[-1]), tile_green2=np.zeros(first[-1]), tile_first=first[:-1].copy(),
        wave=np.zeros((len(table), (2 * model.inner + 2) * 3 * widest)), lost=np.zeros(len(table)),
    )  # fmt: skip


class Simulation:
    """A scene in motion. `advance(n)` runs n outer steps; all results are in `scene.state`."""

    def __init__(self, scene: Scene, threads: int = 1) -> None:
        self.scene = scene
        self.model, self.state = scene.model, scene.state
        self.team = Team(threads)
        self.work = make_work(scene.model, threads)
        self._volumes = self._swept()

    @property
    def step(self) -> int:
        """Outer steps done."""
        return int(self.state.clock[0])

    @property
    def time(self) -> float:
        """Process time [s]."""
        return float(self.state.clock[1])

    def _swept(self) -> dict[int, float]:
        diaphragms = np.flatnonzero(self.model.sheets["kind"] == DIAPHRAGM)
        return {
            int(k): cone_volume(sheet_vectors(self.model, self.state.x, k), 0, int(self.model.sheets[k]["rows"]))
            for k in diaphragms
        }

    def fastest(self, k: int) -> float:
        """Largest speed in sheet k [mm/s]."""
        return float(np.sqrt(_largest_square(sheet_vectors(self.model, self.state.v, k))))

    def advance(self, steps: int) -> None:
        """Run `steps` outer steps, as one batch: batches must be the same in a run that is resumed."""
        model, state = self.model, self.state
        times = (self.step + np.arange(steps)) * model.dt
        schedule = self.scene.path.schedule(times, self.scene.base_z, model.dt)
        fastest = max(self.fastest(k) for k in range(model.sheets.size))
        speed = max(REACH_SPEED, 4.0 * fastest + float(np.abs(schedule[:, TOOL_SPEED]).max()))
        self.work.sleep[:] = 0
        self.work.rest[:] = np.where(model.exposed, 0, -1)
        self.work.lost[:] = 0.0
        self.team.run(advance, model, state, self.work, schedule, speed * model.dt)
        np.add.at(state.fibre_damping, self.work.tiles[:, 0], self.work.lost)
        state.clock[0] += steps
        state.clock[1] = state.clock[0] * model.dt
        self._account_pressure(schedule)

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
