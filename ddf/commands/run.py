"""ddf run: a case from its start to its report."""

from __future__ import annotations

import shlex
import signal
import sys
from pathlib import Path
from typing import Any

import click

from ddf.commands.common import CASE, INTERRUPTED, SET, end_progress, fail, say, say_over
from ddf.errors import DdfError


@click.command()
@CASE
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Run folder  [default: runs/CASE]")
@SET
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
    """Run a case (a file, or a shipped one by its name) and leave frames, tables, pictures and a report in a folder.

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
        click.echo("meshing ...", err=True)
    try:
        result = run_case(
            loaded, folder, case_text=None if overrides else source.text, threads=threads, resume=resume, force=force,
            report=None if quiet else lambda progress: say_over(str(progress)), source=source, warn=say,
        )  # fmt: skip
    except KeyboardInterrupt:
        fail(f"interrupted{_resumable(folder, again)}", INTERRUPTED)
    except DdfError as error:
        retry = _resumable(folder, again) if error.exit_code == 1 else ""
        fail(f"{error}{retry}", error.exit_code)
    end_progress(quiet)
    if result.stop_reason == "interrupted":
        click.echo(f"interrupted at {result.time_s:.5f} s; go on with: {again}", err=True)
        sys.exit(INTERRUPTED)
    _summary(result)


def _resumable(folder: Path, again: str) -> str:
    """What to do about a run that was stopped, if it has a checkpoint."""
    there = (folder / "checkpoint.npz").is_file()
    return f"\n  the last checkpoint stands; go on with: {again}" if there else ""


def _summary(result: Any) -> None:
    click.echo(f"finished: {result.folder}")
    wall = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result.wall_s.items())
    click.echo(f"wall time: {wall}")
    for values in result.plies:
        click.echo(_net_line(values) if "locked_area_percent" in values else _formed_line(values))
    for check in result.checks:
        mark, remedy = ("ok  ", "") if check["ok"] else ("WARN", f": {check['remedy']}")
        click.echo(f"{mark} {check['name']}: {check['value']:.3g} {check['unit']} (limit {check['limit']:g}){remedy}")
    for note in result.notes:
        click.echo(f"note: {note}")
    click.echo(f"report: {result.folder / 'report.html'}")


def _formed_line(values: dict[str, Any]) -> str:
    return (
        f"{values['ply']}: {values['wrinkle_count']} wrinkles, {values['wrinkle_total_length_mm']:.0f} mm in all, "
        f"largest {values['wrinkle_largest_amplitude_mm']:.1f} mm high; shear up to "
        f"{values['shear_max_deg']:.1f} deg{_gap(values)}"
    )


def _gap(values: dict[str, Any]) -> str:
    if values["gap_largest_mm"] is None:  # there is no tool
        return ""
    outside = values["bridging_largest_mm"]
    return f"; largest gap to the tool {values['gap_largest_mm']:.1f} mm, outside wrinkles {outside:.1f} mm"


def _net_line(values: dict[str, Any]) -> str:
    return (
        f"{values['ply']}: shear up to {values['shear_max_deg']:.1f} deg, mean {values['shear_mean_deg']:.1f} deg; "
        f"{values['locked_area_percent']:.1f} % of the area beyond {values['locking_deg']:g} deg (locked); "
        f"net from ({values['start_x_mm']:.4g}, {values['start_y_mm']:.4g}, {values['start_z_mm']:.4g}) mm"
    )
