"""ddf init: a case to start from."""

from __future__ import annotations

from pathlib import Path

import click

from ddf.errors import DdfError


@click.command()
@click.argument("path", type=click.Path(path_type=Path), default="case.toml")
@click.option("--force", is_flag=True, help="Overwrite the file.")
def init(path: Path, force: bool) -> None:
    """Write a commented case to start from.

    Example: ddf init my-case.toml
    """
    from ddf.case.template import TEMPLATE

    if path.exists() and not force:
        raise click.UsageError(f"{path} exists; use --force to overwrite it")
    try:
        path.write_text(TEMPLATE, encoding="utf-8")
    except OSError as error:
        raise DdfError(f"cannot write {path}: {error.strerror}") from error
    click.echo(f"wrote {path}; run it with: ddf run {path}")
