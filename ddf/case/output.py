"""What a run writes, and how often."""

from __future__ import annotations

from pydantic import Field

from ddf.case.base import Section


class Output(Section):
    """Frames, tables, pictures and checkpoints of the run folder."""

    frames_per_stage: int = Field(
        default=4, ge=1, le=1000, description="Frames written in each stage, the last at its end."
    )
    history_interval_steps: int = Field(
        default=200, ge=1, le=1_000_000, description="Outer steps between two rows of history.csv."
    )
    vtu: bool = Field(default=True, description="Whether to write the frames for ParaView.")
    pictures: bool = Field(default=True, description="Whether to draw the pictures.")
    checkpoint_interval_s: float = Field(
        default=30.0, gt=0, le=86_400, description="Wall time between two checkpoints [s]."
    )
    wrinkle_threshold_mm: float = Field(
        default=0.4, gt=0, le=100, description="Smallest height of what counts as a wrinkle [mm] (inferred)."
    )
