"""One reason to stop a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Alarm:
    """What is wrong in which sheet, at which node and place, its likely cause and the key to change."""

    sheet: str
    node: tuple[int, int]
    place_mm: tuple[float, float, float]
    problem: str
    cause: str
    key: str

    def __str__(self) -> str:
        x, y, z = self.place_mm
        return (
            f"{self.problem} in {self.sheet} at node {self.node}, near x {x:.1f}, y {y:.1f}, z {z:.1f} mm; "
            f"likely cause: {self.cause}; change {self.key}"
        )


def alarm_at(sheet: str, x: np.ndarray, node: tuple[int, int], problem: str, cause: str, key: str) -> Alarm:
    """Alarm at a node of a sheet whose nodes are at x (3, n, m) [mm]."""
    i, j = int(node[0]), int(node[1])
    px, py, pz = (float(c) for c in x[:, i, j])
    return Alarm(sheet, (i, j), (px, py, pz), problem, cause, key)
