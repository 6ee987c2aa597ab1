"""Materials of a case: woven plies and hyperelastic diaphragms."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ddf.case.base import NonNegativePair, PositivePair, Section
from ddf.case.preset_data import PRESET_DATA


class ShearTable(Section):
    """A measured shear curve: normalised shear force of a picture frame against the shear angle."""

    angle_deg: Annotated[
        tuple[Annotated[float, Field(ge=0, lt=90)], ...], Field(strict=False, min_length=2, max_length=1000)
    ] = Field(description="Shear angles [deg]: start at 0 and ascend.")
    normalised_shear_force_N_mm: Annotated[
        tuple[Annotated[float, Field(ge=-100, le=100)], ...],
        Field(strict=False, min_length=2, max_length=1000),
    ] = Field(description="Shear force for each angle [N/mm], thickness x shear stress: starts at 0.")


class WovenMaterial(Section):
    """A woven fabric of two fibre families, stiff in tension, soft in shear and in bending."""

    kind: Literal["woven"] = Field(description="What the material is.")
    base: str | None = Field(default=None, description="Preset whose values hold where a key is left out.")
    thickness_mm: float = Field(gt=0, le=20, description="Thickness of the ply [mm].")
    areal_density_gsm: float = Field(gt=0, le=20_000, description="Mass per area [g/m2].")
    membrane_modulus_N_mm: PositivePair = Field(
        description="Tensile modulus x thickness [N/mm]: one number, or one for each fibre family."
    )
    bending_rigidity_Nmm: NonNegativePair = Field(
        description="Bending rigidity per mm of width [N mm]: one number, or one for each fibre family."
    )
    in_plane_bending_Nmm: float | None = Field(
        default=None,
        ge=0,
        le=1e6,
        description="Rigidity of the tows against bending in the ply's plane, per mm of width [N mm]; left out: the "
        "least of bending_rigidity_Nmm, that of fibres which bend one by one, in whatever direction (inferred).",
    )
    transverse_shear_N_mm: float = Field(
        default=20.0,
        gt=0,
        le=1e6,
        description="Transverse shear stiffness per mm of width [N/mm], K11 = K22; of shell-membrane plies only.",
    )
    shear_law: Literal["published", "monotone"] = Field(
        default="monotone",
        description="'published' takes the shear curve as given, unstable wherever its slope is negative; "
        "'monotone' takes the closest curve whose slope never falls below the floor.",
    )
    shear_modulus_polynomial_MPa: (
        Annotated[
            tuple[Annotated[float, Field(ge=-1e6, le=1e6)], ...],
            Field(strict=False, min_length=1, max_length=12),
        ]
        | None
    ) = Field(
        default=None,
        description="Tangent shear modulus [MPa], ascending powers of the shear angle in rad. "
        "Either this or shear_table.",
    )
    shear_table: ShearTable | None = Field(
        default=None, description="Measured shear curve. Either this or shear_modulus_polynomial_MPa."
    )
    shear_modulus_floor_MPa: float = Field(
        default=0.002,
        ge=0,
        le=10,
        description="Smallest tangent shear modulus of the monotone law [MPa] (inferred: small against "
        "every measured slope, large enough to be stable).",
    )

    @property
    def in_plane_rigidity(self) -> float:
        """`in_plane_bending_Nmm` [N mm], or what it is where it is left out."""
        return min(self.bending_rigidity_Nmm) if self.in_plane_bending_Nmm is None else self.in_plane_bending_Nmm

    @model_validator(mode="before")
    @classmethod
    def _start_from_base(cls, raw: Any) -> Any:
        return merged_with_base(raw)


class OgdenTerm(Section):
    """One term of the Ogden energy."""

    mu_MPa: float = Field(ge=-1000, le=1000, description="Modulus mu of the term [MPa].")
    alpha: float = Field(ge=-50, le=50, description="Exponent alpha of the term, not 0.")


class HyperelasticMaterial(Section):
    """An incompressible rubber after Ogden."""

    kind: Literal["hyperelastic"] = Field(description="What the material is.")
    base: str | None = Field(default=None, description="Preset whose values hold where a key is left out.")
    ogden: Annotated[tuple[OgdenTerm, ...], Field(strict=False, min_length=1, max_length=6)] = Field(
        description="Terms of the Ogden energy."
    )
    ogden_form: Literal["abaqus", "classical"] = Field(
        default="abaqus",
        description="'abaqus': W = sum 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3); "
        "'classical': W = sum mu/alpha (...).",
    )
    density_kg_m3: float = Field(
        default=1100.0, ge=50, le=20_000, description="Density [kg/m3] (inferred: usual for silicone)."
    )

    @model_validator(mode="before")
    @classmethod
    def _start_from_base(cls, raw: Any) -> Any:
        return merged_with_base(raw)

    @property
    def abaqus_terms(self) -> tuple[tuple[float, float], ...]:
        """Pairs (mu [MPa], alpha) in the Abaqus form: the classical mu is multiplied by alpha/2."""
        if self.ogden_form == "abaqus":
            return tuple((term.mu_MPa, term.alpha) for term in self.ogden)
        return tuple((0.5 * term.mu_MPa * term.alpha, term.alpha) for term in self.ogden)


Material = Annotated[WovenMaterial | HyperelasticMaterial, Field(discriminator="kind")]


def merged_with_base(raw: Any) -> Any:
    """Lay the keys of `raw` over those of its preset `base`; a shear curve given replaces the preset's."""
    if not isinstance(raw, dict) or not isinstance(raw.get("base"), str):
        return raw
    preset = PRESET_DATA.get(raw["base"])
    if preset is None or preset["kind"] != raw.get("kind"):
        return raw
    merged = dict(preset)
    if raw.get("shear_table") is not None and raw.get("shear_modulus_polynomial_MPa") is None:
        merged.pop("shear_modulus_polynomial_MPa", None)
    return merged | raw
