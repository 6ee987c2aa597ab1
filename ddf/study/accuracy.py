"""How far a rung's result is from the finest one's, and what it cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ddf.compare.runs import PlyComparison, compare_runs
from ddf.compare.sites import Site
from ddf.output.results import open_run


@dataclass(frozen=True)
class Errors:
    """A result against the finest, all plies together; NaN where there is nothing to compare."""

    outline_mean_mm: float  # mean distance of the formed outlines in plan
    outline_largest_mm: float
    wrinkle_position_mm: float  # mean distance of wrinkles at the same site, by amplitude
    wrinkle_amplitude_mm: float  # root mean square over all sites; a wrinkle that only one has counts in full
    wrinkles_missing: int  # sites of the finest result that have none here
    wrinkles_extra: int
    shear_rms_deg: float


@dataclass(frozen=True)
class Cost:
    """What a run took, as it says itself."""

    steps_s: float  # wall time of the steps (of a net: of laying it), without meshing, compiling and output
    threads: int
    steps: int
    step_s: float
    memory_MiB: float  # peak, of the whole process


#: assumptions whose violation says that a result is wrong, not only that mass was added
TELLING = ("kinetic over internal energy", "energy balance error", "deepest place of a ply in the tool")


def cost_of(folder: Path) -> tuple[Cost, list[str]]:
    """What a finished run took, and which checks of its audit failed."""
    info = open_run(folder).info
    wall = info["wall_s"]
    cost = Cost(
        float(wall.get("steps", wall.get("net", float("nan")))), int(info["threads"]), int(info.get("step", 0)),
        float(info.get("step_s", float("nan"))), float(info.get("peak_memory_MiB") or float("nan")),
    )  # fmt: skip
    return cost, [check["name"] for check in info["audit"] if not check["ok"]]


def errors_of(finest: Path, run: Path, folder: Path) -> Errors:
    """Compare two finished runs; what `ddf compare` writes goes to `folder`."""
    plies = compare_runs(finest, run, folder, force=True, pictures=False).plies
    nets = any(open_run(path).info.get("model") == "kinematic" for path in (finest, run))
    return combine(plies, wrinkles=not nets)


def combine(plies: Sequence[PlyComparison], wrinkles: bool = True) -> Errors:
    """Errors over all plies. wrinkles: whether both results can have any (a net cannot)."""
    outlines = [ply.outline for ply in plies if ply.outline is not None]
    sites = [site for ply in plies for site in ply.sites] if wrinkles else []
    position, amplitude = wrinkle_errors(sites)
    shear = np.array([ply.shear.rms_deg for ply in plies])
    return Errors(
        float(np.mean([outline.mean_mm for outline in outlines])) if outlines else float("nan"),
        max((outline.largest_mm for outline in outlines), default=float("nan")),
        position, amplitude if wrinkles else float("nan"),
        sum(site.second is None for site in sites), sum(site.first is None for site in sites),
        float(np.sqrt(np.mean(shear**2))),
    )  # fmt: skip


def wrinkle_errors(sites: Sequence[Site]) -> tuple[float, float]:
    """Mean distance of the wrinkles of both [mm], NaN without any; amplitude error [mm], 0 without wrinkles."""
    if not sites:
        return float("nan"), 0.0
    height = np.array([[_amplitude(site.first), _amplitude(site.second)] for site in sites])
    away = np.array([np.nan if site.distance_mm is None else site.distance_mm for site in sites])
    both = np.isfinite(away)
    weight = height[both].mean(axis=1)
    position = float((away[both] * weight).sum() / weight.sum()) if both.any() else float("nan")
    return position, float(np.sqrt(np.mean((height[:, 1] - height[:, 0]) ** 2)))


def _amplitude(wrinkle: dict[str, Any] | None) -> float:
    return 0.0 if wrinkle is None else float(wrinkle["amplitude_mm"])
