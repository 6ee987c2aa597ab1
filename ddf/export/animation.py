"""The stages as an animation: the formed ply from above, frame by frame, with stage, time and pressures."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np

from ddf.build import load_path
from ddf.case import case_from_dict
from ddf.errors import UsageError
from ddf.export.part import chosen_plies, frame_times
from ddf.output import figures
from ddf.output.atomic import replacing
from ddf.output.charts import moment
from ddf.output.plots import formed_image
from ddf.output.reopen import formed_ply
from ddf.output.results import open_run
from ddf.output.snapshot import SheetSnapshot

PIXELS = 640
DPI = 100
HOLD_S = 2.0  # the last frame stays this long


def export_animation(
    path: str | Path, folder: str | Path, ply: str | None = None, kind: str = "gif", frames_per_s: int = 6
) -> Path:
    """Write stages-<ply>.gif or .mp4 of a forming run's frames (the top ply unless `ply` is given); returns its path.

    Raises UsageError for a kinematic run, which has no stages, one without frames, and for MP4 without ffmpeg.
    """
    from matplotlib.animation import FFMpegWriter, PillowWriter

    run = open_run(path)
    case = case_from_dict(tomllib.loads(run.resolved_text))
    if case.model == "kinematic":
        raise UsageError(f"{run.path} is a kinematic run: it has no stages to animate")
    name = chosen_plies(run, [] if ply is None else [ply])[-1]
    times = frame_times(run, name)
    if kind == "mp4" and not FFMpegWriter.isAvailable():
        raise UsageError("MP4 is made by ffmpeg, which is not installed", "install ffmpeg, or use --format gif")
    surfaces = [formed_ply(run, name, number) for number in range(len(times))]
    box = figures.view_box(np.concatenate([s.x[:, s.active] for s in (surfaces[0], surfaces[-1])], axis=1))
    figure = figures.new_figure(6.4, 7.0)
    axes = figures.plan_axes(figure, box, "")
    image = axes.imshow(np.ones((2, 2, 3)), extent=box, origin="lower", interpolation="antialiased")
    figures.scale_bar(axes, box)
    loads = load_path(case)
    target = Path(folder) / f"stages-{name}.{kind}"
    writer = (PillowWriter if kind == "gif" else FFMpegWriter)(fps=frames_per_s)
    with replacing(target) as temporary, writer.saving(figure, str(temporary), DPI):
        for time, surface in zip(times, surfaces, strict=True):
            sheet = SheetSnapshot(name, "ply", surface.x, surface.cell_fraction > 0, {}, {})
            image.set_data(formed_image(sheet, surface, box, PIXELS))
            axes.set_title(f"{name}, {moment(loads, time)}", loc="left", color=figures.INK, fontsize=figures.LABEL_PT)
            writer.grab_frame()
        for _ in range(int(HOLD_S * frames_per_s)):
            writer.grab_frame()
    return target
