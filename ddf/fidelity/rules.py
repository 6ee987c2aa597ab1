"""Whether a rung is valid for a scene: what its elements cannot show, and where its model does not hold.

The rules are those that a run is examined by anyway (`plausible`), taken here as conditions, and two more that were
measured: 6 mm elements form over fillets of 5 mm, of 8 mm ones the tool's apex comes through (docs/speed-accuracy.md);
a net knows nothing of a second ply.
"""

from __future__ import annotations

from ddf.case import Case
from ddf.fidelity.ladder import Rung
from ddf.plausible import examine

PLY_ELEMENTS_A_FILLET = 1.2
"""Largest element of a ply over the fillets' radius. Measured: 1.2 forms, 1.6 does not."""


def obstacle(case: Case, rung: Rung) -> str:
    """Why the case, which stands on the rung, cannot be run there; empty if it can."""
    tool = case.tool
    if rung.ply_mm is None:
        if tool is None:
            return "a net needs a tool"
        return "" if len(case.plies) == 1 else "a net drapes each ply by itself, and here are several"
    coarsest = max(ply.element_mm for ply in case.plies)
    if tool is not None and tool.shape != "file" and coarsest > PLY_ELEMENTS_A_FILLET * tool.fillet_mm:
        return f"elements of {coarsest:g} mm do not form over fillets of {tool.fillet_mm:g} mm"
    found = examine(case)
    grid = [problem for problem in found.warnings if {"element_mm", "fillet_mm"} & set(problem.path)]
    return next((f"{problem.path[-1]}: {problem.problem}" for problem in (*found.faults, *grid)), "")
