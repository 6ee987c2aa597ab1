"""Run what the claims need, judge them, and leave tables, pictures and a page in a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ddf.claims.cases import AS_SHIPPED, UNKNOWNS, Forming, make_plan, wanted
from ddf.claims.claims import CLAIMS
from ddf.claims.formed import Formed, read_formed
from ddf.claims.report import write_page, write_tables
from ddf.claims.verdict import REPRODUCED, Judged, judge
from ddf.errors import DdfError
from ddf.output.folder import RunFolder
from ddf.output.results import open_run
from ddf.sweep.manifest import FINISHED, Outcome, SweepFolder
from ddf.sweep.runner import SweepProgress
from ddf.sweep.sweep import SweepResult, run_sweep


@dataclass(frozen=True)
class Study:
    """What was found: the claims on the shipped cases, and on each variant of what the paper does not give."""

    folder: Path
    title: str
    judged: tuple[Judged, ...]
    variants: dict[str, tuple[Judged, ...]]
    runs: tuple[dict[str, Any], ...]  # a row a run: state, version, audit
    notes: tuple[str, ...]
    sweep: SweepResult

    @property
    def reproduced(self) -> bool:
        """Whether all claims are reproduced on the shipped cases."""
        return all(item.verdict == REPRODUCED for item in self.judged)


def study_claims(
    folder: Path,
    *,
    coarse: bool = False,
    repeats: int = 2,
    unknowns: bool = False,
    force: bool = False,
    common: tuple[str, ...] = (),
    workers: int | None = None,
    threads: int | None = None,
    report: Callable[[SweepProgress], None] | None = None,
) -> Study:
    """Run what has not finished yet, in `folder`, and judge all claims.

    `repeats`: runs of each forming, with other numerics, that say how far its results scatter. `unknowns`: judge the
    claims for each variant of what the paper does not give as well. Raises CaseError, UsageError.
    """
    formings = wanted(repeats, unknowns)
    plan = make_plan(formings, coarse, common)
    result = run_sweep(plan, folder, force=force, extend=True, workers=workers, threads=threads, report=report)
    return write_study(folder, plan.title, formings, result)


def write_study(folder: Path, title: str, formings: Sequence[Forming], result: SweepResult) -> Study:
    """Judge the claims on the runs of a sweep and write the results."""
    outcomes = {outcome.name: outcome for outcome in result.outcomes}
    place, notes = SweepFolder(folder), list(result.notes)
    judged, rows = {}, []
    for variant in (AS_SHIPPED, *UNKNOWNS):
        ours = [forming for forming in formings if forming.variant == variant]
        if not ours:
            continue
        runs, missing = _collect(place, ours, outcomes)
        rows += [_row(place, outcomes[forming.name]) for forming in ours]
        judged[variant] = tuple(judge(claim, runs, missing) for claim in CLAIMS)
        if variant == AS_SHIPPED:
            notes += _draw(place.out, judged[variant], runs)
    notes += [f"{row['run']} has not finished: {row['state']} {row['reason']}".strip() for row in rows if
              row["state"] != FINISHED]  # fmt: skip
    versions = sorted({row["computed_by"] for row in rows if "computed_by" in row})
    if len(versions) > 1:
        notes.append(f"the runs were computed by several versions, --force runs all again: {', '.join(versions)}")
    shipped = judged.pop(AS_SHIPPED)
    study = Study(folder, title, shipped, judged, tuple(rows), tuple(notes), result)
    write_tables(place.out, title, shipped, judged, rows, study.notes)
    write_page(place.out, title, shipped, judged, rows, study.notes)
    return study


def _collect(
    place: SweepFolder, formings: Sequence[Forming], outcomes: dict[str, Outcome]
) -> tuple[dict[str, list[Formed]], dict[str, str]]:
    """Finished runs by forming, repeats in order, and why the others are missing (of repeats the first that is)."""
    runs: dict[str, list[Formed]] = {}
    missing: dict[str, str] = {}
    for forming in formings:
        outcome = outcomes[forming.name]
        if outcome.state != FINISHED:
            why = _why(outcome)
            missing.setdefault(forming.forming, f"{outcome.state}, {why}" if why else outcome.state)
            continue
        try:
            runs.setdefault(forming.forming, []).append(read_formed(place.run_folder(forming.name)))
        except DdfError as error:
            missing.setdefault(forming.forming, f"cannot be read: {error}")
    return runs, missing


def _why(outcome: Outcome) -> str:
    """Why a run has not finished, without the advice that follows."""
    return outcome.reason.partition(";")[0].partition("\n")[0]


def _row(place: SweepFolder, outcome: Outcome) -> dict[str, Any]:
    """A run in the table of runs: what it was computed with and which of the audit's checks it misses."""
    row: dict[str, Any] = {"run": outcome.name, "state": outcome.state, "reason": _why(outcome),
                           "wall_s": round(outcome.wall_s, 1)}  # fmt: skip
    if outcome.state == FINISHED:
        info = open_run(place.run_folder(outcome.name)).info
        missed = [check["name"] for check in info.get("audit", []) if not check["ok"]]
        made_by = f"{info.get('ddf', '')} {info.get('source', '')}".strip()
        row |= {"computed_by": made_by, "audit_misses": "; ".join(missed)}
    return row


def _draw(out: RunFolder, judged: Sequence[Judged], runs: dict[str, list[Formed]]) -> list[str]:
    """A picture a claim; what could not be drawn is a note, not a failure."""
    from ddf.claims.pictures import draw_claim
    from ddf.output.figures import save_picture

    notes = []
    for item in judged:
        try:
            save_picture(out, f"claim-{item.claim.number}", draw_claim(item, runs))
        except (DdfError, ImportError, OSError, RuntimeError, ValueError) as error:
            notes.append(f"the picture of claim {item.claim.number} is missing: {type(error).__name__}: {error}")
    return notes
