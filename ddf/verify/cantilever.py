"""A strip of a ply clamped at one end and bent by its own weight: what both cantilever problems share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.problem import FloatArray
from ddf.verify.scenes import damped, positions, settle, with_gravity


@dataclass
class Cantilever:
    """A strip along y whose clamp ends at y = 0; weight acts along -z."""

    scene: Scene  # clamped nodes held
    length: float  # from the clamp to the tip [mm]
    rigidity: float  # bending rigidity along the strip, for damping only [N mm]
    mass: float  # areal [tonne/mm2]
    tip: NDArray[np.bool_]  # nodes at the tip, (rows, cols)
    rest: float = 1e-5  # speed that counts as rest, in lengths of the strip times its lowest frequency

    def sag(self, weight: float) -> FloatArray:
        """Bring it to rest under a weight per area [N/mm2] from where it is; returns the tip's (x, y, z) [mm].

        Mass damping is critical for the lowest frequency, bending and swinging together.
        """
        bending = 12.4 * self.rigidity / (self.mass * self.length**4)  # (1.875^4) B / (m L^4)
        lowest = np.sqrt(bending + 1.5 * weight / (self.mass * self.length))
        scene = damped(with_gravity(self.scene, (0.0, 0.0, -weight / self.mass)), 2.0 * float(lowest))
        settle(Simulation(scene), self.rest * self.length * float(lowest), 100.0 / float(lowest))
        return positions(scene)[:, self.tip].mean(axis=1)
