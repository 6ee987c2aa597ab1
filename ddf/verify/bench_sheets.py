"""Sheets, contacts, tool and loads of small verification scenes. Units as in `ddf.model`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddf.build.step import TONNE_PER_KG_M3
from ddf.case import PRESETS, HyperelasticMaterial, WovenMaterial
from ddf.loads.path import LoadPath
from ddf.materials import ogden
from ddf.mesh.distance import DistanceField
from ddf.verify.problem import Options
from ddf.verify.scenes import areal_mass, fabric_of

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Sheet:
    """A sheet of a scene: grid lines of its reference (n,), (m,) [mm], its start (3, n, m), what is held."""

    lines: tuple[FloatArray, FloatArray]
    start: FloatArray
    held: BoolArray
    areal_mass: float  # [tonne/mm2]
    thickness: float
    material: WovenMaterial | HyperelasticMaterial
    rigidity: float = 0.0  # diaphragm: of plate bending [N mm]

    @property
    def cells(self) -> FloatArray:
        """Reference areas (n-1, m-1) [mm2]."""
        return np.diff(self.lines[0])[:, None] * np.diff(self.lines[1])[None, :]

    @property
    def element(self) -> float:
        """Cell size for the stable step [mm]: 2/a^2 = 1/dx^2 + 1/dy^2 of the smallest."""
        dx, dy = (float(np.diff(line).min()) for line in self.lines)
        return math.sqrt(2.0 / (dx**-2 + dy**-2))


@dataclass(frozen=True)
class Touch:
    """Contact of sheet `slave` on sheet `master`; sign +1: the slave is on the side of the master's normal."""

    slave: int
    master: int
    sign: float
    friction: float
    stiffness: float = 1.0  # [N/mm3]
    damping: float = 0.2  # of critical
    offset: float | None = None  # [mm]; left out: half of both thicknesses


@dataclass(frozen=True)
class ToolContact:
    """A tool that meets sheet 0."""

    field: DistanceField
    friction: float
    base_z: float = 0.0
    stiffness: float = 10.0
    damping: float = 0.2


def flat_start(lines: tuple[FloatArray, FloatArray], z: float = 0.0) -> FloatArray:
    """Positions (3, n, m) of a flat sheet at height z."""
    x, y = np.meshgrid(*lines, indexing="ij")
    return np.array([x, y, np.full_like(x, z)])


def edges(lines: tuple[FloatArray, FloatArray], *sides: str) -> BoolArray:
    """(n, m): nodes on the sides "left", "right" (first grid direction), "front", "back" (second)."""
    held = np.zeros((lines[0].size, lines[1].size), bool)
    views = {"left": held[0], "right": held[-1], "front": held[:, 0], "back": held[:, -1]}
    for side in sides:
        views[side][:] = True
    return held


def even_line(length: float, element: float, middle: float = 0.0) -> FloatArray:
    """Evenly spaced places of at least three nodes [mm], about `element` apart."""
    return middle + np.linspace(-0.5, 0.5, max(2, round(length / element)) + 1) * length


def rubber_of(options: Options) -> HyperelasticMaterial:
    """The rubber of the options, or the shipped silicone."""
    return options.rubber or cast(HyperelasticMaterial, PRESETS["silicone-ogden"])


def rubber_sheet(
    options: Options, lines: tuple[FloatArray, FloatArray], held: BoolArray | None = None, *, z: float = 0.0,
    thickness: float = 1.5, bending: bool = False,
) -> Sheet:  # fmt: skip
    """A flat diaphragm."""
    rubber = rubber_of(options)
    start = flat_start(lines, z)
    held = np.zeros(start.shape[1:], bool) if held is None else held
    rigidity = ogden.bending_rigidity(rubber.abaqus_terms, thickness) if bending else 0.0
    return Sheet(lines, start, held, rubber.density_kg_m3 * TONNE_PER_KG_M3 * thickness, thickness, rubber, rigidity)


def fabric_sheet(
    options: Options, lines: tuple[FloatArray, FloatArray], held: BoolArray | None = None, *, z: float = 0.0,
    mass_scaling: float = 20.0,
) -> Sheet:  # fmt: skip
    """A flat ply with its families along the grid."""
    fabric = fabric_of(options)
    start = flat_start(lines, z)
    held = np.zeros(start.shape[1:], bool) if held is None else held
    mass = areal_mass(fabric) * mass_scaling
    return Sheet(lines, start, held, mass, fabric.thickness_mm, fabric)


def constant_load(pressure: float = 0.0, damping: float = 0.0, duration: float = 1e3) -> LoadPath:
    """A path with one net pressure on sheets that face the bottom [MPa], and mass damping [1/s]."""
    return ramped_load([0.0, duration], [pressure, pressure], damping)


def ramped_load(time: ArrayLike, pressure: ArrayLike, damping: float) -> LoadPath:
    """Net pressure [MPa] along the normal of all diaphragms over time [s], smooth between the points."""
    time, box = np.asarray(time, dtype=float), np.asarray(pressure, dtype=float) * 1e3
    zero, stages = np.zeros_like(time), time.size - 1
    names = tuple(f"stage-{k}" for k in range(stages))
    return LoadPath(time, zero, box, zero, np.ones(stages, bool), np.full(stages, damping), names, 0.0)
