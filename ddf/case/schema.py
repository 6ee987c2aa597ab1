"""The typed case: all its sections in one immutable model.

`Case` checks each value; what ties several values together (one of two keys, a ply inside the frame, a
material of the right kind) is checked where a case is loaded, so build one with `ddf.case.load`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ddf.case.base import Section
from ddf.case.diaphragms import Diaphragms, Frame, Friction
from ddf.case.fidelity import Target
from ddf.case.kinematic import Kinematic
from ddf.case.materials import HyperelasticMaterial, Material, OgdenTerm, ShearTable, WovenMaterial
from ddf.case.output import Output
from ddf.case.plies import Ply
from ddf.case.process import Breakpoints, Process, Stage
from ddf.case.solver import Solver
from ddf.case.tool import Tool

__all__ = [
    "Breakpoints",
    "Case",
    "Diaphragms",
    "Frame",
    "Friction",
    "HyperelasticMaterial",
    "Kinematic",
    "Material",
    "OgdenTerm",
    "Output",
    "Ply",
    "Process",
    "ShearTable",
    "Solver",
    "Stage",
    "Target",
    "Tool",
    "WovenMaterial",
]


class Case(Section):
    """Everything that defines a run. Lengths in mm, angles in deg, absolute pressures in kPa, times in s."""

    title: str = Field(default="", max_length=500, description="What the case is, for reports.")
    model: Literal["forming", "kinematic"] = Field(
        default="forming",
        description="'forming': the explicit forming simulation; 'kinematic': each ply draped by itself as a "
        "pin-jointed net, in milliseconds, without diaphragms, forces and wrinkles.",
    )
    fidelity: Literal["as-given", "auto"] = Field(
        default="as-given",
        description="'as-given': elements, durations and model as they stand here; 'auto': those of the cheapest rung "
        "of a ladder that is valid for the scene and meets [target]; `ddf check` prints which and why.",
    )
    target: Target | None = Field(default=None, description="What fidelity 'auto' is to meet.")
    frame: Frame = Field(default=Frame(), description="The clamping frame.")
    diaphragms: Diaphragms = Field(default=Diaphragms(), description="Both diaphragms.")
    materials: dict[str, Material] = Field(
        default_factory=dict, description="Materials of the case's own, by name, besides the presets."
    )
    plies: Annotated[tuple[Ply, ...], Field(strict=False, min_length=1, max_length=20)] = Field(
        description="Plies, the bottom one first."
    )
    friction: Friction = Field(default=Friction(), description="Friction between layers.")
    tool: Tool | None = Field(default=None, description="The tool; left out: none.")
    process: Process = Field(description="Pressures and lift over time; model 'kinematic' does without.")
    solver: Solver = Field(default=Solver(), description="The explicit solver.")
    kinematic: Kinematic = Field(default=Kinematic(), description="The kinematic model.")
    output: Output = Field(default=Output(), description="What is written.")

    @model_validator(mode="before")
    @classmethod
    def _name_plies(cls, raw: Any) -> Any:
        return with_ply_names(raw)

    @model_validator(mode="before")
    @classmethod
    def _no_process(cls, raw: Any) -> Any:
        """A kinematic case without a process gets one that does nothing."""
        if isinstance(raw, dict) and raw.get("model") == "kinematic" and "process" not in raw:
            return raw | {"process": {"stages": [{"name": "drape", "duration_s": 1.0}]}}
        return raw


def with_ply_names(raw: Any) -> Any:
    """Give each ply without a name its position: ply-1 is the bottom one."""
    if not isinstance(raw, dict) or not isinstance(raw.get("plies"), list):
        return raw
    plies = [
        {"name": f"ply-{place}", **ply} if isinstance(ply, dict) else ply
        for place, ply in enumerate(raw["plies"], start=1)
    ]
    return raw | {"plies": plies}
