"""ddf study: what speed costs in accuracy, and where the method fails."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ddf.commands.common import CASE, INTERRUPTED, MISSED, SET, SOME_FAILED, end_progress, fail, say, say_over


@click.group()
def study() -> None:
    """Study the method itself: speed against accuracy, and the limits of stability.

    Example: ddf study stability --quick
    """


@study.command("speed-accuracy")
@CASE
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder  [default: runs/speed-accuracy-CASE]")
@SET
@click.option("--axis", "axes", multiple=True, metavar="NAME", help="Only this axis (again for more); --list: names.")
@click.option(
    "--rungs",
    multiple=True,
    metavar="AXIS=V,V,...",
    help="Values of an axis, the finest last: factors, as in element=2,1,0.5, or names, as in bending=off,on.",
)
@click.option(
    "--design",
    type=click.Choice(["cross", "star", "grid"]),
    default="cross",
    show_default=True,
    help="One change at a time with every element size; on the case alone; all combinations.",
)
@click.option("--quick", is_flag=True, help="The cheapest value of each axis and the case's own, one change at a time.")
@click.option("--threads", type=click.IntRange(1, 1024), help="Threads of each run  [default: all cores, at most 8]")
@click.option(
    "--workers",
    type=click.IntRange(1, 1024),
    default=1,
    show_default=True,
    help="Runs at once; more than one spoils the times.",
)
@click.option("--resume", is_flag=True, help="Run what is missing, interrupted or failed.")
@click.option("--force", is_flag=True, help="Overwrite an earlier study in the folder.")
@click.option("--list", "only_list", is_flag=True, help="Show axes and rungs; run nothing.")
@click.option("--quiet", is_flag=True, help="No progress on stderr.")
def speed_accuracy(
    case: Path,
    output: Path | None,
    overrides: tuple[str, ...],
    axes: tuple[str, ...],
    rungs: tuple[str, ...],
    design: str,
    quick: bool,
    threads: int | None,
    workers: int,
    resume: bool,
    force: bool,
    only_list: bool,
    quiet: bool,
) -> None:
    """Run a case with cheaper and finer settings and hold each result against the finest one's.

    Leaves a chart, tables and the settings to copy. Example: ddf study speed-accuracy tetrahedron-0-90-coarse --quick
    """  # fmt: skip
    from ddf.study.axes import AXES
    from ddf.study.rungs import chosen_axes
    from ddf.study.speed_accuracy import make_study, run_study
    from ddf.sweep.plan import assignments

    values = {}
    for text in rungs:
        name, equals, listed = text.partition("=")
        if not equals or not listed:
            raise click.UsageError(f"--rungs {text}: AXIS=VALUE,VALUE,...")
        values[name] = listed.split(",")
    chosen = chosen_axes(axes, values, quick)
    made = make_study(case, dict(chosen), "star" if quick else design, overrides)
    if only_list:
        for name in chosen:
            click.echo(f"{name}: {AXES[name].meaning}; {', '.join(map(str, chosen[name]))}")
        for rung in made.rungs:
            click.echo(f"  {rung.name}: {' '.join(assignments(rung.changes))}")
        return
    folder = output or Path("runs") / f"speed-accuracy-{case.stem}"
    try:
        result = run_study(
            made, folder, resume=resume, force=force, workers=workers, threads=threads,
            report=None if quiet else lambda progress: say_over(_line(progress)),
        )  # fmt: skip
    except KeyboardInterrupt:
        click.echo(f"interrupted; go on with --resume -o {folder}", err=True)
        sys.exit(INTERRUPTED)
    end_progress(quiet)
    for item in result.results:
        if item.errors is None:
            click.echo(f"{item.state}: {item.rung.name}: {item.reason}")
    for item in result.front:
        seconds, error = item.pair
        uses = ", ".join(use for use, best in result.recommended.items() if best is item)
        click.echo(f"{item.rung.name}: {seconds:.3g} s, outline {error:.2g} mm off{f'  ({uses})' if uses else ''}")
    click.echo(f"chart, tables and settings to copy: {folder}/study.png, study.csv, study.json, study.md")
    if any(item.errors is None for item in result.results):
        sys.exit(SOME_FAILED)


def _line(p: Any) -> str:
    running = ", ".join(f"{name} {100 * share:.0f} %" for name, share in p.running.items())
    return (
        f"{p.finished} of {p.cases} finished, {p.failed} failed; running {running or 'none'}; "
        f"elapsed {p.elapsed_s:.0f} s"
    )


@study.command()
@click.argument("limits", nargs=-1, metavar="[LIMIT ...]")
@click.option("--list", "show", is_flag=True, help="List the limits and their rules; chart none.")
@click.option("--quick", is_flag=True, help="A few points of each map.")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default=Path("runs/stability"), show_default=True,
    help="Folder of the maps.",
)  # fmt: skip
def stability(limits: tuple[str, ...], show: bool, quick: bool, output: Path) -> None:
    """Chart where the method fails, the documented rule on it, and whether the guards see what is beyond.

    Exit code 4 where the safe side is not right, or a wrong result passes. Example: ddf study stability --quick step
    """  # fmt: skip
    from ddf.kernel_cache import warm_kernels
    from ddf.study.stability.registry import choose_limits
    from ddf.study.stability.runner import chart_all

    chosen = choose_limits(limits)
    if show:
        width = max(len(limit.name) for limit in chosen)
        for limit in chosen:
            click.echo(f"{limit.name.ljust(width)}  {limit.title}: {limit.rule}")
        return
    warm_kernels(say)
    failed = []
    for done in chart_all(chosen, quick, output, lambda limit: click.echo(f"{limit.name} ...", err=True)):
        counts = ", ".join(f"{count} {verdict}" for verdict, count in done.counts.items())
        click.echo(f"{done.limit.name}: {counts} ({done.wall_s:.1f} s)")
        for line in done.map.notes:
            click.echo(f"  note: {line}")
        for line in done.map.failures:
            click.echo(f"  FAILED: {line}")
        if done.map.failures:
            failed.append(done.limit.name)
    click.echo(f"maps: {output}")
    if failed:
        fail(f"not as the rules say: {', '.join(failed)}", MISSED)
