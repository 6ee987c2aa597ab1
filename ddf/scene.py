"""A scene: what a run works on, assembled from a case by `build`, and read by all that observes it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ddf.case import Case
from ddf.half import Half
from ddf.loads.path import LoadPath
from ddf.mesh.diaphragm import DiaphragmMesh
from ddf.mesh.distance import DistanceField
from ddf.mesh.ply import PlyMesh
from ddf.mesh.tool import TriangleMesh
from ddf.model import Model, State

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class SheetInfo:
    """A sheet as people know it."""

    name: str
    kind: str  # "ply" or "diaphragm"
    thickness_mm: float
    mass_scaling: float
    true_mass: float  # without scaling [tonne]
    added_mass: float  # [tonne]
    mesh: PlyMesh | DiaphragmMesh


@dataclass(frozen=True)
class Scene:
    """Case, model and initial state, with what is needed to interpret them."""

    case: Case
    model: Model
    state: State
    sheets: tuple[SheetInfo, ...]  # in the model's order: bottom diaphragm, plies, top diaphragm
    path: LoadPath
    base_z: float  # tool's base at zero lift [mm]
    tool_mesh: TriangleMesh | None
    tool_field: DistanceField | None
    step_limit: float  # stable step [s], safety included
    first_step_s: float  # step [s] of the model as it was built; a run may cut it
    half: Half | None = None  # of a half model: the whole that it stands for
    symmetry: str = ""  # why a scene that might be computed by half is not

    def whole(self, places: bool = True) -> Scene:
        """The whole scene as it is now, for all that observes it; of a half model in arrays of its own.

        places: whether anybody looks at the places of contact, which take longest.
        """
        if self.half is None:
            return self
        model = self.half.whole._replace(dt=self.model.dt)
        return replace(self, model=model, state=self.half.unfold(self.model, self.state, places), half=None)

    @property
    def steps(self) -> int:
        """Steps of the whole process."""
        first, begin = self.state.clock[2:4]
        return int(first) + int(np.ceil((self.path.duration - begin) / self.model.dt - 1e-9))

    @property
    def ply_sheets(self) -> list[int]:
        """Model numbers of the plies, bottom first."""
        return [k for k, s in enumerate(self.sheets) if s.kind == "ply"]

    def tool_z(self, time: float) -> float:
        """Height of the tool's base [mm] at a time."""
        return self.base_z + self.path.at(time)["tool_lift_mm"]

    def obstacle_distance(self, points: FloatArray, time: float) -> FloatArray:
        """Distance [mm], (k,), of points (k, 3) from the tool and its platform at a time."""
        shifted = np.asarray(points, dtype=float) - [0.0, 0.0, self.tool_z(time)]
        if self.tool_field is None:
            return shifted[:, 2]
        return self.tool_field.platform_distance(shifted)
