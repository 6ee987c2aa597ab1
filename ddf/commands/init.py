"""ddf init: a case to start from."""

from __future__ import annotations

from pathlib import Path

import click

from ddf.errors import DdfError


@click.command()
@click.argument("path", type=click.Path(path_type=Path), default="case.toml")
@click.option("--case", metavar="NAME", help="A shipped case instead of the commented one.")
@click.option("--list", "show", is_flag=True, help="List the shipped cases and tools; write nothing.")
@click.option("--force", is_flag=True, help="Overwrite the file.")
def init(path: Path, case: str | None, show: bool, force: bool) -> None:
    """Write a commented case to start from.

    Example: ddf init my-case.toml
    """
    from ddf.case.template import TEMPLATE
    from ddf.shipped import shipped_file, shipped_names

    if show:
        click.echo(f"cases: {', '.join(shipped_names('cases'))}")
        click.echo(f'tools (shape = "file"): {", ".join(shipped_names("meshes"))}')
        return
    if path.exists() and not force:
        raise click.UsageError(f"{path} exists; use --force to overwrite it")
    text = TEMPLATE
    if case is not None:
        source = shipped_file("cases", case)
        if source is None:
            raise click.UsageError(f"no shipped case is called {case!r}: {', '.join(shipped_names('cases'))}")
        text = source.read_text(encoding="utf-8")
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise DdfError(f"cannot write {path}: {error.strerror}") from error
    click.echo(f"wrote {path}; run it with: ddf run {path}")
