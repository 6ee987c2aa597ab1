"""ddf export: what is taken from a finished run to the next program."""

from __future__ import annotations

from pathlib import Path

import click

_RUN = click.argument("run", type=click.Path(path_type=Path, exists=True, file_okay=False))
_OUTPUT = click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder  [default: RUN/export]")
_PLY = click.option("--ply", "plies", multiple=True, metavar="NAME", help="Only this ply; may be repeated.")


@click.group()
def export() -> None:
    """Fibres on the tool, flat patterns or an animation of a finished run.

    \b
    ddf export fibres runs/first
    ddf export flat-pattern runs/first --trim-offset 15
    ddf export animation runs/first
    """  # noqa: D301 (click wants the character itself)


@export.command()
@_RUN
@_PLY
@_OUTPUT
def fibres(run: Path, plies: tuple[str, ...], output: Path | None) -> None:
    """Fibre directions, shear angle and thickness of each element: VTU, and CSV on the tool's surface.

    Example: ddf export fibres runs/first -o out
    """
    from ddf.export.part import formed_part
    from ddf.export.tables import export_fibres

    for path in export_fibres(formed_part(run, plies), _folder(run, output)):
        click.echo(path)


@export.command("flat-pattern")
@_RUN
@click.option(
    "--trim", type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Trim line: CSV of x_mm, y_mm (from above) or x_mm, y_mm, z_mm, in the tool's frame.",
)  # fmt: skip
@click.option(
    "--trim-offset", type=click.FloatRange(0.0), metavar="MM", help="Or a line so far outside the tool's foot."
)
@_PLY
@_OUTPUT
def flat_pattern(
    run: Path, trim: Path | None, trim_offset: float | None, plies: tuple[str, ...], output: Path | None
) -> None:
    """What to cut from the flat fabric so that each formed ply ends at a trim line: DXF and SVG at 1:1.

    Example: ddf export flat-pattern runs/first --trim-offset 15
    """
    from ddf.export.loops import read_trim_line
    from ddf.export.part import formed_part
    from ddf.export.pattern import flat_patterns, foot_line
    from ddf.export.sheets import export_patterns

    if (trim is None) == (trim_offset is None):
        raise click.UsageError("give either --trim FILE or --trim-offset MM")
    line = None if trim is None else read_trim_line(trim)
    part = formed_part(run, plies)
    patterns = flat_patterns(part, foot_line(part.tool, trim_offset or 0.0) if line is None else line)
    for pattern in patterns:
        click.echo(
            f"{pattern.ply.surface.name}: {pattern.area_mm2:.0f} mm2 of fabric; formed, its edge is within "
            f"{max(pattern.error_mm, 0.001):.3f} mm of the trim line"
        )
        for note in pattern.notes:
            click.echo(f"note: {pattern.ply.surface.name}: {note}")
    for path in export_patterns(patterns, _folder(run, output), part.title):
        click.echo(path)


@export.command()
@_RUN
@click.option("--ply", metavar="NAME", help="Which ply  [default: the top one]")
@click.option("--format", "kind", type=click.Choice(["gif", "mp4"]), default="gif", show_default=True, help="File.")
@click.option("--fps", type=click.IntRange(1, 50), default=6, show_default=True, help="Frames a second.")
@_OUTPUT
def animation(run: Path, ply: str | None, kind: str, fps: int, output: Path | None) -> None:
    """The stages as a film: a ply from above with time, stage and pressures (output.frames_per_stage: how many).

    Example: ddf export animation runs/first
    """
    from ddf.export.animation import export_animation

    click.echo(export_animation(run, _folder(run, output), ply, kind, fps))


def _folder(run: Path, output: Path | None) -> Path:
    return run / "export" if output is None else output
