"""ddf report: measure, draw and report a run again."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def report(folder: Path) -> None:
    """Draw pictures, tables and report of a finished run again, from its checkpoint.

    Example: ddf report runs/first
    """
    from ddf.postprocess import rebuild_report

    click.echo(f"report: {rebuild_report(folder)}")
