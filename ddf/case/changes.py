"""Changes of a case by dotted key, as they are written on the command line: {"plies.0.element_mm": 4.0}."""

from __future__ import annotations

import tomllib
from typing import Any

from ddf.case.load import case_from_dict, resolved_toml
from ddf.case.overrides import put
from ddf.case.schema import Case

Changes = dict[str, Any]


def changed(case: Case, changes: Changes) -> Case:
    """The case with some keys set. Raises CaseError where they make no valid case."""
    raw = tomllib.loads(resolved_toml(case))
    for key, value in changes.items():
        put(raw, key, value)
    return case_from_dict(raw)


def stretched(case: Case, factor: float) -> Changes:
    """All durations times f, and mass damping over f.

    With tau = t/f the motion  m x'' + c m x' = F(x, tau)  is that of the mass m/f^2 with damping c f in tau: so c/f
    keeps the damping of each stage (c times its duration), and drag and inertia grow together as 1/f^2.
    """
    process = case.process
    changes: Changes = {"solver.mass_damping_1_s": case.solver.mass_damping_1_s / factor}
    if process.breakpoints is not None:
        return changes | {"process.breakpoints.time_s": [factor * time for time in process.breakpoints.time_s]}
    for k, stage in enumerate(process.stages or ()):
        changes[f"process.stages.{k}.duration_s"] = float(f"{factor * stage.duration_s:.9g}")
        if stage.mass_damping_1_s is not None:
            changes[f"process.stages.{k}.mass_damping_1_s"] = stage.mass_damping_1_s / factor
    return changes
