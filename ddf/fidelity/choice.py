"""The choice of a rung, and what it says for itself."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ddf.build import build_scene, load_path
from ddf.case import Case
from ddf.case.load import load_case
from ddf.describe import estimate_source, expected_seconds
from ddf.errors import CaseError, MeshError, UsageError
from ddf.fidelity.ladder import LADDER, MEASURED_SIDE_MM, Rung, at, shorter_side
from ddf.fidelity.rules import obstacle

NET_SECONDS = 1.0  # at most, with everything around it


@dataclass(frozen=True)
class Step:
    """A rung as this scene has it: the case on it, what it would cost and be off, why it cannot be used (or "").

    Where the rung makes no case at all, `case` is the one that asks.
    """

    rung: Rung
    case: Case
    seconds: float
    error_mm: float
    obstacle: str


@dataclass(frozen=True)
class Choice:
    """The rung chosen, and all of the ladder from the cheapest to the finest."""

    chosen: Step
    steps: tuple[Step, ...]
    why: str
    threads: int
    seconds: float | None  # what was asked for, if it was that
    symmetric: bool  # whether the scene is computed by half

    @property
    def case(self) -> Case:
        """The case on the rung, its fidelity "as-given"."""
        return self.chosen.case

    def lines(self) -> list[str]:
        """The ladder as lines of text, the chosen rung marked, and why others cannot be used."""
        there = "1 thread" if self.threads == 1 else f"{self.threads} threads"
        rows: list[tuple[str, ...]] = [("", "rung", "plies", "diaphragms", "process", "error", f"steps on {there}")]
        rows += [self._row(step) for step in self.steps]
        widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        found = [f"fidelity: {self.chosen.rung.name} ({self.why})"]
        found += [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
        ]
        found += [f"  not {step.rung.name}: {step.obstacle}" for step in self.steps if step.obstacle]
        found.append(
            "  error: mean distance of the formed outline from the finest rung's, expected from the paper's 0/90 case, "
            "where it was measured" + ("" if self._measured() else f" on a ply of {MEASURED_SIDE_MM:g} mm")
        )
        found.append(f"  times: estimates, {estimate_source()}")
        if self.chosen.rung.ply_mm is None:
            found.append("  a net shows shear and outline of a ply, no wrinkles, no friction, no bridging")
        else:
            found.append(
                "  plies are lattices, diaphragms bend, sheets touch themselves where they fold; a scene that is its "
                f"own mirror image is computed by half: this one is{'' if self.symmetric else ' not'} (all rungs)"
            )
        return found

    def record(self) -> dict[str, Any]:
        """For run.json."""
        return {
            "rung": self.chosen.rung.name, "why": self.why, "estimated_s": round(self.chosen.seconds, 1),
            "expected_error_mm": self.chosen.error_mm,
            "ladder": [
                {"rung": s.rung.name, "estimated_s": round(s.seconds, 1), "expected_error_mm": s.error_mm,
                 "obstacle": s.obstacle} for s in self.steps
            ],
        }  # fmt: skip

    def _measured(self) -> bool:
        return abs(self.steps[-1].case.plies[0].element_mm - (LADDER[-1].ply_mm or 0.0)) < 1e-9

    def _row(self, step: Step) -> tuple[str, ...]:
        mark = "->" if step is self.chosen else ""
        error = "the measure" if step.error_mm == 0.0 else f"{step.error_mm:.2g} mm"
        cost = f"about {step.seconds:.0f} s" if math.isfinite(step.seconds) else "-"
        if step.rung.ply_mm is None:
            return mark, step.rung.name, "net", "none", "none", error, f"under {NET_SECONDS:g} s"
        if step.case.fidelity == "auto":  # there is no such case
            return mark, step.rung.name, "-", "-", "-", error, cost
        ply, skin = step.case.plies[0].element_mm, step.case.diaphragms.element_mm
        process = f"{load_path(step.case).duration:.3g} s"
        return mark, step.rung.name, f"{ply:g} mm", f"{skin:g} mm", process, error, cost


def choose(case: Case, threads: int, earlier: Path | None = None) -> Choice:
    """Choose the rung of a case whose fidelity is "auto".

    `earlier`: folder of a run that is gone on with, whose rung is kept. Raises UsageError where no rung is valid.
    """
    target = case.target
    assert target is not None
    scale = shorter_side(case) / MEASURED_SIDE_MM
    symmetric = _is_symmetric(case)
    steps = tuple(_step(case, rung, threads, scale, symmetric) for rung in LADDER)
    valid = [step for step in steps if not step.obstacle]
    if not valid:
        reasons = "\n".join(f"  {step.rung.name}: {step.obstacle}" for step in steps)
        raise UsageError(f"no rung of the ladder is valid for this case:\n{reasons}", "fidelity = 'as-given'")
    kept = _kept(valid, earlier)
    if kept is not None:
        return Choice(kept, steps, "as the run was begun", threads, target.seconds, symmetric)
    if target.seconds is not None:
        best, why = _closest(valid, target.seconds)
    else:
        assert target.accuracy_mm is not None
        best, why = _cheapest(valid, target.accuracy_mm)
    return Choice(best, steps, why, threads, target.seconds, symmetric)


def _closest(valid: list[Step], seconds: float) -> tuple[Step, str]:
    quick = [step for step in valid if step.seconds <= seconds]
    if quick:
        return min(quick, key=lambda step: step.error_mm), f"the closest within {seconds:g} s"
    return min(valid, key=lambda step: step.seconds), f"the cheapest: none that is valid takes {seconds:g} s at most"


def _cheapest(valid: list[Step], error_mm: float) -> tuple[Step, str]:
    near = [step for step in valid if step.error_mm <= error_mm]
    if near:
        return min(near, key=lambda step: step.seconds), f"the cheapest within {error_mm:g} mm"
    return min(valid, key=lambda step: step.error_mm), f"the closest: none that is valid is within {error_mm:g} mm"


def _is_symmetric(case: Case) -> bool:
    """Whether the scene is its own mirror image, and computed by half."""
    for rung in LADDER:
        if rung.ply_mm is not None:
            with suppress(CaseError, MeshError):
                return build_scene(at(case, rung)).half is not None
    return False


def _step(case: Case, rung: Rung, threads: int, scale: float, symmetric: bool) -> Step:
    error = round(scale * rung.error_mm, 4)
    try:
        there = at(case, rung)
    except CaseError as refusal:
        return Step(rung, case, float("nan"), error, "; ".join(fault.problem for fault in refusal.faults))
    why = obstacle(there, rung)
    seconds = math.nan if why else NET_SECONDS
    if not why and rung.ply_mm is not None:  # the tool costs next to nothing in a step, and seconds to mesh
        solver = there.solver if symmetric else there.solver.model_copy(update={"symmetry": "off"})
        bare = there.model_copy(update={"tool": None, "solver": solver})
        seconds = expected_seconds(build_scene(bare), threads)
    return Step(rung, there, seconds, error, why)


def _kept(valid: list[Step], earlier: Path | None) -> Step | None:
    """The step on which an earlier run in the folder stands."""
    file = None if earlier is None else earlier / "case.resolved.toml"
    if file is None or not file.is_file():
        return None
    begun = load_case(file)
    return next((step for step in valid if step.case == begun), None)
