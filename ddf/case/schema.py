"""The typed case: all its sections in one immutable model.

`Case` checks each value; what ties several values together (one of two keys, a ply inside the frame, a
material of the right kind) is checked where a case is loaded, so build one with `ddf.case.load`.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from ddf.case.base import Section
from ddf.case.diaphragms import Diaphragms, Frame, Friction
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
    "Material",
    "OgdenTerm",
    "Output",
    "Ply",
    "Process",
    "ShearTable",
    "Solver",
    "Stage",
    "Tool",
    "WovenMaterial",
]


class Case(Section):
    """Everything that defines a run. Lengths in mm, angles in deg, absolute pressures in kPa, times in s."""

    title: str = Field(default="", max_length=500, description="What the case is, for reports.")
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
    process: Process = Field(description="Pressures and lift over time.")
    solver: Solver = Field(default=Solver(), description="The explicit solver.")
    output: Output = Field(default=Output(), description="What is written.")

    @model_validator(mode="before")
    @classmethod
    def _name_plies(cls, raw: Any) -> Any:
        return with_ply_names(raw)


def with_ply_names(raw: Any) -> Any:
    """Give each ply without a name its position: ply-1 is the bottom one."""
    if not isinstance(raw, dict) or not isinstance(raw.get("plies"), list):
        return raw
    plies = [
        {"name": f"ply-{place}", **ply} if isinstance(ply, dict) else ply
        for place, ply in enumerate(raw["plies"], start=1)
    ]
    return raw | {"plies": plies}
