"""A ply of a finished run as the metrics and pictures take it, from its frames and its boundary profile alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.errors import UsageError
from ddf.mesh.outline import cell_fractions
from ddf.metrics import PlySurface
from ddf.output.results import FinishedRun

Array = NDArray[np.float64]


def plies_of(run: FinishedRun) -> list[str]:
    """Names of a run's plies, the bottom one first."""
    return [str(ply["ply"]) for ply in run.metrics["plies"]]


def formed_ply(run: FinishedRun, ply: str, frame: int = -1) -> PlySurface:
    """A ply at one of its frames, left out: the last. Raises UsageError for what is not there.

    The first frame is taken as the flat ply: it gives the lattice's origin and spacing, and with them the
    profile's initial points their grid coordinates.
    """
    flat, formed = run.read_frame(ply, 0), run.read_frame(ply, frame)
    if "row" not in flat or "row" not in formed:
        raise UsageError(f"{run.path}: the frames of {ply} do not say where their points are on the lattice")
    shape = (int(flat["row"].max()) + 1, int(flat["col"].max()) + 1)
    x0, x = _grid(flat, shape), _grid(formed, shape)
    origin, along, across = _lattice(flat)
    exists = np.zeros((shape[0] - 1, shape[1] - 1), bool)
    corners = formed["cells"]
    exists[formed["row"][corners].min(axis=1), formed["col"][corners].min(axis=1)] = True
    outline = _outline(run, ply, origin, np.stack([along, across], axis=1))
    fraction = exists.astype(float)
    if outline:
        inside = [np.clip(loop, 0.0, np.array(exists.shape)) for loop in outline]
        fraction = np.where(exists, np.clip(cell_fractions(inside, exists.shape), 1e-6, 1.0), 0.0)
    return PlySurface(
        name=ply, x=x, x0=x0, spacing=(float(np.linalg.norm(along)), float(np.linalg.norm(across))),
        active=np.isfinite(x[0]), cell_fraction=fraction, outline=outline,
    )  # fmt: skip


def _grid(frame: dict[str, NDArray], shape: tuple[int, int]) -> Array:
    """Points of a frame at their places on the lattice, (3, n, m); NaN where there is none."""
    x = np.full((3, *shape), np.nan)
    x[:, frame["row"], frame["col"]] = frame["points"].T
    return x


def _lattice(flat: dict[str, NDArray]) -> tuple[Array, Array, Array]:
    """Place in plan of node (0, 0) and the steps along rows and columns [mm], by least squares."""
    design = np.stack([np.ones(len(flat["row"])), flat["row"], flat["col"]], axis=1)
    solution = np.linalg.lstsq(design, flat["points"][:, :2], rcond=None)[0]
    return solution[0], solution[1], solution[2]


def _outline(run: FinishedRun, ply: str, origin: Array, steps: Array) -> list[Array]:
    """Loops of the boundary in grid coordinates, (k, 2) each; none where the run has no profile."""
    try:
        profile = run.profile(ply)
    except UsageError:
        return []
    points = np.stack([profile["x0_mm"], profile["y0_mm"]], axis=1) - origin
    grid = np.linalg.solve(steps, points.T).T
    return [grid[profile["loop"] == number] for number in np.unique(profile["loop"])]
