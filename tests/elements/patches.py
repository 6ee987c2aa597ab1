"""Small deformed patches of ply and diaphragm, and the kernels applied to them in row blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddf.elements import bending, shear
from ddf.elements.bending import bending_energy, bending_forces
from ddf.elements.plate import plate_energy, plate_forces
from ddf.elements.rubber import SCRATCH, cone_volume, rubber_energy, rubber_forces
from ddf.elements.shear import shear_energy, shear_forces
from ddf.elements.tension import LINES, line_scratch, pull_kept, pull_lines, pull_rows, tension_energy
from ddf.materials.shear_law import shear_samples, shear_table
from ddf.model import SHEET

OGDEN = np.array([[0.150904, 3.0918], [0.813392, 0.81451]])
PUBLISHED = [0.4576, -7.394, 36.36, -59.31, 32.37]
SMALL_STEP = 1e-12  # s: a step of the implicit tension in which velocities change nothing


def table_of(law):
    return shear_table(*shear_samples(law, 0.5, 0.002, PUBLISHED, None))


def make_sheet(rows, cols, **values):
    sheet = np.zeros(1, SHEET)
    defaults = {
        "rows": rows, "cols": cols, "a1": 2.0, "a2": 1.7, "eh1": 20_000.0, "eh2": 15_000.0, "bend1": 0.34,
        "bend2": 0.2, "bend_in_plane": 0.0, "thickness": 1.5, "rigidity": 1.085, "hourglass": 3.0,
    }  # fmt: skip
    for key, value in (defaults | values).items():
        sheet[key] = value
    return sheet[0]


@dataclass
class PlyPatch:
    sheet: np.void
    rest: np.ndarray  # (3, n, m)
    cell: np.ndarray
    bar1: np.ndarray
    bar2: np.ndarray
    triple1: np.ndarray
    triple2: np.ndarray

    @property
    def shape(self):
        return self.rest.shape[1:]


def ply_patch(rows=7, cols=9, fractions=None, **values):
    """A flat ply; fractions (rows-1, cols-1) of its cells exist, 0 for a hole."""
    sheet = make_sheet(rows, cols, **values)
    a1, a2 = float(sheet["a1"]), float(sheet["a2"])
    share = np.zeros((rows, cols))
    share[:-1, :-1] = 1.0 if fractions is None else fractions
    left = np.pad(share, ((0, 0), (1, 0)))[:, :-1]
    above = np.pad(share, ((1, 0), (0, 0)))[:-1]
    bar1, bar2 = 0.5 * a2 * (share + left), 0.5 * a1 * (share + above)
    triple1, triple2 = np.zeros_like(bar1), np.zeros_like(bar2)
    triple1[1:-1] = a1 * np.minimum(bar1[:-2], bar1[1:-1])
    triple2[:, 1:-1] = a2 * np.minimum(bar2[:, :-2], bar2[:, 1:-1])
    u, v = np.meshgrid(np.arange(rows) * a1, np.arange(cols) * a2, indexing="ij")
    rest = np.array([u, v, np.zeros_like(u)])
    return PlyPatch(sheet, rest, a1 * a2 * share, bar1, bar2, triple1, triple2)


def cut_fractions(rng, rows=7, cols=9):
    """Random fractions with a missing corner and a hole."""
    share = rng.uniform(0.3, 1.0, (rows - 1, cols - 1))
    share[0, 0] = share[3, 4] = share[-1, -1] = 0.0
    return share


def wavy(patch_rest, rng, amplitude=0.3, noise=0.05):
    x = patch_rest.copy()
    x[2] += amplitude * np.sin(x[0]) + 0.7 * amplitude * np.cos(0.7 * x[1])
    return x + rng.normal(size=x.shape) * noise


def _blocks(rows, seam):
    return ((0, rows),) if seam is None else ((0, seam), (seam, rows))


def ply_shear(patch, x, table, seam=None):
    f = np.zeros_like(x)
    for low, high in _blocks(x.shape[1], seam):
        shear_forces(x, f, patch.cell, table, low, high, np.full(shear.SCRATCH, np.nan))
    return f


def ply_bending(patch, x, seam=None):
    f = np.zeros_like(x)
    for low, high in _blocks(x.shape[1], seam):
        work = np.full(bending.SCRATCH, np.nan)
        weight = bending.tangent_weights(patch.bar1, patch.bar2)
        bending_forces(x, f, weight, patch.triple1, patch.triple2, patch.sheet, low, high, work)
    return f


def ply_bending_energy(patch, x):
    return bending_energy(x, patch.bar1, patch.bar2, patch.triple1, patch.triple2, patch.sheet)


def ply_shear_energy(patch, x, table):
    return shear_energy(x, patch.cell, table)


def ply_tension_energy(patch, x):
    return sum(tension_energy(x, patch.bar1, patch.bar2, patch.sheet))


def pull(patch, x, v, inverse_mass, dt, family, bundle=LINES, kept=None, string=False):
    """Velocities after the correction of a family's tensions (kept, changed), its lines cut into bundles."""
    s, v = patch.sheet, v.copy()
    n, m = patch.shape
    kept = np.zeros(patch.shape) if kept is None else kept
    a, eh = s[f"a{family}"], s[f"eh{family}"]
    law = (1.0 / a, dt * dt * eh / a, 0.5 * dt * eh, dt * dt / a, dt)
    if family == 1:
        for a in range(0, m, bundle):
            work = np.full(line_scratch(n), np.nan)
            pull_lines(x, v, inverse_mass, patch.bar1, kept, law, string, -1, a, min(m, a + bundle), 0, n, work)
    else:
        for a in range(0, n, bundle):
            work = np.full(line_scratch(m), np.nan)
            pull_rows(x, v, inverse_mass, patch.bar2, kept, law, string, -1, a, min(n, a + bundle), 0, m, work)
    return v


