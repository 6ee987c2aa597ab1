"""What commands share: exit codes, messages, options."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

import click

MISSED = 4
SOME_FAILED = 5
INTERRUPTED = 130

SET = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override a key, e.g. plies.0.element_mm=4."
)
CASE = click.argument("case", type=click.Path(path_type=Path))


def fail(message: str, code: int) -> NoReturn:
    """Say on stderr what is wrong and end with an exit code."""
    click.echo(f"ddf: {message}", err=True)
    sys.exit(code)


def say(text: str, nl: bool = True) -> None:
    """Write to stderr; a run does not end because nobody listens any more (it is in log.txt too)."""
    with suppress(BrokenPipeError):
        click.echo(text, err=True, nl=nl)


def say_over(text: str) -> None:
    """A line of progress: over the one before on a terminal, else on a line of its own."""
    if sys.stderr.isatty():
        say("\r" + text.ljust(140)[:200], nl=False)
    else:
        say(text)


def end_progress(quiet: bool) -> None:
    """Leave the line of progress."""
    if not quiet and sys.stderr.isatty():
        say("")
