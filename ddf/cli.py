"""The command line: a thin layer over the Python API, and the only place that prints.

Exit codes: 0 ok; 1 failure; 2 usage or an invalid case; 3 unstable or an energy limit; 130 interrupted.
"""

from __future__ import annotations

import shlex
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

import click

from ddf import __version__
from ddf.errors import DdfError

INTERRUPTED = 130


class _Commands(click.Group):
    """Turns expected failures into one message and their exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; DdfError becomes a message on stderr and an exit code."""
        try:
            return super().invoke(ctx)
        except DdfError as error:
            _fail(str(error), error.exit_code)
        except MemoryError:
            _fail("out of memory; larger elements or fewer frames need less", 1)
        except KeyboardInterrupt:
            _fail("interrupted", INTERRUPTED)


def _fail(message: str, code: int) -> NoReturn:
    click.echo(f"ddf: {message}", err=True)
    sys.exit(code)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="ddf")
def main() -> None:
    r"""Simulate double diaphragm forming of woven fabric.

    \b
    ddf init my-case.toml          a commented case to start from
    ddf check my-case.toml         what would run, without running it
    ddf run my-case.toml           run it; results go to runs/my-case
    """


_SET = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override a key, e.g. plies.0.element_mm=4."
)


@main.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Run folder  [default: runs/CASE]")
@_SET
@click.option("--resume", is_flag=True, help="Go on from the folder's checkpoint.")
@click.option("--force", is_flag=True, help="Overwrite an earlier run in the folder.")
@click.option("--quiet", is_flag=True, help="No progress on stderr.")
@click.option("--threads", type=click.IntRange(1, 1024), help="Threads  [default: the case's, else all cores]")
def run(
    case: Path,
    output: Path | None,
    overrides: tuple[str, ...],
    resume: bool,
    force: bool,
    quiet: bool,
    threads: int | None,
) -> None:
    """Run a case and leave frames, tables, pictures and a report in a folder.

    Example: ddf run cases/tetrahedron-0-90-coarse.toml -o runs/first
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    from ddf.case.load import load_source
    from ddf.run import run_case

    if resume and force:
        raise click.UsageError("--resume goes on with a run, --force replaces it: choose one")
    loaded, source = load_source(case, overrides)
    folder = output if output is not None else Path("runs") / case.stem
    settings = [part for item in overrides for part in ("--set", item)]
    again = shlex.join(["ddf", "run", str(case), "-o", str(folder), "--resume", *settings])
    if not quiet:
        click.echo("meshing, then compiling the kernels (about a minute the first time) ...", err=True)
    try:
        result = run_case(
            loaded, folder, case_text=None if overrides else source.text, threads=threads, resume=resume, force=force,
            report=None if quiet else _progress, source=source, warn=_say,
        )  # fmt: skip
    except KeyboardInterrupt:
        _fail(f"interrupted{_resumable(folder, again)}", INTERRUPTED)
    except DdfError as error:
        retry = _resumable(folder, again) if error.exit_code == 1 else ""
        _fail(f"{error}{retry}", error.exit_code)
    if not quiet and sys.stderr.isatty():
        click.echo("", err=True)
    if result.stop_reason == "interrupted":
        click.echo(f"interrupted at {result.time_s:.5f} s; go on with: {again}", err=True)
        sys.exit(INTERRUPTED)
    _summary(result)


def _resumable(folder: Path, again: str) -> str:
    """What to do about a run that was stopped, if it has a checkpoint."""
    there = (folder / "checkpoint.npz").is_file()
    return f"\n  the last checkpoint stands; go on with: {again}" if there else ""


def _progress(p: Any) -> None:
    if sys.stderr.isatty():
        _say("\r" + str(p).ljust(140), nl=False)
    else:
        _say(str(p))


def _say(text: str, nl: bool = True) -> None:
    """Write to stderr; a run does not end because nobody listens any more (it is in log.txt too)."""
    with suppress(BrokenPipeError):
        click.echo(text, err=True, nl=nl)


def _summary(result: Any) -> None:
    click.echo(f"finished: {result.folder}")
    wall = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result.wall_s.items())
    click.echo(f"wall time: {wall}")
    for values in result.plies:
        click.echo(
            f"{values['ply']}: {values['wrinkle_count']} wrinkles, {values['wrinkle_total_length_mm']:.0f} mm in all, "
            f"largest {values['wrinkle_largest_amplitude_mm']:.1f} mm high; shear up to "
            f"{values['shear_max_deg']:.1f} deg; largest gap to the tool {values['bridging_largest_mm'] or 0.0:.1f} mm"
        )
    for check in result.checks:
        mark = "ok  " if check["ok"] else "WARN"
        click.echo(f"{mark} {check['name']}: {check['value']:.3g} {check['unit']} (limit {check['limit']:g})")
    for note in result.notes:
        click.echo(f"note: {note}")
    click.echo(f"report: {result.folder / 'report.html'}")


@main.command()
@click.argument("case", type=click.Path(path_type=Path))
@_SET
def check(case: Path, overrides: tuple[str, ...]) -> None:
    """Check a case: meshes, physics that is on, step, steps, memory; nothing is run.

    Example: ddf check cases/tetrahedron-0-90.toml
    """
    from ddf.case.load import load_source
    from ddf.describe import describe_scene
    from ddf.plausible import prepare

    loaded, source = load_source(case, overrides)
    click.echo(describe_scene(prepare(loaded, source, _say)))


@main.command()
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


@main.command()
@click.option("--json", "as_json", is_flag=True, help="JSON schema instead of Markdown.")
def schema(as_json: bool) -> None:
    """Print every key of a case file: type, default, range, meaning.

    Example: ddf schema > keys.md
    """
    from ddf.case.template import schema_json, schema_text

    click.echo(schema_json() if as_json else schema_text())


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def report(folder: Path) -> None:
    """Draw pictures, tables and report of a finished run again, from its checkpoint.

    Example: ddf report runs/first
    """
    from ddf.postprocess import rebuild_report

    click.echo(f"report: {rebuild_report(folder)}")
