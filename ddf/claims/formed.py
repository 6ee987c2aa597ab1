"""A finished run as the claims look at it: its plies, their wrinkles, and where the tool's axis is."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.case import case_from_dict
from ddf.compare.outlines import outline_distances
from ddf.errors import UsageError
from ddf.metrics import PlySurface, boundary_profile, outline_area, shear_angle
from ddf.metrics.surface import cell_area
from ddf.output.reopen import formed_ply, plies_of
from ddf.output.results import open_run

Array = NDArray[np.float64]
Row = dict[str, Any]


@dataclass(frozen=True, eq=False)
class FormedPly:
    """One formed ply."""

    surface: PlySurface
    wrinkles: list[Row]  # rows of wrinkles.csv
    wrinkled_percent: float  # share of the ply's area

    @property
    def name(self) -> str:
        """The ply's name."""
        return self.surface.name

    @cached_property
    def outlines(self) -> tuple[list[Array], list[Array]]:
        """Loops (k, 2) of the outline in plan [mm], flat and formed."""
        profile = boundary_profile(self.surface)
        return [loop[:, :2] for loop in profile.initial], [loop[:, :2] for loop in profile.deformed]

    @cached_property
    def outline_change_mm(self) -> float:
        """Mean distance in plan between the flat and the formed outline."""
        return outline_distances(*self.outlines).mean_mm

    @cached_property
    def outline_form_change_mm(self) -> float:
        """The same against the flat outline brought to the formed one's area and place: change of form without size."""
        flat, formed = self.outlines
        scale = np.sqrt(outline_area(formed) / outline_area(flat))
        ends = [np.concatenate([_even(loop) for loop in loops]).mean(axis=0) for loops in (flat, formed)]
        return outline_distances([ends[1] + scale * (loop - ends[0]) for loop in flat], formed).mean_mm

    @cached_property
    def shear_rms_deg(self) -> float:
        """Root mean square of the shear angle, weighted by area."""
        angle, area = shear_angle(self.surface), cell_area(self.surface)
        return float(np.sqrt((angle**2 * area).sum() / area.sum()))

    @cached_property
    def fibre_directions_deg(self) -> tuple[float, float]:
        """Directions of both families on the flat ply, 0 to 180 deg from x."""
        found = []
        for axis in (1, 2):
            step = np.nanmean(np.diff(self.surface.x0[:2], axis=axis).reshape(2, -1), axis=1)
            found.append(float(np.degrees(np.arctan2(step[1], step[0])) % 180.0))
        return found[0], found[1]


@dataclass(frozen=True, eq=False)
class Formed:
    """One finished run."""

    name: str
    plies: tuple[FormedPly, ...]  # bottom first
    axis_xy: tuple[float, float]  # of the tool [mm]

    @property
    def wrinkles(self) -> list[Row]:
        """Wrinkles of all plies."""
        return [row for ply in self.plies for row in ply.wrinkles]


def read_formed(folder: Path) -> Formed:
    """Read a run's folder. Raises UsageError for what is not there."""
    run = open_run(folder)
    case = case_from_dict(tomllib.loads(run.resolved_text))
    tables = run.metrics["plies"]
    if any("wrinkled_area_percent" not in table for table in tables):
        raise UsageError(f"{folder}: its wrinkles were not measured", "a kinematic net has none")
    rows = run.wrinkles()
    plies = tuple(
        FormedPly(formed_ply(run, name), [row for row in rows if row["ply"] == name],
                  float(table["wrinkled_area_percent"]))
        for name, table in zip(plies_of(run), tables, strict=True)
    )  # fmt: skip
    return Formed(folder.name, plies, (0.0, 0.0) if case.tool is None else case.tool.position_mm)


def _even(loop: Array) -> Array:
    """Points evenly along a closed loop, so that their mean is its middle whatever its points are."""
    closed = np.vstack([loop, loop[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    places = np.arange(400) / 400 * arc[-1]
    return np.stack([np.interp(places, arc, column) for column in closed.T], axis=1)
