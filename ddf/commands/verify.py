"""ddf verify: problems with known answers, and the paper's claims."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ddf.commands.common import INTERRUPTED, MISSED, SET, end_progress, fail, say, say_over

PAPER = "paper"
PAPER_LINE = (
    "the paper's claims on its formings, by this name only: hours (--coarse: 10 to 40 min) [Thompson et al. 2020]"
)
#: options that mean something for the claims, or for the problems, only
FOR_PAPER = ("coarse", "repeats", "unknowns", "overrides", "workers", "force", "quiet")
FOR_PROBLEMS = ("quick", "element_mm", "formulation", "case")


@click.command()
@click.argument("problems", nargs=-1, metavar="[PROBLEM ...|paper]")
@click.option("--list", "show", is_flag=True, help="List the problems; solve none.")
@click.option("--quick", is_flag=True, help="Coarser and shorter, same bounds.")
@click.option("--element-mm", type=click.FloatRange(0.0, min_open=True), help="Element size  [default: the problem's]")
@click.option(
    "--formulation", type=click.Choice(["lattice", "shell-membrane"]), default="lattice", show_default=True,
    help="Elements of the plies; only problems for it are solved.",
)  # fmt: skip
@click.option("--case", type=click.Path(path_type=Path), help="Take the materials of this case's first ply and skins.")
@click.option("--threads", type=click.IntRange(1, 1024), default=1, show_default=True, help="Threads (of a run).")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path),
    help="Folder of results  [default: runs/verify, runs/verify-paper, runs/verify-paper-coarse]",
)  # fmt: skip
@click.option("--coarse", is_flag=True, help="paper: plies of 4 mm and diaphragms of 5 mm.")
@click.option(
    "--repeats", type=click.IntRange(1, 3), default=2, show_default=True,
    help="paper: runs of each forming, with other mesh and tool stiffness, for its scatter.",
)  # fmt: skip
@click.option("--unknowns", is_flag=True, help="paper: judge each value of what is not published as well.")
@SET
@click.option("--workers", type=click.IntRange(1, 1024), help="paper: runs at once  [default: as cores allow]")
@click.option("--force", is_flag=True, help="paper: run all again, whatever is in the folder.")
@click.option("--quiet", is_flag=True, help="paper: no progress on stderr.")
@click.pass_context
def verify(
    context: click.Context, /, problems: tuple[str, ...], show: bool, threads: int, output: Path | None, **options: Any
) -> None:
    """Solve problems with known answers and say how far off the solver is; all of them if none is named.

    `ddf verify paper` runs the formings of Thompson, Belnoue and Hallett (2020) and judges the paper's five claims on
    them; finished runs in its folder are used. Exit code 4: a bound was missed, a claim not reproduced.

    Example: ddf verify --quick picture-frame heavy-elastica
    """
    paper = PAPER in problems
    if paper and len(problems) > 1:
        raise click.UsageError("'paper' goes by itself: ddf verify paper")
    for name in FOR_PROBLEMS if paper else FOR_PAPER:
        if context.get_parameter_source(name) is not click.core.ParameterSource.DEFAULT:
            option = next(p for p in context.command.params if p.name == name).opts[0]
            raise click.UsageError(f"{option} means nothing {'for' if paper else 'without'} 'paper'")
    if show:
        _list(problems, options["formulation"])
    elif paper:
        chosen = {name: options[name] for name in FOR_PAPER}
        default = Path("runs/verify-paper-coarse" if chosen["coarse"] else "runs/verify-paper")
        _judge_claims(output or default, threads=threads, **chosen)
    else:
        _solve(problems, threads, output or Path("runs/verify"), **{name: options[name] for name in FOR_PROBLEMS})


def _list(problems: tuple[str, ...], formulation: str) -> None:
    from ddf.verify.registry import choose_problems

    chosen = [] if problems == (PAPER,) else choose_problems(problems, formulation)
    width = max((len(problem.name) for problem in chosen), default=0)
    for problem in chosen:
        click.echo(f"{problem.name.ljust(width)}  {problem.title} [{problem.source}]")
    if not problems or problems == (PAPER,):
        click.echo(f"{PAPER.ljust(width)}  {PAPER_LINE}")


def _solve(
    problems: tuple[str, ...], threads: int, output: Path, quick: bool, element_mm: float | None, formulation: str,
    case: Path | None,
) -> None:  # fmt: skip
    from ddf.kernel_cache import warm_kernels
    from ddf.verify.problem import Options
    from ddf.verify.registry import choose_problems
    from ddf.verify.report import text_table
    from ddf.verify.runner import solve_all, with_case_materials

    chosen = choose_problems(problems, formulation)
    options = Options(quick=quick, element_mm=element_mm, formulation=formulation, threads=threads)
    if case is not None:
        options = with_case_materials(options, case)
    say(f"{len(chosen)} problems ...")
    warm_kernels(say)
    missed = []
    for outcome in solve_all(chosen, options, output, lambda problem: click.echo(f"{problem.name} ...", err=True)):
        click.echo(f"{outcome.problem.name}: {outcome.problem.title} ({outcome.wall_s:.1f} s)")
        if outcome.answer is None:
            click.echo(f"  FAILED: {outcome.message}")
        else:
            click.echo(text_table(outcome.answer.checks))
            for note in outcome.answer.notes:
                click.echo(f"note: {note}")
        click.echo("")
        if not outcome.passed:
            missed.append(outcome.problem.name)
    click.echo(f"{len(chosen) - len(missed)} of {len(chosen)} problems within their bounds; results in {output}")
    if missed:
        fail(f"missed: {', '.join(missed)}", MISSED)


def _judge_claims(
    output: Path, threads: int, coarse: bool, repeats: int, unknowns: bool, overrides: tuple[str, ...],
    workers: int | None, force: bool, quiet: bool,
) -> None:  # fmt: skip
    from ddf.claims.report import decided_by, text_lines
    from ddf.claims.study import study_claims
    from ddf.claims.verdict import REPRODUCED
    from ddf.sweep.text import progress_line

    try:
        study = study_claims(
            output, coarse=coarse, repeats=repeats, unknowns=unknowns, force=force, common=overrides, workers=workers,
            threads=threads, report=None if quiet else lambda progress: say_over(progress_line(progress)),
        )  # fmt: skip
    except KeyboardInterrupt:
        click.echo(f"interrupted; the same command goes on, -o {output}", err=True)
        sys.exit(INTERRUPTED)
    end_progress(quiet)
    for line in text_lines(study.judged):
        click.echo(line)
    if study.variants:
        for line in decided_by({"as shipped": study.judged, **study.variants}):
            click.echo(line)
    for note in study.notes:
        click.echo(f"note: {note}")
    others = [item for item in study.judged if item.verdict != REPRODUCED]
    click.echo(
        f"{len(study.judged) - len(others)} of {len(study.judged)} claims reproduced; page: {output / 'claims.html'}"
    )
    if others:
        fail("; ".join(f"claim {item.claim.number}: {item.verdict}" for item in others), MISSED)
