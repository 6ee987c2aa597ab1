"""What connects a half model (`dynamics.mirror`) with the whole scene that people see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddf.model import Model, State, sheet_vectors

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Half:
    """The whole of which a half is computed, x > 0 or y > 0, and where the half's nodes and places are in it."""

    axis: int
    """Component normal to the mirror plane."""
    whole: Model
    start: State
    """The whole at rest."""
    source: tuple[IntArray, ...]
    """For each sheet and node (rows, cols) of the whole the number in the half's sheet of the node that it or its image
    is; -1 where the ply has no fabric."""
    flipped: tuple[NDArray[np.bool_], ...]
    """For each sheet and node (rows, cols) of the whole whether it is the image."""
    corner: tuple[tuple[int, int], ...]
    """For each sheet the first row and column of the whole's grid that the half has."""
    turn: tuple[FloatArray, ...]
    """For each sheet (2, 3): grid coordinates of the image of a place, turn @ (u, v, 1), in the whole's grid."""

    @property
    def where(self) -> str:
        """The half that is computed, in words."""
        return f"{'xy'[self.axis]} > 0"

    def unfold(self, model: Model, state: State, places: bool = True) -> State:
        """State of the whole from that of the half: motion, forces, places, energies; the rest as at the start.

        places: whether those of contact are wanted; else they are as at the start.
        """
        whole, start = self.whole, self.start
        full = start._replace(
            x=start.x.copy(), v=start.v.copy(), f=start.f.copy(), press=start.press.copy(),
            ledger=2.0 * state.ledger, springs=2.0 * state.springs, clock=state.clock.copy(),
        )  # fmt: skip
        for k, (source, flipped) in enumerate(zip(self.source, self.flipped, strict=True)):
            there = source >= 0
            at, sign = source[there], np.where(flipped[there], -1.0, 1.0)
            for pool, half_pool in ((full.x, state.x), (full.v, state.v), (full.f, state.f)):
                target, half = sheet_vectors(whole, pool, k), sheet_vectors(model, half_pool, k).reshape(3, -1)
                for c in range(3):
                    target[c][there] = half[c, at] * (sign if c == self.axis else 1.0)
            count, first = source.size, int(whole.sheets[k]["node"])
            half_first, half_count = (
                int(model.sheets[k]["node"]),
                int(model.sheets[k]["rows"] * model.sheets[k]["cols"]),
            )
            full.press[first : first + count][there.ravel()] = state.press[half_first : half_first + half_count][at]
            on_plane = model.plane[(model.plane >= half_first) & (model.plane < half_first + half_count)] - half_first
            sheet_vectors(whole, full.f, k)[:, np.isin(source, on_plane)] *= 2.0
        if places:
            full = full._replace(place=start.place.copy())
            for number in range(whole.pairs.size):
                self._unfold_places(model, state, full, number)
        return full

    def _unfold_places(self, model: Model, state: State, full: State, number: int) -> None:
        """Fill in the places of a pair's slaves on their master."""
        slave, master = int(self.whole.pairs[number]["slave"]), int(self.whole.pairs[number]["master"])
        source, flipped = self.source[slave], self.flipped[slave]
        there = source >= 0
        first, half_first = int(self.whole.pairs[number]["first"]), int(model.pairs[number]["first"])
        half_count = int(model.sheets[slave]["rows"] * model.sheets[slave]["cols"])
        place = full.place[5 * first : 5 * (first + source.size)].reshape(5, *source.shape)
        half = state.place[5 * half_first : 5 * (half_first + half_count)].reshape(5, -1)[:, source[there]]
        u, v = half[0] + self.corner[master][0], half[1] + self.corner[master][1]
        image = self.turn[master] @ np.stack([u, v, np.ones_like(u)])
        place[0][there], place[1][there] = np.where(flipped[there], image, [u, v])
        for field in (2, 3, 4):
            place[field][there] = half[field]
