"""ddf sweep: a case under many changes."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from ddf.commands.common import INTERRUPTED, SET, SOME_FAILED, end_progress, say_over


@click.command()
@click.argument("what", metavar="NAME|FILE")
@click.option(
    "--case", type=click.Path(path_type=Path), help="Base case of a ready-made sweep  [default: a coarse one]"
)
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder  [default: runs/sweep-NAME]")
@SET
@click.option("--workers", type=click.IntRange(1, 1024), help="Cases at once  [default: as cores allow]")
@click.option("--threads", type=click.IntRange(1, 1024), help="Threads of each case  [default: shared out]")
@click.option(
    "--scheduler", metavar="ADDRESS", help="Run on a Dask cluster, e.g. tcp://host:8786 (needs ddf[cluster])."
)
@click.option("--resume", is_flag=True, help="Run what is missing, interrupted or failed.")
@click.option("--force", is_flag=True, help="Overwrite an earlier sweep in the folder.")
@click.option("--list", "only_list", is_flag=True, help="Show the cases; run nothing.")
@click.option("--quiet", is_flag=True, help="No progress on stderr.")
def sweep(
    what: str,
    case: Path | None,
    output: Path | None,
    overrides: tuple[str, ...],
    workers: int | None,
    threads: int | None,
    scheduler: str | None,
    resume: bool,
    force: bool,
    only_list: bool,
    quiet: bool,
) -> None:
    """Run a case under many changes: friction, loading, layup, tool, mesh, or a sweep file.

    Leaves a manifest, a folder a case, one table and comparing pictures.
    Example: ddf sweep friction -o runs/friction
    """
    from ddf.sweep.plan import assignments
    from ddf.sweep.sweep import make_plan, run_sweep
    from ddf.sweep.text import progress_line

    plan = make_plan(what, case, overrides)
    if only_list:
        for point in plan.points:
            click.echo(f"{point.name}: {', '.join(assignments(point.changes))}")
        return
    folder = output or Path("runs") / f"sweep-{Path(what).stem}"
    try:
        result = run_sweep(
            plan, folder, resume=resume, force=force, workers=workers, threads=threads,
            scheduler=scheduler, report=None if quiet else lambda progress: say_over(progress_line(progress)),
        )  # fmt: skip
    except KeyboardInterrupt:
        click.echo(f"interrupted; go on with --resume -o {folder}", err=True)
        sys.exit(INTERRUPTED)
    end_progress(quiet)
    computed = len(result.finished) - result.reused
    click.echo(
        f"{len(result.outcomes)} cases: {computed} computed, {result.reused} reused, {len(result.failed)} failed"
    )
    for line in result.table:
        click.echo(line)
    for outcome in result.failed:
        click.echo(f"failed: {outcome.name}: {outcome.reason}")
    for note in result.notes:
        click.echo(f"note: {note}")
    click.echo(f"table: {folder / 'table.csv'}; pictures: {folder / 'pictures'}")
    if result.failed:
        sys.exit(SOME_FAILED)