def pull_both(patch, x, v, inverse_mass, dt, kept, first):
    """The whole step of the tensions kept[0], kept[1] (changed), family `first` first: velocities after it."""
    v = v.copy()
    for i in range(patch.shape[0]):
        pull_kept(x, v, inverse_mass, kept[0], kept[1], dt, i, np.zeros((3, patch.shape[1])))
    for turn in range(4):
        family = first if turn % 2 == 0 else 3 - first
        v = pull(patch, x, v, inverse_mass, dt, family, LINES, kept[family - 1], turn > 1)
    return v


def ply_tension(patch, x):
    """Fibre forces: the implicit step's change of momentum over dt, dt -> 0."""
    v, one = np.zeros_like(x), np.ones(patch.shape)
    for family in (1, 2):
        v = pull(patch, x, v, one, SMALL_STEP, family)
    return v / SMALL_STEP


@dataclass
class RubberPatch:
    sheet: np.void
    rest: np.ndarray
    dx: np.ndarray
    dy: np.ndarray


def rubber_patch(rng, rows=7, cols=9, **values):
    dx, dy = rng.uniform(1.5, 2.5, rows - 1), rng.uniform(1.5, 2.5, cols - 1)
    lines = [np.concatenate([[0.0], np.cumsum(d)]) for d in (dx, dy)]
    u, v = np.meshgrid(*lines, indexing="ij")
    return RubberPatch(make_sheet(rows, cols, **values), np.array([u, v, np.zeros_like(u)]), dx, dy)


def rubber(patch, x, pressure=0.0, seam=None):
    f = np.zeros_like(x)
    for low, high in _blocks(x.shape[1], seam):
        work = np.full(SCRATCH, np.nan)
        rubber_forces(x, f, patch.dx, patch.dy, patch.sheet, OGDEN, pressure, low, high, work)
    return f


def rubber_energies(patch, x):
    return rubber_energy(x, patch.dx, patch.dy, patch.sheet, OGDEN)


def plate(patch, x, seam=None):
    f = np.zeros_like(x)
    for low, high in _blocks(x.shape[1], seam):
        work = np.full((72, x.shape[2] + 2), np.nan)
        plate_forces(x, f, patch.dx, patch.dy, float(patch.sheet["rigidity"]), low, high, work)
    return f


def plate_bending_energy(patch, x):
    return plate_energy(x, patch.dx, patch.dy, float(patch.sheet["rigidity"]))


def volume(x):
    return cone_volume(x, 0, x.shape[1])


def relative(a, b):
    """Largest difference over the largest value."""
    return np.abs(a - b).max() / np.abs(b).max()


def random_rotation(rng):
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def turned(rotation, x):
    return np.tensordot(rotation, x, 1)
