"""What the automatic choice of elements, durations and model is to meet."""

from __future__ import annotations

from pydantic import Field

from ddf.case.base import Section


class Target(Section):
    """What `fidelity = "auto"` is to meet: one of the two."""

    seconds: float | None = Field(
        default=None, gt=0, le=1e7,
        description="Wall time of the steps at most [s], on the threads of the run: the most accurate rung within it.",
    )  # fmt: skip
    accuracy_mm: float | None = Field(
        default=None, gt=0, le=1e3,
        description="Mean distance of the formed outlines from the finest rung's at most [mm], as far as it is known "
        "beforehand: the cheapest rung within it.",
    )  # fmt: skip
