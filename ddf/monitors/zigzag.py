"""Wrinkles as short as the grid can show: nodes that go up and down in turn.

Such a zigzag is what a wrinkle too short for the elements turns into; the metrics, which look for ridges several
elements wide, do not see it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddf.model import sheet_scalars, sheet_vectors
from ddf.scene import Scene

KINK = 0.26
"""Change of direction at a node, about 15 degrees, from which it counts as kinked."""


def zigzag_share(scene: Scene) -> float:
    """Share of a ply's nodes that are kinked, and their two neighbours along a fibre the other way; the worst ply."""
    worst = 0.0
    for k in scene.ply_sheets:
        x = sheet_vectors(scene.model, scene.state.x, k)
        active = sheet_scalars(scene.model, scene.model.mass, k) > 0
        count = sum(_zigzags(along, there) for along, there in ((x, active), (x.swapaxes(1, 2), active.T)))
        worst = max(worst, count / max(int(active.sum()), 1))
    return worst


def _zigzags(x: NDArray[np.float64], active: NDArray[np.bool_]) -> int:
    """Nodes of x (3, n, m) in a zigzag along the first grid direction."""
    if x.shape[1] < 5:
        return 0
    way = np.diff(x, axis=1)
    way /= np.maximum(np.linalg.norm(way, axis=0), 1e-30)
    kink = np.diff(way, axis=1)  # (3, n - 2, m), of nodes 1 .. n - 2
    size = np.where(active[:-2] & active[1:-1] & active[2:], np.linalg.norm(kink, axis=0), 0.0)
    turned = (kink[:, :-1] * kink[:, 1:]).sum(axis=0) < -0.5 * size[:-1] * size[1:]
    both = turned & (size[:-1] > KINK) & (size[1:] > KINK)
    return int((both[:-1] & both[1:]).sum())
