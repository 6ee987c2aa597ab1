"""A ply's lattice laid on a tool as a net, or the place where that cannot be done."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddf.errors import DdfError
from ddf.kinematic.net import FOLDED, LAID, OFF, SHEARED, lay_net
from ddf.kinematic.surface import meet_vertical
from ddf.mesh.distance import OUTSIDE_MM, DistanceField
from ddf.mesh.ply import PlyMesh

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

REASONS = {
    SHEARED: "the fibres would have to shear by more than 90 deg",
    OFF: "no place on the tool is a fibre's spacing away from both its neighbours: the node comes off the surface",
    FOLDED: "the net folds over itself",
}


@dataclass(frozen=True)
class Drape:
    """A ply laid on the tool, all of it or as far as it went. Positions are in the tool's frame."""

    mesh: PlyMesh
    x: Array  # [mm] (3, n, m); NaN where not laid
    state: NDArray[np.int8]  # (n, m), see `net`
    start: tuple[int, int]  # node that was laid first, on the generators
    start_point: Array  # [mm] (3,)

    @property
    def laid_cells(self) -> Mask:
        """(n-1, m-1): cells of the ply whose four nodes are laid."""
        there = self.state == LAID
        whole = there[1:, 1:] & there[:-1, 1:] & there[1:, :-1] & there[:-1, :-1]
        return np.asarray(whole & (self.mesh.cell_fraction > 0))

    @property
    def laid_percent(self) -> float:
        """Part of the ply's area that is laid [%]."""
        fraction = self.mesh.cell_fraction
        return 100.0 * float(fraction[self.laid_cells].sum() / fraction.sum())

    @property
    def failed(self) -> tuple[int, int] | None:
        """The node that could not be laid, the one nearest to the start on the flat ply; None if all are laid."""
        places = np.argwhere(np.isin(self.state, list(REASONS)))
        if not len(places):
            return None
        away = (places - self.start) * np.array(self.mesh.spacing)
        i, j = places[np.argmin((away**2).sum(axis=1))]
        return int(i), int(j)


class NetError(DdfError):
    """The net cannot be laid on the whole ply; `drape` is as far as it went."""

    def __init__(self, drape: Drape) -> None:
        self.drape = drape
        failed = drape.failed
        assert failed is not None
        i, j = failed
        x, y, _ = drape.mesh.x[:, i, j]
        away = np.linalg.norm(drape.mesh.x[:, i, j] - drape.mesh.x[:, *drape.start])
        near = drape.x[:, max(i - 2, 0) : i + 3, max(j - 2, 0) : j + 3].reshape(3, -1)
        place = np.nanmean(near, axis=1) if np.isfinite(near).any() else drape.start_point
        super().__init__(
            f"{drape.mesh.name}: the net cannot be laid beyond node ({i}, {j}), at ({x:.4g}, {y:.4g}) mm on the flat "
            f"ply, near ({place[0]:.4g}, {place[1]:.4g}, {place[2]:.4g}) mm on the tool: "
            f"{REASONS[int(drape.state[i, j])]}. It came {away:.4g} mm from the start and over "
            f"{drape.laid_percent:.1f} % of the ply",
            "start elsewhere (kinematic.start_mm), turn the fibres, make the ply smaller or cut it (darts)",
        )


def drape_ply(
    mesh: PlyMesh,
    field: DistanceField | None,
    start_mm: tuple[float, float],
    offset_mm: float = 0.0,
    foot_radius_mm: float = 0.0,
) -> Drape:
    """Lay a ply on the surface `offset_mm` over tool and platform, the tool's foot hollowed by `foot_radius_mm`.

    Raises NetError where the net cannot close.

    The lattice's node nearest to `start_mm` (plan) is laid right under its place on the flat ply; from there
    family 1 runs in its direction in plan, family 2 at right angles to it, both along geodesics.
    """
    away = ((mesh.x[:2] - np.reshape(start_mm, (2, 1, 1))) ** 2).sum(axis=0)
    i0, j0 = (int(k) for k in np.unravel_index(np.argmin(np.where(mesh.active, away, np.inf)), away.shape))
    if field is None:
        values, origin, grid = np.full((2, 2, 2, 4), OUTSIDE_MM, np.float32), np.zeros(3), 1.0
    else:
        values, origin, grid = field.values, np.asarray(field.origin, dtype=np.float64), float(field.spacing)
    surface = (values, origin, grid, float(offset_mm), float(foot_radius_mm))
    px, py = float(mesh.x[0, i0, j0]), float(mesh.x[1, i0, j0])
    start = (px, py, float(meet_vertical(surface, px, py)))
    along = mesh.x[:, 1, 0] - mesh.x[:, 0, 0]
    x = np.empty(mesh.x.shape)
    state = np.empty(mesh.active.shape, np.int8)
    heading = (float(along[0]), float(along[1]), 0.0)
    lay_net(surface, start, heading, mesh.spacing, i0, j0, _needed(mesh.active, i0, j0), x, state)
    drape = Drape(mesh, x, state, (i0, j0), np.array(start))
    if drape.failed is not None:
        raise NetError(drape)
    return drape


def _needed(active: Mask, i0: int, j0: int) -> Mask:
    """(n, m): nodes of the ply and those between them and the generators, which carry the net there."""
    needed = np.zeros_like(active)
    for si in (1, -1):
        for sj in (1, -1):
            quarter = (slice(i0, None) if si > 0 else slice(i0, None, -1),
                       slice(j0, None) if sj > 0 else slice(j0, None, -1))  # fmt: skip
            outer = active[quarter][::-1, ::-1]
            needed[quarter] |= np.maximum.accumulate(np.maximum.accumulate(outer, axis=0), axis=1)[::-1, ::-1]
    return needed
