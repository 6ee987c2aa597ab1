"""Solve problems one after the other and leave their tables and pictures in a folder."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ddf.case import hyperelastic_material, load_case, woven_material
from ddf.errors import DdfError
from ddf.output.figures import figure_bytes
from ddf.output.folder import RunFolder
from ddf.provenance import provenance
from ddf.verify.problem import Answer, Options, Problem
from ddf.verify.report import check_row, checks_csv, columns_csv, draw_answer, worst_table


@dataclass(frozen=True)
class Outcome:
    """A problem and how it went: an answer, or the message of what stopped it."""

    problem: Problem
    answer: Answer | None
    message: str
    wall_s: float

    @property
    def passed(self) -> bool:
        """Whether there is an answer within all its bounds."""
        return self.answer is not None and self.answer.passed


def with_case_materials(options: Options, file: Path) -> Options:
    """The options with the first ply's and the diaphragms' materials of a case. Raises CaseError."""
    case = load_case(file)
    fabric, rubber = woven_material(case, case.plies[0].material), hyperelastic_material(case, case.diaphragms.material)
    return replace(options, fabric=fabric, rubber=rubber)


def solve_all(
    problems: Sequence[Problem], options: Options, folder: Path, announce: Callable[[Problem], None] = lambda _: None
) -> Iterator[Outcome]:
    """Solve each problem, write NAME.csv and NAME.png, and after the last results.csv, results.md and results.json.

    A DdfError of one problem is its outcome; the others go on. announce: called with a problem before it is solved.
    """
    out, outcomes = RunFolder(folder), []
    for problem in problems:
        announce(problem)
        start = clock.perf_counter()
        try:
            answer, message = problem.solve(options), ""
        except DdfError as error:
            answer, message = None, str(error)
        outcome = Outcome(problem, answer, message, clock.perf_counter() - start)
        if answer is not None:
            out.write_text(f"{problem.name}.csv", columns_csv(answer.table))
            out.write_bytes(f"{problem.name}.png", figure_bytes(draw_answer(problem.title, answer.figure)))
        outcomes.append(outcome)
        yield outcome
    _write_results(out, outcomes, options)


def _write_results(out: RunFolder, outcomes: Sequence[Outcome], options: Options) -> None:
    answers = [(o.problem.name, o.answer) for o in outcomes if o.answer is not None]
    out.write_text("results.csv", checks_csv(answers))
    out.write_text("results.md", worst_table(answers))
    results = [
        {
            "problem": o.problem.name,
            "title": o.problem.title,
            "source": o.problem.source,
            "passed": o.passed,
            "message": o.message,
            "wall_s": round(o.wall_s, 3),
            "checks": [check_row(check) for check in o.answer.checks] if o.answer else [],
            "notes": o.answer.notes if o.answer else (),
        }
        for o in outcomes
    ]
    chosen = {
        "quick": options.quick,
        "element_mm": options.element_mm,
        "fabric": None if options.fabric is None else options.fabric.model_dump(),
        "rubber": None if options.rubber is None else options.rubber.model_dump(),
        "formulation": options.formulation,
        "threads": options.threads,
    }
    total = round(sum(o.wall_s for o in outcomes), 3)
    passed = all(o.passed for o in outcomes)
    out.write_json(
        "results.json", provenance() | {"options": chosen, "passed": passed, "wall_s": total, "results": results}
    )
