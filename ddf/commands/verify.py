"""ddf verify: problems with known answers."""

from __future__ import annotations

from pathlib import Path

import click

from ddf.commands.common import MISSED, fail


@click.command()
@click.argument("problems", nargs=-1, metavar="[PROBLEM ...]")
@click.option("--list", "show", is_flag=True, help="List the problems; solve none.")
@click.option("--quick", is_flag=True, help="Coarser and shorter, same bounds.")
@click.option("--element-mm", type=click.FloatRange(0.0, min_open=True), help="Element size  [default: the problem's]")
@click.option(
    "--formulation", type=click.Choice(["lattice", "shell-membrane"]), default="lattice", show_default=True,
    help="Elements of the plies; only problems for it are solved.",
)  # fmt: skip
@click.option("--case", type=click.Path(path_type=Path), help="Take the materials of this case's first ply and skins.")
@click.option("--threads", type=click.IntRange(1, 1024), default=1, show_default=True, help="Threads.")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default=Path("runs/verify"), show_default=True,
    help="Folder of results.",
)  # fmt: skip
def verify(
    problems: tuple[str, ...],
    show: bool,
    quick: bool,
    element_mm: float | None,
    formulation: str,
    case: Path | None,
    threads: int,
    output: Path,
) -> None:
    """Solve problems with known answers and say how far off the solver is; all of them if none is named.

    Example: ddf verify --quick picture-frame heavy-elastica
    """
    from ddf.verify.problem import Options
    from ddf.verify.registry import choose_problems
    from ddf.verify.report import text_table
    from ddf.verify.runner import solve_all, with_case_materials

    chosen = choose_problems(problems, formulation)
    if show:
        width = max((len(problem.name) for problem in chosen), default=0)
        for problem in chosen:
            click.echo(f"{problem.name.ljust(width)}  {problem.title} [{problem.source}]")
        return
    options = Options(quick=quick, element_mm=element_mm, formulation=formulation, threads=threads)
    if case is not None:
        options = with_case_materials(options, case)
    click.echo(f"{len(chosen)} problems; the kernels are compiled first where they are new ...", err=True)
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
