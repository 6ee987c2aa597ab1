"""The speed-accuracy study: a case on all rungs of its settings, each result against the finest one's.

The rungs are the points of a sweep (`ddf.sweep`), which runs them in processes of their own and goes on where it was
stopped. Layout of the folder: that of a sweep, with comparisons/NAME, study.csv, study.json, study.md and study.png.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ddf.case import load_case
from ddf.errors import DdfError, UsageError
from ddf.net_run import describe_net
from ddf.output.figures import figure_bytes
from ddf.output.folder import RunFolder
from ddf.study.accuracy import cost_of, errors_of
from ddf.study.axes import Value
from ddf.study.chart import draw_study
from ddf.study.front import Result, pareto_front, recommended
from ddf.study.rungs import FINEST, Rung, make_rungs
from ddf.study.tables import markdown, result_rows, study_json, write_csv
from ddf.sweep.file import check_cases
from ddf.sweep.manifest import FINISHED, SweepFolder
from ddf.sweep.plan import Plan
from ddf.sweep.runner import SweepProgress
from ddf.sweep.sweep import run_sweep

#: what all rungs leave out: it is not what the study is about
LEAN = ("output.pictures=false", "output.frames_per_stage=1")


@dataclass(frozen=True)
class Study:
    """What is to be run."""

    plan: Plan
    rungs: list[Rung]


@dataclass(frozen=True)
class StudyResult:
    """All rungs, the front and the recommended ones by use."""

    folder: Path
    results: list[Result]
    front: list[Result]
    recommended: dict[str, Result]
    reused: int


def make_study(case: Path, axes: dict[str, Sequence[Value]], design: str, common: tuple[str, ...] = ()) -> Study:
    """The study of a case, every rung of it checked. Raises CaseError, UsageError."""
    rungs = make_rungs(load_case(case, common), axes, design)
    if len(rungs) < 2:
        raise UsageError("nothing to compare: all rungs are the finest", "more values, as in --rungs element=2,1")
    plan = Plan(f"speed and accuracy: {case.stem}", case, tuple(rung.point for rung in rungs), LEAN + common)
    check_cases(plan, str(case), {})
    return Study(plan, rungs)


def run_study(
    study: Study,
    folder: Path,
    *,
    resume: bool = False,
    force: bool = False,
    workers: int = 1,
    threads: int | None = None,
    report: Callable[[SweepProgress], None] | None = None,
) -> StudyResult:
    """Run the rungs that have not finished, compare each with the finest, draw and table. One at a time unless more
    `workers` are asked for: rungs that run beside each other do not tell their time.

    Raises DdfError where the finest rung did not finish; what ran is kept.
    """
    for rung in study.rungs:
        if rung.changes.get("model") == "kinematic":  # compiles the net's kernels, so that its time is that of the net
            describe_net(study.plan.load(rung.point))
            break
    done = run_sweep(study.plan, folder, resume=resume, force=force, workers=workers, threads=threads, report=report)
    states = {outcome.name: outcome for outcome in done.outcomes}
    place = SweepFolder(folder)
    if states[FINEST].state != FINISHED:
        raise DdfError(
            f"the finest rung did not finish: {states[FINEST].reason}",
            "--resume runs it again; or choose other --rungs",
        )
    results = []
    for rung in study.rungs:
        outcome = states[rung.name]
        if outcome.state != FINISHED:
            results.append(Result(rung, outcome.state, outcome.reason))
            continue
        run = place.run_folder(rung.name)
        cost, warnings = cost_of(run)
        errors = errors_of(place.run_folder(FINEST), run, folder / "comparisons" / rung.name)
        results.append(Result(rung, FINISHED, "", cost, errors, tuple(warnings)))
    front = pareto_front(results)
    chosen = recommended(front)
    out = RunFolder(folder)
    rows = result_rows(results, front, chosen)
    write_csv(out, rows)
    out.write_json("study.json", study_json(study.plan, results, front, chosen))
    out.write_text("study.md", markdown(study.plan, results, front, chosen))
    out.write_bytes("study.png", figure_bytes(draw_study(study.plan.title, results, front, chosen)))
    return StudyResult(folder, results, front, chosen, done.reused)
