"""The tool under the diaphragms, standing on a flat platform that is lifted."""

from __future__ import annotations

import math
from typing import Any, Literal

from pydantic import Field, model_validator

from ddf.case.base import Point, Section

DEFAULT_TETRAHEDRON_HEIGHT_MM = 82.0
TETRAHEDRA = ("cube-corner-tetrahedron", "regular-tetrahedron")

# Keys that a shape needs, and those it may have besides; position_mm and turn_deg go with every shape.
REQUIRED_KEYS: dict[str, tuple[str, ...]] = {
    "cube-corner-tetrahedron": (),
    "regular-tetrahedron": (),
    "hemisphere": ("radius_mm",),
    "box": ("length_mm", "width_mm", "height_mm"),
    "cylinder": ("radius_mm", "height_mm"),
    "file": ("file",),
}
OPTIONAL_KEYS: dict[str, tuple[str, ...]] = {
    "cube-corner-tetrahedron": ("height_mm", "fillet_mm"),
    "regular-tetrahedron": ("height_mm", "fillet_mm"),
    "hemisphere": ("fillet_mm",),
    "box": ("fillet_mm",),
    "cylinder": ("fillet_mm",),
    "file": ("unit",),
}
COMMON_KEYS = ("shape", "position_mm", "turn_deg")


class Tool(Section):
    """The tool's shape and its place on the platform."""

    shape: Literal["cube-corner-tetrahedron", "regular-tetrahedron", "hemisphere", "box", "cylinder", "file"] = Field(
        description="Which solid (inferred for the published tool: only its height is known)."
    )
    height_mm: float | None = Field(
        default=None,
        gt=0,
        le=2000,
        description="Height [mm]: tetrahedra "
        "(left out: 82; to the sharp apex, of which the fillet takes off (sqrt(3) - 1) fillet_mm from the cube corner "
        "and 2 fillet_mm from the regular one), box, cylinder.",
    )
    radius_mm: float | None = Field(default=None, gt=0, le=2000, description="Radius [mm]: hemisphere, cylinder.")
    length_mm: float | None = Field(default=None, gt=0, le=5000, description="Length along x before turning [mm]: box.")
    width_mm: float | None = Field(default=None, gt=0, le=5000, description="Width along y before turning [mm]: box.")
    fillet_mm: float = Field(
        default=5.0,
        ge=0,
        le=50,
        description="Radius of the rounded edges [mm], any shape but file (inferred).",
    )
    file: str | None = Field(
        default=None,
        description="STEP or STL file, relative to the case file, or a shipped one by its name without suffix: "
        "shape 'file'. Made absolute.",
    )
    unit: Literal["mm", "m", "inch"] = Field(default="mm", description="Unit of length in the file: shape 'file'.")
    position_mm: Point = Field(default=(0.0, 0.0), description="Tool's centre from the frame's centre [mm].")
    turn_deg: float = Field(default=0.0, ge=-360, le=360, description="Turn about the vertical [deg].")

    @model_validator(mode="before")
    @classmethod
    def _default_height(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and raw.get("shape") in TETRAHEDRA and raw.get("height_mm") is None:
            return raw | {"height_mm": DEFAULT_TETRAHEDRON_HEIGHT_MM}
        return raw

    def used_keys(self) -> tuple[str, ...]:
        """Return the keys that mean something for this shape."""
        return (*COMMON_KEYS, *REQUIRED_KEYS[self.shape], *OPTIONAL_KEYS[self.shape])

    def footprint_radius_mm(self) -> float | None:
        """Return the radius [mm] of the circle about `position_mm` that holds the base; None for a file.

        A cube corner of height h has a base of edge h sqrt(6), a regular tetrahedron h sqrt(3/2); the
        circle about an equilateral triangle of edge a has the radius a/sqrt(3).
        """
        if self.shape == "cube-corner-tetrahedron" and self.height_mm is not None:
            return self.height_mm * math.sqrt(2.0)
        if self.shape == "regular-tetrahedron" and self.height_mm is not None:
            return self.height_mm / math.sqrt(2.0)
        if self.shape == "box" and self.length_mm is not None and self.width_mm is not None:
            return 0.5 * math.hypot(self.length_mm, self.width_mm)
        return self.radius_mm
