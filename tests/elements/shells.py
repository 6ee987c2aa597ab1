"""Patches of shell-membrane cells, and their kernels applied in row blocks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import patches as p

from ddf.elements.shell_membrane import history as h
from ddf.elements.shell_membrane import membrane, shell
from ddf.elements.shell_membrane.energy import elastic_energies, stored_energies
from ddf.elements.shell_membrane.rotations import normals
from ddf.materials.shear_law import TANGENT_SPAN, shear_samples, tangent_table

DEFAULTS = {"thickness": 0.5, "transverse": 20.0, "glass": 0.05, "gyration": 0.02}


def tangents_of(law):
    return tangent_table(*shear_samples(law, 0.5, 0.002, p.PUBLISHED, None))


def past_of(rows, cols):
    """History of cells in their flat reference."""
    past = np.zeros((h.HISTORY, rows, cols))
    past[[h.M_C11, h.M_C22, h.S_C11, h.S_C22]] = 1.0
    return past


@dataclass
class ShellPatch:
    """A ply patch whose cells remember; `forces` takes them one step on."""

    ply: p.PlyPatch
    law: str = "monotone"
    past: np.ndarray = field(init=False)

    def __post_init__(self):
        self.past = past_of(*self.ply.shape)

    @property
    def rest(self):
        return self.ply.rest

    def forces(self, x, d, seam=None, viscous=0.0, keep=True):
        """Forces, pulls on the directors, stress work of the step from the remembered state to x, d."""
        past = self.past if keep else self.past.copy()
        f, pull = np.zeros_like(x), np.zeros_like(x)
        carry = np.zeros((6, 2, x.shape[2]))
        work, w = 0.0, np.full(max(membrane.SCRATCH, shell.SCRATCH), np.nan)
        table, s, cell = tangents_of(self.law), self.ply.sheet, self.ply.cell
        for b, (low, high) in enumerate(((0, x.shape[1]),) if seam is None else ((0, seam), (seam, x.shape[1]))):
            work += membrane.membrane_forces(
                x, f, past, cell, table, TANGENT_SPAN, s, viscous, low, high, carry[:3], b, w
            )
            work += shell.shell_forces(x, f, d, pull, past, cell, s, low, high, carry, b, w)
        if seam is not None:
            f[:, seam] += carry[:3, 0]
            pull[:, seam] += carry[3:, 0]
        return f, pull, work

    def elastic(self, x, d):
        """Energy of transverse shear and hourglass controls."""
        return sum(elastic_energies(x, d, self.ply.cell, self.ply.sheet).values())

    def stored(self):
        return stored_energies(self.past, self.ply.cell, p.table_of(self.law), self.ply.sheet)


def shell_patch(rows=7, cols=9, fractions=None, law="monotone", **values):
    return ShellPatch(p.ply_patch(rows, cols, fractions, **(DEFAULTS | values)), law)


def rumpled(patch, rng, noise=0.02):
    """Places and unit directors of a wavy, sheared sheet."""
    x = p.wavy(patch.rest, rng, noise=noise)
    x[0] += 0.3 * x[1]
    d = normals(x) + rng.normal(size=x.shape) * 0.05
    return x, d / np.sqrt((d * d).sum(axis=0))
