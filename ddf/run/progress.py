"""What a run tells while it goes on, and how it ended."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ddf.monitors.audit import Check


def percent(value: float) -> str:
    """Two digits, and no power of ten for what is large."""
    return f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"


@dataclass
class Progress:
    """What a run tells while it goes on."""

    stage: str
    step: int
    steps: int
    time_s: float
    step_s: float
    energy_error_percent: float
    kinetic_percent: float
    elapsed_s: float
    remaining_s: float

    def __str__(self) -> str:
        return (
            f"{self.stage:>16}  {self.time_s:8.5f} s  step {self.step}/{self.steps}  dt {self.step_s:.2e} s  "
            f"energy error {self.energy_error_percent:+.2f} %  kinetic/internal {percent(self.kinetic_percent)} %  "
            f"elapsed {self.elapsed_s:.0f} s  left {self.remaining_s:.0f} s"
        )


@dataclass
class RunResult:
    """How a run ended."""

    folder: Path
    stop_reason: str  # "finished" or "interrupted"
    step: int
    time_s: float
    wall_s: dict[str, float]
    checks: list[Check] = field(default_factory=list)
    plies: list[dict[str, Any]] = field(default_factory=list)  # metrics, bottom ply first
    notes: list[str] = field(default_factory=list)


class Stopwatch:
    """Wall time by phase."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, phase: str) -> Iterator[None]:
        """Add the wall time of the block to its phase."""
        start = clock.perf_counter()
        try:
            yield
        finally:
            self.seconds[phase] = self.seconds.get(phase, 0.0) + clock.perf_counter() - start
