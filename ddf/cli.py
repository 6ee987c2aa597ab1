"""The command line: a thin layer over the Python API, and the only place that prints.

Exit codes: 0 ok; 1 failure; 2 usage or an invalid case; 3 unstable or an energy limit; 4 a verification missed
its bound; 5 some cases of a sweep failed; 130 interrupted.
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
from ddf.cli_export import export
from ddf.errors import DdfError

MISSED = 4
SOME_FAILED = 5
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
    """Simulate double diaphragm forming of woven fabric.

    \b
    ddf init my-case.toml          a commented case to start from
    ddf check my-case.toml         what would run, without running it
    ddf run my-case.toml           run it; results go to runs/my-case
    ddf verify --quick             solve problems with known answers
    ddf export fibres runs/my-case what the next program needs
    """  # noqa: D301 (click wants the character itself)


main.add_command(export)

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
    if not quiet and loaded.model == "forming":
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
        click.echo(_net_line(values) if "locked_area_percent" in values else _formed_line(values))
    for check in result.checks:
        mark = "ok  " if check["ok"] else "WARN"
        click.echo(f"{mark} {check['name']}: {check['value']:.3g} {check['unit']} (limit {check['limit']:g})")
    for note in result.notes:
        click.echo(f"note: {note}")
    click.echo(f"report: {result.folder / 'report.html'}")


def _formed_line(values: dict[str, Any]) -> str:
    return (
        f"{values['ply']}: {values['wrinkle_count']} wrinkles, {values['wrinkle_total_length_mm']:.0f} mm in all, "
        f"largest {values['wrinkle_largest_amplitude_mm']:.1f} mm high; shear up to "
        f"{values['shear_max_deg']:.1f} deg; largest gap to the tool {values['bridging_largest_mm'] or 0.0:.1f} mm"
    )


def _net_line(values: dict[str, Any]) -> str:
    return (
        f"{values['ply']}: shear up to {values['shear_max_deg']:.1f} deg, mean {values['shear_mean_deg']:.1f} deg; "
        f"{values['locked_area_percent']:.1f} % of the area beyond {values['locking_deg']:g} deg (locked); "
        f"net from ({values['start_x_mm']:.4g}, {values['start_y_mm']:.4g}, {values['start_z_mm']:.4g}) mm"
    )


@main.command()
@click.argument("case", type=click.Path(path_type=Path))
@_SET
def check(case: Path, overrides: tuple[str, ...]) -> None:
    """Check a case: meshes, physics that is on, step, steps, memory; nothing is run.

    Example: ddf check cases/tetrahedron-0-90.toml
    """
    from ddf.case.load import load_source
    from ddf.describe import describe_scene
    from ddf.net_run import describe_net
    from ddf.plausible import prepare

    loaded, source = load_source(case, overrides)
    if loaded.model == "kinematic":
        click.echo(describe_net(loaded))
    else:
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


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def report(folder: Path) -> None:
    """Draw pictures, tables and report of a finished run again, from its checkpoint.

    Example: ddf report runs/first
    """
    from ddf.postprocess import rebuild_report

    click.echo(f"report: {rebuild_report(folder)}")


@main.command()
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
        _fail(f"missed: {', '.join(missed)}", MISSED)


@main.command()
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


@main.command()
@click.argument("what", metavar="NAME|FILE")
@click.option("--case", type=click.Path(path_type=Path), help="Base case of a ready-made sweep.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder  [default: runs/sweep-NAME]")
@_SET
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

    plan = make_plan(what, case, overrides)
    if only_list:
        for point in plan.points:
            click.echo(f"{point.name}: {', '.join(assignments(point.changes))}")
        return
    folder = output or Path("runs") / f"sweep-{Path(what).stem}"
    try:
        result = run_sweep(
            plan, folder, resume=resume, force=force, workers=workers, threads=threads,
            scheduler=scheduler, report=None if quiet else _sweep_progress,
        )  # fmt: skip
    except KeyboardInterrupt:
        click.echo(f"interrupted; go on with --resume -o {folder}", err=True)
        sys.exit(INTERRUPTED)
    if not quiet and sys.stderr.isatty():
        click.echo("", err=True)
    computed = len(result.finished) - result.reused
    click.echo(
        f"{len(result.outcomes)} cases: {computed} computed, {result.reused} reused, {len(result.failed)} failed"
    )
    for outcome in result.failed:
        click.echo(f"failed: {outcome.name}: {outcome.reason}")
    for note in result.notes:
        click.echo(f"note: {note}")
    click.echo(f"table: {folder / 'table.csv'}; pictures: {folder / 'pictures'}")
    if result.failed:
        sys.exit(SOME_FAILED)


def _sweep_progress(p: Any) -> None:
    running = ", ".join(f"{name} {100 * share:.0f} %" for name, share in p.running.items())
    line = (
        f"{p.finished} of {p.cases} finished, {p.failed} failed; running {running or 'none'}; "
        f"elapsed {p.elapsed_s:.0f} s"
    )
    if sys.stderr.isatty():
        click.echo("\r" + line.ljust(140)[:200], nl=False, err=True)
    else:
        click.echo(line, err=True)
