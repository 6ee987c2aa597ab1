"""The problems by name, in the order in which they run; a module is imported when its problem is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module

from ddf.errors import UsageError
from ddf.verify.problem import LATTICE, Problem

#: name on the command line -> module of this package that has its `PROBLEM`
MODULES: dict[str, str] = {
    "tension": "tension",
    "picture-frame": "picture_frame",
    "bias-extension": "bias_extension",
    "misaligned-fibres": "misaligned_fibres",
    "heavy-elastica": "heavy_elastica",
    "peirce-cantilever": "peirce_cantilever",
    "buckling-strip": "buckling_strip",
    "buckling-tension": "buckling_tension",
    "buckling-foundation": "buckling_foundation",
    "rigid-motion": "rigid_motion",
    "patch-test": "patch_test",
    "zero-energy-modes": "zero_energy",
    "free-vibration": "free_vibration",
    "diaphragm-tension": "rubber_tension",
    "diaphragm-bulge": "bulge",
    "plate-disc": "plate_disc",
    "plate-strip": "plate_strip",
    "tool-distance": "tool_distance",
    "incline": "incline",
    "sliding": "sliding",
    "capstan": "capstan",
    "momentum": "momentum",
    "hemisphere": "hemisphere",
    "kinematic-net": "kinematic_net",
}


def load_problem(name: str) -> Problem:
    """The problem of that name."""
    problem: Problem = import_module(f"ddf.verify.{MODULES[name]}").PROBLEM
    return problem


def choose_problems(names: Sequence[str], formulation: str = LATTICE) -> list[Problem]:
    """Problems by name in the order asked for; where none is named, all that can be solved with a formulation of plies.

    Raises UsageError for unknown names, and for those that cannot be solved with it.
    """
    unknown = [name for name in names if name not in MODULES]
    if unknown:
        lines = []
        for name in unknown:
            near = get_close_matches(name, MODULES, n=3)
            lines.append(f"no problem is called {name!r}" + (f"; did you mean {' or '.join(near)}?" if near else ""))
        raise UsageError("\n".join(lines), "ddf verify --list shows all problems")
    problems = [load_problem(name) for name in dict.fromkeys(names or MODULES)]
    fitting = [problem for problem in problems if formulation in problem.formulations]
    if names and len(fitting) < len(problems):
        lost = ", ".join(problem.name for problem in problems if problem not in fitting)
        raise UsageError(f"not a problem of the formulation {formulation}: {lost}", "ddf verify --list shows which are")
    return fitting
