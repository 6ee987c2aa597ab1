"""Forces and stiffness of a scene as its own step gives them.

`acting_forces`: those of the last step, fibre tension as the solver keeps it. `Probe`: those of any positions, by one
step from rest, so short that nothing moves.

With a unit mass at every node, v = dt f after a step from v = 0; fibre tension, which the step takes
implicitly, is then that of the positions, up to E h w dt^2 / (a m) of itself (4e-10 for the shipped fabric). Forces
include everything but gravity: held nodes get theirs too, which is the force on a grip.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from ddf.elements.tension import pull_kept
from ddf.model import sheet_scalars, sheet_vectors
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.problem import FloatArray
from ddf.verify.scenes import copied_state, positions, velocities

PROBE_STEP_S = 1e-7
STENCIL = 5  # nodes this far apart along a grid direction share no force


def acting_forces(scene: Scene, k: int = 0) -> FloatArray:
    """Forces (3, rows, cols) [N] that acted on the nodes of ply k in the last step, fibre tension included.

    On held nodes these are what the holder resists.
    """
    model, state = scene.model, scene.state
    f = sheet_vectors(model, state.f, k).copy()
    kept = [sheet_scalars(model, pool, k) for pool in (state.tension1, state.tension2)]
    one, scratch = np.ones(f.shape[1:]), np.zeros((3, f.shape[2]))
    for i in range(f.shape[1]):
        pull_kept(positions(scene, k), f, one, *kept, 1.0, i, scratch)
    return f


class Probe:
    """Forces on the nodes of sheet k of a scene; the scene itself is left as it is."""

    def __init__(self, scene: Scene, k: int = 0) -> None:
        model, self.k = scene.model, k
        still = model._replace(
            mass=np.zeros_like(model.mass),
            inverse_mass=np.ones_like(model.mass),
            line_mass=np.ones_like(model.mass),
            gravity=np.zeros(3),
            dt=PROBE_STEP_S,
        )
        self.start = copied_state(scene.state)
        self.scene = replace(scene, model=still, state=copied_state(scene.state))
        self.sim = Simulation(self.scene)

    def forces(self, x: FloatArray | None = None) -> FloatArray:
        """Forces (3, rows, cols) [N] with sheet k at x (3, rows, cols) [mm]; left out: where the scene has it."""
        for target, source in zip(self.scene.state, self.start, strict=True):
            target[:] = source
        self.scene.state.v[:] = 0.0
        if x is not None:
            positions(self.scene, self.k)[:] = x
        self.sim.advance(1)
        return velocities(self.scene, self.k) / PROBE_STEP_S

    def stiffness(self, x: FloatArray, components: Sequence[int] = (0, 1, 2), way_mm: float = 1e-6) -> csr_array:
        """Tangent stiffness -df/dx at x [N/mm] by central differences, (c n m, c n m), unknowns component by component.

        Nodes STENCIL apart are moved together: shear reaches one node far, bending two.
        """
        n, m = x.shape[1:]
        size = n * m
        number = np.arange(size).reshape(n, m)
        rows, columns, values = [], [], []
        for place, c in enumerate(components):
            for shift in np.ndindex(STENCIL, STENCIL):
                at = (slice(shift[0], n, STENCIL), slice(shift[1], m, STENCIL))
                ahead, back = x.copy(), x.copy()
                ahead[(c, *at)] += way_mm
                back[(c, *at)] -= way_mm
                change = (self.forces(back) - self.forces(ahead)) / (2.0 * way_mm)
                owner = _nearest(number, shift)
                for other, d in enumerate(components):
                    found = change[d].ravel()
                    rows.append(other * size + number.ravel())
                    columns.append(place * size + owner.ravel())
                    values.append(np.where(owner.ravel() >= 0, found, 0.0))
        entries = (np.concatenate(values), (np.concatenate(rows), np.maximum(np.concatenate(columns), 0)))
        matrix = csr_array(entries, shape=(len(components) * size, len(components) * size))
        return (matrix + matrix.T) / 2


def _nearest(number: np.ndarray, shift: tuple[int, ...]) -> np.ndarray:
    """For each node the moved node within half a stencil of it, (n, m); -1 where there is none."""
    n, m = number.shape
    half = STENCIL // 2
    i, j = (
        (np.arange(count) - first + half) // STENCIL * STENCIL + first
        for count, first in ((n, shift[0]), (m, shift[1]))
    )
    there = ((i >= 0) & (i < n))[:, None] & ((j >= 0) & (j < m))[None, :]
    return np.where(there, number[np.clip(i, 0, n - 1)][:, np.clip(j, 0, m - 1)], -1)
