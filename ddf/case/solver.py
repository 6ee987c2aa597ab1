"""Settings of the explicit solver."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ddf.case.base import Section


class Solver(Section):
    """Time step, damping, contact stiffness and the limits that stop a run. All inferred but mass damping."""

    mass_scaling: float | None = Field(
        default=None,
        ge=1,
        le=1e6,
        description="Factor on the plies' mass (inferred); left out without target_step_s: what the diaphragms' step "
        "asks, 9.6 times diaphragm_mass_scaling at most. Either this or target_step_s.",
    )
    target_step_s: float | None = Field(
        default=None,
        gt=0,
        le=1e-2,
        description="Stable step of the plies to reach by adding mass to them [s]. Either this or mass_scaling.",
    )
    diaphragm_mass_scaling: float = Field(
        default=2.5, ge=1, le=1e6, description="Factor on the diaphragms' mass (inferred)."
    )
    mass_damping_1_s: float = Field(default=30.0, ge=0, le=1e5, description="Mass damping [1/s].")
    step_safety: float = Field(default=0.85, gt=0, le=1, description="Step as a fraction of the stable one.")
    step_s: float | None = Field(
        default=None, gt=0, le=1e-2, description="Time step [s]; left out: the stable one times step_safety."
    )
    step_cuts: int = Field(
        default=2,
        ge=0,
        le=10,
        description="Times that a run which a guard would stop goes back to its last good state and on with 0.7 of the "
        "step; 0: it stops.",
    )
    contact_stiffness_N_mm3: float = Field(
        default=3.0, gt=0, le=1e4, description="Penalty between layers [N/mm3]: pressure per penetration."
    )
    tool_contact_stiffness_N_mm3: float = Field(
        default=75.0, gt=0, le=1e4,
        description="Penalty on the tool [N/mm3]: pressure per penetration; 3 times beyond 0.1, 6 beyond 0.15 mm.",
    )  # fmt: skip
    in_plane_pressure: bool = Field(
        default=True, description="Contact pressure acts in the plane of the sheets too, as in solid layers."
    )
    self_contact: bool = Field(default=True, description="Sheets that fold touch themselves, with friction.")
    contact_damping: float = Field(
        default=0.2, ge=0, le=2, description="Damping of layers on each other, fraction of critical."
    )
    symmetry: Literal["off", "auto"] = Field(
        default="off",
        description="'auto': a scene that is its own mirror image in x = 0 or y = 0 is computed by half, and stays "
        "symmetric (`ddf check` says so, or why not); 'off': all of it, free to buckle to one side.",
    )
    hourglass: float = Field(
        default=0.05,
        ge=0,
        le=1,
        description="Hourglass coefficient of shell-membrane plies (inferred): 1 is about full integration.",
    )
    fibre_damping: float = Field(
        default=0.06,
        ge=0,
        le=1,
        description="Damping of the fibres' stretching in shell-membrane plies, fraction of critical at the highest "
        "frequency (inferred; linear bulk viscosity).",
    )
    threads: int | None = Field(
        default=None, ge=1, le=1024, description="Threads; left out: as many as the machine has."
    )
    energy_error_limit_percent: float = Field(
        default=10.0,
        gt=0,
        le=1000,
        description="Energy error beyond which the run stops with exit code 3 [%].",
    )
    check_interval_steps: int = Field(
        default=50, ge=1, le=1_000_000, description="Steps between two checks of energy and stability."
    )
