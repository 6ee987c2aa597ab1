"""The clamping frame, the two diaphragms in it, and the friction between all layers."""

from __future__ import annotations

from pydantic import Field

from ddf.case.base import Section


class Frame(Section):
    """The rectangular frame that clamps both diaphragms; its centre is the origin."""

    length_mm: float = Field(default=1320.0, ge=50, le=10_000, description="Inner length along x [mm].")
    width_mm: float = Field(default=620.0, ge=50, le=10_000, description="Inner width along y [mm].")


class Diaphragms(Section):
    """Both diaphragms: the same material, thickness and mesh above and below the plies."""

    material: str = Field(default="silicone-ogden", description="A preset or a name of [materials.*], hyperelastic.")
    thickness_mm: float = Field(default=1.5, gt=0, le=20, description="Thickness before any stretch [mm].")
    pre_stretch: float = Field(
        default=1.0,
        ge=0.9,
        le=3,
        description="Stretch in both directions when clamped; 1 is unstretched (inferred: not published).",
    )
    gap_mm: float | None = Field(
        default=None,
        gt=0,
        le=100,
        description="Gap between the inner surfaces at the start [mm]; left out: 0.2 mm + the plies' "
        "thicknesses, which is the published 0.7 mm for one ply of 0.5 mm.",
    )
    element_mm: float = Field(default=2.5, ge=0.2, le=100, description="Element size under the plies [mm].")
    element_max_mm: float = Field(
        default=30.0, ge=0.2, le=500, description="Largest element, towards the frame [mm] (inferred)."
    )
    growth: float = Field(
        default=1.3, ge=1.01, le=2, description="Largest size ratio of neighbouring elements (inferred)."
    )
    margin_mm: float = Field(
        default=15.0,
        ge=0,
        le=1000,
        description="How far the fine elements reach beyond the plies' bounding box [mm] (inferred).",
    )
    bending: bool = Field(default=True, description="Whether the diaphragms resist bending.")


class Friction(Section):
    """Coulomb coefficients between the layers."""

    ply_ply: float = Field(default=0.28, ge=0, le=5, description="Ply on ply.")
    ply_diaphragm: float = Field(default=0.52, ge=0, le=5, description="Ply on diaphragm.")
    diaphragm_diaphragm: float = Field(default=0.60, ge=0, le=5, description="Diaphragm on diaphragm.")
    diaphragm_tool: float = Field(default=0.30, ge=0, le=5, description="Diaphragm on tool and platform (inferred).")
