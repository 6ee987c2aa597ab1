"""The plies of a case, from the bottom up."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ddf.case.base import Name, Point, Polygon, Polyline, Section

Side = Annotated[float, Field(gt=0, le=10_000)]


class Ply(Section):
    """One sheet of woven fabric: outline, holes and slits about its centre, and its fibres' direction."""

    name: Name = Field(description="Unique name, used in file names; left out: ply-1, ply-2, ... by position.")
    material: str = Field(default="plain-weave-6k-320", description="A preset or a name of [materials.*], woven.")
    orientation_deg: float = Field(
        default=0.0,
        ge=-360,
        le=360,
        description="Angle of the first fibre family to the frame's x axis [deg]; the outline is not turned.",
    )
    element_mm: float = Field(default=2.0, ge=0.2, le=100, description="Element size along the fibres [mm].")
    formulation: Literal["lattice", "shell-membrane"] = Field(
        default="lattice",
        description="'lattice': bars, cells and triples along the fibres, tension implicit; 'shell-membrane': "
        "superimposed membrane and shell elements with a rate law, explicit and slow, to compare with.",
    )
    size_mm: Annotated[tuple[Side, Side], Field(strict=False)] | None = Field(
        default=None,
        description="Rectangle [length along x, width along y] in mm. Either this or polygon_mm.",
    )
    polygon_mm: Polygon | None = Field(
        default=None,
        description="Corners [x, y] in mm of the outline about the ply's centre, either way round, the first "
        "not repeated. Either this or size_mm.",
    )
    holes_mm: Annotated[tuple[Polygon, ...], Field(strict=False, max_length=100)] = Field(
        default=(), description="Polygons [x, y] in mm cut out of the ply."
    )
    slits_mm: Annotated[tuple[Polyline, ...], Field(strict=False, max_length=100)] = Field(
        default=(), description="Lines [x, y] in mm along which the ply is cut, without loss of material."
    )
    offset_mm: Point = Field(default=(0.0, 0.0), description="Ply's centre from the frame's centre [mm].")

    def outline_mm(self) -> tuple[tuple[float, float], ...]:
        """Return the outline's corners [mm] about the frame's centre, from either way of giving it."""
        dx, dy = self.offset_mm
        if self.polygon_mm is not None:
            return tuple((x + dx, y + dy) for x, y in self.polygon_mm)
        if self.size_mm is None:
            raise ValueError("a ply needs size_mm or polygon_mm")
        a, b = 0.5 * self.size_mm[0], 0.5 * self.size_mm[1]
        return ((dx - a, dy - b), (dx + a, dy - b), (dx + a, dy + b), (dx - a, dy + b))
