"""Settings of the kinematic model."""

from __future__ import annotations

from pydantic import Field

from ddf.case.base import Point, Section


class Kinematic(Section):
    """Draping as a pin-jointed net: used with model = "kinematic" only."""

    start_mm: Point | None = Field(
        default=None,
        description="Where the net starts, in plan from the frame's centre [mm]; left out: each ply's centre.",
    )
    offset_mm: float = Field(
        default=0.0, ge=0, le=50, description="Distance of the plies' mid-surface from tool and platform [mm]."
    )
    foot_radius_mm: float = Field(
        default=10.0,
        ge=0,
        le=100,
        description="Radius of the hollow in which a ply crosses the tool's foot [mm] (inferred: it bridges there).",
    )
    locking_deg: float = Field(
        default=50.0,
        gt=0,
        lt=90,
        description="Shear angle counted as locked in the metrics [deg] (inferred: plain weaves lock at 40 to 60).",
    )
