"""A sheet folded on itself, and calls of the search and of the contact kernels on it."""

from __future__ import annotations

import numpy as np
import touching as t

from ddf.contact.layers import NOWHERE, UNKNOWN, chunk_scratch, layer_forces
from ddf.contact.normal_cones import STACK, tile_count, tile_levels
from ddf.contact.patch import patch_centres
from ddf.contact.self_contact import drop_near
from ddf.contact.self_search import seek
from ddf.model import DIAPHRAGM, RIM, SHEET


def dome(cells, element, degrees):
    """A cap of a sphere (3, cells+1, cells+1); its normals lean that far at the middles of the sides."""
    s = (np.arange(cells + 1) - cells / 2) * element
    radius = s[-1] / np.deg2rad(degrees)
    x, y = np.meshgrid(s, s, indexing="ij")
    r = np.hypot(x, y) + 1e-12
    angle = r / radius
    return np.array([radius * np.sin(angle) * x / r, radius * np.sin(angle) * y / r, radius * np.cos(angle)])


class Fold:
    """A sheet with its pairs of self-contact."""

    def __init__(self, shape, element, *, offset, radius, friction=0.0, damping=0.0, stiffness=2.0):
        n, m = self.shape = shape
        sheet = np.zeros(1, SHEET)
        sheet["kind"], sheet["rows"], sheet["cols"], sheet["fold_radius"] = DIAPHRAGM, n, m, radius
        self.sheet, self.lines, self.offset = sheet[0], np.full(n + m - 2, element), offset
        law = {"offset": offset, "friction": friction, "damping": damping, "stiffness": stiffness}
        self.pairs = [t.make_pair(sign=sign, **law) for sign in (1.0, -1.0)]
        self.sides = [(np.full((5, n, m), UNKNOWN), np.full((n, m), -1, np.int8)) for _ in range(2)]
        self.slips = [np.zeros((2, n, m)) for _ in range(2)]
        self.cell = np.pad(np.full((n - 1, m - 1), element**2), ((0, 1), (0, 1)))
        self.area, self.cover = np.full(shape, element**2), np.ones(shape)
        self.centre = patch_centres(np.ones(shape, bool))
        levels = tile_levels(n, m)
        count = tile_count(levels)
        self.tiles = (
            levels, np.zeros((3, n, m)), np.zeros((count, 4)), np.zeros((count, 6)), np.zeros((STACK, 5), np.int64)
        )  # fmt: skip
        self.out = np.zeros(4)

    def find(self, x, skin=0.5):
        """Search; whether any node is followed above, and below."""
        return seek(
            self.sheet, self.lines, x, self.cover, np.zeros((*self.shape, 4)), np.zeros(0, RIM), self.cell,
            self.area, self.centre, self.offset, skin, *self.sides, self.tiles,
        )  # fmt: skip

    def forces(self, x, v=None, dt=1e-6):
        """Forces on all nodes; `out` has the energies of this call, `normal` the normal forces on slaves."""
        v, f = np.zeros_like(x) if v is None else v, np.zeros_like(x)
        self.out, self.normal = np.zeros(4), np.zeros(self.shape)
        scratch = tuple(part[0] for part in chunk_scratch(1))
        for pair, (place, rest), slip in zip(self.pairs, self.sides, self.slips, strict=True):
            buffer, span = np.zeros((*self.shape, 4)), np.tile(np.array([NOWHERE, 0]), (self.shape[0], 1))
            drop_near(self.sheet, self.lines, place, slip, rest, 0, self.shape[0])
            layer_forces(
                x, v, f, self.normal, self.area, t.packed(x), t.packed(v, 0.0), self.centre, place, slip,
                np.where(rest < 0, rest, 0).astype(np.int8), buffer, span, pair, 1e6, dt, 0, self.shape[0], scratch,
                self.out,
            )  # fmt: skip
            f += np.moveaxis(buffer[..., :3], -1, 0)
        return f

    def settle(self, x, rounds=20):
        """Converge the projection; springs are unstretched there. Long steps: depths are whole."""
        for _ in range(rounds):
            self.forces(x, None, 1.0)
            for slip in self.slips:
                slip[:] = 0.0
        return self

    def touching(self):
        """Nodes that touch above, and below: two (n, m) of bool."""
        return tuple((place[2] < 0.0) & (rest >= 0) for place, rest in self.sides)
