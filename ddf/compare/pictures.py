"""Pictures of two runs beside and over one another."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.compare.fields import ShearDifference
from ddf.compare.sites import Row
from ddf.metrics import PlySurface, shear_angle
from ddf.metrics.surface import fill_inactive
from ddf.output import figures
from ddf.output.plots import SHEAR_RANGE_DEG, coloured, formed_image
from ddf.output.raster import view_from_above
from ddf.output.snapshot import SheetSnapshot

Array = NDArray[np.float64]

DIFFERENCE_RANGE_DEG = 15.0
PIXELS = 800
MEASURED = "#000000"


def common_box(surfaces: list[PlySurface]) -> Any:
    """A box in plan around several formed plies."""
    return figures.view_box(np.concatenate([surface.x[:, surface.active] for surface in surfaces], axis=1))


def ply_photograph(surface: PlySurface, box: Any, pixels: int = PIXELS) -> Array:
    """The formed ply as a photograph from above, RGB."""
    sheet = SheetSnapshot(surface.name, "ply", surface.x, surface.cell_fraction > 0, {}, {})
    return formed_image(sheet, surface, box, pixels)


def draw_side_by_side(surfaces: list[PlySurface], labels: list[str]) -> Any:
    """Photographs of the formed plies beside one another, to one scale."""
    box = common_box(surfaces)
    figure = figures.new_figure(6.2 * len(surfaces), 6.4)
    for place, (surface, label) in enumerate(zip(surfaces, labels, strict=True), start=1):
        axes = figures.plan_axes(figure, box, label, (1, len(surfaces), place))
        axes.imshow(ply_photograph(surface, box), extent=box, origin="lower", interpolation="antialiased")
        figures.scale_bar(axes, box)
    return figure


def draw_shear_maps(first: PlySurface, second: PlySurface, labels: list[str], difference: ShearDifference) -> Any:
    """Shear of both runs and their difference on the first one's formed ply."""
    box = common_box([first, second])
    figure = figures.new_figure(18.0, 5.6)
    shear = (-SHEAR_RANGE_DEG, SHEAR_RANGE_DEG)
    gap = (-DIFFERENCE_RANGE_DEG, DIFFERENCE_RANGE_DEG)
    text = f"difference: {difference.rms_deg:.1f} deg rms" + ("" if difference.signed else " (of sizes)")
    maps = (
        (labels[0], first, shear_angle(first), "PuOr", shear),
        (labels[1], second, shear_angle(second), "PuOr", shear),
        (text, first, difference.map_deg, "RdBu_r", gap),
    )
    for place, (title, surface, values, colours, limits) in enumerate(maps, start=1):
        axes = figures.plan_axes(figure, box, title, (1, 3, place))
        x = fill_inactive(surface.x, surface.active)
        view = view_from_above(x, surface.cell_fraction > 0, box, PIXELS, surface)
        bar = coloured(figure, axes, view, surface, view.cells(np.nan_to_num(values)), colours, limits,
                       "both" if limits == gap else "neither")  # fmt: skip
        bar.set_label("shear angle [deg]", fontsize=8)
        figures.scale_bar(axes, box)
    return figure


def draw_outlines(
    outlines: list[list[Array]], labels: list[str], wrinkles: list[list[Row]] | None = None,
    measured: Array | None = None, title: str = "outlines",
) -> Any:  # fmt: skip
    """Outlines (k, 2) over one another, with the wrinkles of each as straight lines from start to end."""
    everything = np.concatenate([loop for loops in outlines for loop in loops])
    box = figures.view_box(everything.T)
    figure = figures.new_figure(7.4, 7.8)
    axes = figures.plan_axes(figure, box, title)
    for number, (loops, label) in enumerate(zip(outlines, labels, strict=True)):
        colour = figures.COLOURS[number % len(figures.COLOURS)]
        for k, loop in enumerate(loops):
            closed = np.vstack([loop, loop[:1]])
            axes.plot(*closed.T, color=colour, linewidth=1.5, label=label if k == 0 else None)
        for wrinkle in wrinkles[number] if wrinkles else []:
            ends = [[wrinkle[f"{end}_{axis}_mm"] for end in ("start", "end")] for axis in "xy"]
            width = float(np.clip(1.2 * wrinkle["amplitude_mm"], 0.8, 9.0))
            axes.plot(*ends, color=colour, linewidth=width, alpha=0.55, solid_capstyle="round")
    if measured is not None:
        axes.plot(*measured.T, ".", color=MEASURED, markersize=3, label="measured")
    figures.scale_bar(axes, box)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    return figure
