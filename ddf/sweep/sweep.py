"""A sweep from its name or file to its table and pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from ddf.case import load_case
from ddf.case.faults import closest
from ddf.errors import DdfError, UsageError
from ddf.sweep.file import check_cases, load_sweep
from ddf.sweep.manifest import FAILED, FINISHED, Outcome, SweepFolder
from ddf.sweep.named import NAMED
from ddf.sweep.plan import Plan
from ddf.sweep.runner import Runner, SweepProgress
from ddf.sweep.table import sweep_rows, swept_keys, table_lines, write_rows

DEFAULT_CASE = "tetrahedron-0-90-coarse"
DEFAULT_CASES = dict.fromkeys(("friction", "loading"), "tetrahedron-double-coarse")  # sections 3.4, 3.5: of two plies


@dataclass(frozen=True)
class SweepResult:
    """How a sweep ended."""

    folder: Path
    outcomes: list[Outcome]
    reused: int  # cases that had finished before
    notes: list[str]
    table: list[str]  # lines of text

    @property
    def failed(self) -> list[Outcome]:
        """Cases that failed."""
        return [outcome for outcome in self.outcomes if outcome.state == FAILED]

    @property
    def finished(self) -> list[Outcome]:
        """Cases that finished, in this run of the sweep or before."""
        return [outcome for outcome in self.outcomes if outcome.state == FINISHED]


def make_plan(what: str, case: Path | None = None, common: tuple[str, ...] = ()) -> Plan:
    """The plan of a ready-made sweep by its name, or of a sweep file; every case is checked.

    `case`: base case of a ready-made sweep, left out: a shipped coarse one, of two plies where the paper's study has
    two. Raises CaseError, UsageError.
    """
    if what in NAMED:
        base = case or Path(DEFAULT_CASES.get(what, DEFAULT_CASE))
        plan = Plan(f"{what}: {base.stem}", base, tuple(NAMED[what](load_case(base, common))), common)
        check_cases(plan, str(base), {})
        return plan
    path = Path(what)
    if not path.exists() and path.suffix != ".toml":
        near = closest(what, NAMED)
        raise UsageError(
            f"no sweep is called {what!r}" + (f"; did you mean {near!r}?" if near else ""),
            f"ready-made: {', '.join(NAMED)}; or give a sweep file (.toml)",
        )
    if case is not None:
        raise UsageError("--case goes with a ready-made sweep only", "a sweep file names its own case")
    return load_sweep(path, common)


def run_sweep(
    plan: Plan,
    folder: Path,
    *,
    resume: bool = False,
    force: bool = False,
    extend: bool = False,
    workers: int | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    report: Callable[[SweepProgress], None] | None = None,
) -> SweepResult:
    """Run what of a sweep has not finished yet, then write its table and pictures.

    `extend`: the folder may hold other cases besides; a run that is there is used if its case is the same.
    `scheduler`: address of a Dask scheduler that runs the cases (threads of each: 1, unless given), else they
    run in local processes. Raises UsageError for a folder in use or of another sweep. A KeyboardInterrupt goes
    through, after the cases have written their checkpoints.
    """
    plan = replace(plan, workers=workers or plan.workers, threads=threads or plan.threads)
    place = SweepFolder(folder)
    entries = place.prepare(plan, resume, force, extend)
    runner = Runner(place, entries)
    reused = len(entries) - len(runner.to_do())
    if scheduler is None:
        runner.run(plan, report)
    else:
        runner.run_on_cluster(scheduler, plan, report)
    place.write_outcomes(runner.outcomes)
    rows = sweep_rows(place, entries, runner.outcomes)
    write_rows(place, rows)
    notes: list[str] = []
    try:
        from ddf.sweep.pictures import draw_sweep

        draw_sweep(place, entries, runner.outcomes, rows, swept_keys(entries), plan.title)
    except (DdfError, ImportError, OSError, RuntimeError, ValueError) as error:
        notes.append(f"pictures are missing: {type(error).__name__}: {error}")
    return SweepResult(folder, list(runner.outcomes.values()), reused, notes, table_lines(rows))
