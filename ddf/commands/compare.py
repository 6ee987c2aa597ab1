"""ddf compare: two runs, and a measured outline."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("first", metavar="A", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("second", metavar="B", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option(
    "--profile",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Measured outline: CSV of x, y in mm.",
)
@click.option("--align", is_flag=True, help="Lay the measured outline on each run by the best rigid fit.")
@click.option("--ply", help="Ply that was measured  [default: the top one]")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder  [default: runs/compare-A-B]")
@click.option("--force", is_flag=True, help="Overwrite an earlier comparison in the folder.")
def compare(
    first: Path, second: Path, profile: Path | None, align: bool, ply: str | None, output: Path | None, force: bool
) -> None:
    """Compare two finished runs: outlines, wrinkles site by site, shear; and a measured outline with both.

    Example: ddf compare runs/first runs/fine --profile measured.csv --align
    """
    from ddf.compare.runs import compare_runs
    from ddf.compare.text import comparison_lines

    if (align or ply) and profile is None:
        raise click.UsageError("--align and --ply need --profile")
    folder = output or Path("runs") / f"compare-{first.resolve().name}-{second.resolve().name}"
    result = compare_runs(first, second, folder, profile, align, ply, force)
    for line in comparison_lines(result):
        click.echo(line)
    click.echo(f"tables and pictures: {folder}")
