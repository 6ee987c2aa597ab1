"""The process: pressures and tool lift over time, in stages or as measured breakpoints."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ddf.case.base import Name, Section

Pressure = Annotated[float, Field(ge=0, le=1000)]
Lift = Annotated[float, Field(ge=0, le=2000)]
Pressures = Annotated[tuple[Pressure, ...], Field(strict=False, min_length=2, max_length=10_000)]


class Stage(Section):
    """One stage: the values reached at its end; a value left out stays as it was."""

    name: Name = Field(description="Unique name, used in file names.")
    duration_s: float = Field(ge=1e-9, le=3600, description="Duration in process time [s].")
    cavity_pressure_kPa: Pressure | None = Field(
        default=None, description="Absolute pressure between the diaphragms at the end [kPa]; left out: held."
    )
    box_pressure_kPa: Pressure | None = Field(
        default=None, description="Absolute pressure in the box below at the end [kPa]; left out: held."
    )
    tool_lift_mm: Lift | None = Field(
        default=None, description="Lift of the platform above its start at the end [mm]; left out: held."
    )
    ramp: Literal["smooth", "linear"] = Field(
        default="smooth", description="How the values change: 'smooth' starts and ends at rest."
    )
    mass_damping_1_s: float | None = Field(
        default=None,
        ge=0,
        le=1e5,
        description="Mass damping during the stage [1/s]; left out: that of [solver].",
    )


class Breakpoints(Section):
    """Histories as lists over the same times; a list left out holds its start value."""

    time_s: Annotated[
        tuple[Annotated[float, Field(ge=0, le=36_000)], ...],
        Field(strict=False, min_length=2, max_length=10_000),
    ] = Field(description="Times [s], strictly ascending from 0.")
    cavity_pressure_kPa: Pressures | None = Field(
        default=None, description="Absolute pressure between the diaphragms [kPa]; left out: atmosphere."
    )
    box_pressure_kPa: Pressures | None = Field(
        default=None, description="Absolute pressure in the box [kPa]; left out: atmosphere."
    )
    tool_lift_mm: Annotated[tuple[Lift, ...], Field(strict=False, min_length=2, max_length=10_000)] | None = Field(
        default=None, description="Lift of the platform above its start [mm]; left out: 0."
    )
    ramp: Literal["smooth", "linear"] = Field(
        default="linear",
        description="How the values change between two times: 'smooth' rests at each of them.",
    )


class Process(Section):
    """The loading: starts with cavity and box at atmosphere and lift 0. Either stages or breakpoints."""

    atmosphere_kPa: float = Field(default=101.325, gt=0, le=1000, description="Pressure of the surroundings [kPa].")
    stages: Annotated[tuple[Stage, ...], Field(strict=False, min_length=1, max_length=100)] | None = Field(
        default=None, description="Stages in order. Either this or breakpoints."
    )
    breakpoints: Breakpoints | None = Field(default=None, description="Histories in lists. Either this or stages.")
    settled_percent: float = Field(
        default=0.01, ge=0, le=1,
        description="A last stage in which no load changes ends once kinetic energy is less than this share of the "
        "internal [%]; 0: never early.",
    )  # fmt: skip

    @property
    def duration_s(self) -> float:
        """Total process time [s]."""
        if self.breakpoints is not None:
            return self.breakpoints.time_s[-1]
        return sum(stage.duration_s for stage in self.stages or ())

    @property
    def largest_lift_mm(self) -> float:
        """Largest lift of the platform [mm]."""
        if self.breakpoints is not None:
            return max(self.breakpoints.tool_lift_mm or (0.0,))
        return max((stage.tool_lift_mm or 0.0 for stage in self.stages or ()), default=0.0)
