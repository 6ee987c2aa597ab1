"""ddf schema: the keys of a case."""

from __future__ import annotations

import click


@click.command()
@click.option("--json", "as_json", is_flag=True, help="JSON schema instead of Markdown.")
@click.option("--sweep", is_flag=True, help="The keys of a sweep file instead.")
def schema(as_json: bool, sweep: bool) -> None:
    """Print every key of a case file: type, default, range, meaning.

    Example: ddf schema > keys.md
    """
    from ddf.case.template import keys_table, schema_json, schema_text

    if sweep:
        from ddf.sweep.file import SweepFile

        click.echo(keys_table(SweepFile))
        return
    click.echo(schema_json() if as_json else schema_text())
