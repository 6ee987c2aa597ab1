"""ddf check: what a case would run and cost."""

from __future__ import annotations

from pathlib import Path

import click

from ddf.commands.common import CASE, SET, say


@click.command()
@CASE
@SET
@click.option(
    "--threads", type=click.IntRange(1, 1024), help="Threads of the run  [default: the case's, else all cores]"
)
def check(case: Path, overrides: tuple[str, ...], threads: int | None) -> None:
    """Check a case: meshes, physics that is on, step, steps, memory; nothing is run.

    Example: ddf check cases/tetrahedron-0-90.toml
    """
    from ddf.case.load import load_source
    from ddf.describe import describe_scene
    from ddf.net_run import describe_net
    from ddf.plausible import prepare

    loaded, source = load_source(case, overrides)
    if loaded.fidelity == "auto":
        from ddf.fidelity import choose
        from ddf.run import default_threads

        choice = choose(loaded, threads or loaded.solver.threads or default_threads())
        click.echo("\n".join([*choice.lines(), ""]))
        loaded = choice.case
    if loaded.model == "kinematic":
        click.echo(describe_net(loaded))
    else:
        click.echo(describe_scene(prepare(loaded, source, say)))
