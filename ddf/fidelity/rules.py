"""Whether a rung is valid for a scene: what its elements cannot show, and where its model does not hold.

The rules are those that a run is examined by anyway (`plausible`), with the warnings of elements too large for the
tightest wrinkle or for the tool's fillets taken as conditions; and a net knows nothing of a second ply.
"""

from __future__ import annotations

from ddf.case import Case
from ddf.fidelity.ladder import Rung
from ddf.plausible import examine


def obstacle(case: Case, rung: Rung) -> str:
    """Why the case, which stands on the rung, cannot be run there; empty if it can."""
    tool = case.tool
    if rung.ply_mm is None:
        if tool is None:
            return "a net needs a tool"
        return "" if len(case.plies) == 1 else "a net drapes each ply by itself, and here are several"
    found = examine(case)
    grid = [problem for problem in found.warnings if {"element_mm", "fillet_mm"} & set(problem.path)]
    return next((f"{problem.path[-1]}: {problem.problem}" for problem in (*found.faults, *grid)), "")
