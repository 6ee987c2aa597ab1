"""Pictures of formed sheets in plan: as a photograph, shear angle, distance to the tool, outline and wrinkles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.mesh.tool import TriangleMesh
from ddf.metrics import PlySurface, WrinkleResult, boundary_profile, shear_angle
from ddf.metrics.surface import fill_inactive, gap_field
from ddf.output import figures
from ddf.output.raster import Box, TopView, view_from_above
from ddf.output.shading import RUBBER, brightness, drawn_lines, photograph
from ddf.output.snapshot import SheetSnapshot

Array = NDArray[np.float64]

SHEAR_RANGE_DEG = 60.0
DISTANCE_RANGE_MM = (-1.0, 10.0)
INSIDE = "#d55e00"  # where a ply is farther inside the tool than the range goes
PIXELS = 1100
"""Along the longer side of a view: as many as a figure has."""


def draw_formed(sheet: SheetSnapshot, surface: PlySurface | None = None, box: Box | None = None) -> Any:
    """A sheet from above as a photograph. A ply needs its surface (outline, fibre lines every 10 mm)."""
    frame = box or figures.view_box(_seen(sheet))
    figure = figures.new_figure(7.4, 7.4)
    note = " (lines every 10 mm along the fibres)" if surface is not None else ""
    axes = figures.plan_axes(figure, frame, f"{sheet.name} from above{note}")
    axes.imshow(formed_image(sheet, surface, frame), extent=frame, origin="lower", interpolation="antialiased")
    figures.scale_bar(axes, frame)
    return figure


def formed_image(
    sheet: SheetSnapshot,
    surface: PlySurface | None,
    box: Box,
    pixels: int = PIXELS,
    floor_mm: float | None = None,
) -> Array:
    """RGB image (rows, columns, 3), y upward, of a sheet as a photograph from above."""
    x = sheet.x if surface is None else fill_inactive(surface.x, surface.active)
    view = view_from_above(x, sheet.exists, box, pixels, surface, floor_mm)
    if sheet.kind == "diaphragm":
        return photograph(view, x, sheet.exists, RUBBER, gloss=0.20)
    ink = None if surface is None else drawn_lines(view, sheet.exists, surface.spacing)
    return photograph(view, x, sheet.exists, ink=ink)


def draw_shear(surface: PlySurface, box: Box | None = None) -> Any:
    """Map of the shear angle [deg] on the formed ply; range fixed to +-60 deg."""
    figure, axes, view, frame = _ply_map(surface, f"{surface.name}: shear angle", box)
    image = view.cells(shear_angle(surface))
    bar = coloured(figure, axes, view, surface, image, "PuOr", (-SHEAR_RANGE_DEG, SHEAR_RANGE_DEG))
    bar.set_label("shear angle [deg], positive: families closer than 90 deg", fontsize=figures.LABEL_PT)
    bar.set_ticks(np.arange(-60, 61, 15))
    figures.scale_bar(axes, frame)
    return figure


def draw_distance(surface: PlySurface, box: Box | None = None) -> Any:
    """Map of the gap to tool and platform [mm], 0 where the ply conforms; range -1 to 10 mm, red below 0."""
    figure, axes, view, frame = _ply_map(surface, f"{surface.name}: gap to the tool", box)
    image = view.nodes(fill_inactive(gap_field(surface), surface.active))
    bar = coloured(figure, axes, view, surface, image, "YlGnBu", DISTANCE_RANGE_MM, "both", INSIDE)
    bar.set_label(
        f"gap to tool and platform [mm], {_range_of(surface)}\n"
        "0: conforms; less: nearer than what lies between is thick",
        fontsize=figures.LABEL_PT,
    )
    figures.scale_bar(axes, frame)
    return figure


def _range_of(surface: PlySurface) -> str:
    """Least and largest gap of a ply's nodes."""
    gap = gap_field(surface)[surface.active]
    gap = gap[np.isfinite(gap)]
    return f"{gap.min():.2f} to {gap.max():.1f} here" if gap.size else "not known"


def draw_outline(surface: PlySurface, result: WrinkleResult | None, tool: TriangleMesh | None = None) -> Any:
    """Initial and formed outline, the tool's base, and the wrinkles: width by amplitude, numbered; None: not known."""
    from matplotlib.collections import LineCollection

    profile = boundary_profile(surface)
    points = np.concatenate([*profile.initial, *profile.deformed]).T
    frame = figures.view_box(points)
    figure = figures.new_figure(7.4, 8.3)
    axes = figures.plan_axes(
        figure, frame, f"{surface.name}: outline" + ("" if result is None else f" and {result.count} wrinkles")
    )
    for loops, style in (
        (
            profile.initial,
            {"color": figures.MUTED, "linestyle": (0, (5, 3)), "linewidth": 1.0, "label": "outline before"},
        ),
        (profile.deformed, {"color": figures.INK, "linewidth": 1.6, "label": "outline formed"}),
    ):
        for number, loop in enumerate(loops):
            closed = np.vstack([loop, loop[:1]])
            axes.plot(closed[:, 0], closed[:, 1], **(style if number == 0 else style | {"label": None}))
    if tool is not None:
        segments = base_segments(tool)
        axes.add_collection(LineCollection(list(segments), colors="#009e73", linewidths=1.2, label="tool at its base"))
    if result is not None:
        _draw_wrinkles(axes, result)
    figures.scale_bar(axes, frame)
    figure.legend(
        *axes.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=figures.NOTE_PT, frameon=False
    )
    return figure


def base_segments(tool: TriangleMesh, level_mm: float = 0.05) -> Array:
    """Where the tool's surface cuts the plane just over its platform: segments (s, 2, 2) in plan [mm]."""
    corners = tool.points[tool.triangles]
    above = corners[:, :, 2] > level_mm
    mixed = corners[above.any(axis=1) & ~above.all(axis=1)]
    cuts: list[list[Array]] = [[] for _ in mixed]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        za, zb = mixed[:, a, 2] - level_mm, mixed[:, b, 2] - level_mm
        for k in np.flatnonzero((za > 0) != (zb > 0)):
            share = za[k] / (za[k] - zb[k])
            cuts[k].append(mixed[k, a, :2] + share * (mixed[k, b, :2] - mixed[k, a, :2]))
    return np.array([cut for cut in cuts if len(cut) == 2]).reshape(-1, 2, 2)


def _draw_wrinkles(axes: Any, result: WrinkleResult) -> None:
    """Crests with their numbers; 1.2 points of width per mm of amplitude."""
    scale = 1.15 * float(np.ptp(axes.get_xlim())) / (72.0 * axes.figure.get_figwidth())  # about, layout is to come
    numbers: list[Array] = []
    for number, wrinkle in enumerate(result.wrinkles, start=1):
        crest = wrinkle.crest
        width = float(np.clip(1.2 * wrinkle.amplitude_mm, 0.8, 9.0))
        label = "wrinkle (width by amplitude)" if number == 1 else None
        axes.plot(
            crest[:, 0],
            crest[:, 1],
            color="#d55e00",
            linewidth=width,
            alpha=0.8,
            solid_capstyle="round",
            label=label,
        )
        where, beside = _free_place(crest, 9.0 + 0.5 * width, scale, numbers)
        numbers.append(where + scale * beside)
        axes.annotate(
            str(number), where, beside, textcoords="offset points",
            ha="center", va="center", fontsize=8.5, color=figures.INK,
            bbox={"boxstyle": "circle,pad=0.15", "facecolor": "white", "edgecolor": figures.MUTED, "linewidth": 0.5},
        )  # fmt: skip
    if result.wrinkles:
        largest = [f"{k}: {w.amplitude_mm:.1f}" for k, w in enumerate(result.wrinkles[:8], start=1)]
        more = ", ..." if result.count > 8 else ""
        text = f"amplitude [mm]  {',  '.join(largest)}{more}"
        axes.text(0.012, 0.988, text, transform=axes.transAxes, va="top", fontsize=figures.NOTE_PT, color=figures.MUTED)


def _free_place(crest: Array, points: float, scale: float, taken: list[Array]) -> tuple[Array, Array]:
    """Place on a crest, and way from it in points, square to the chord, of a number off those that are there.

    The middle, on the side away from the frame's centre, if that is free; scale: mm of a point of the drawing.
    """
    along = crest[-1, :2] - crest[0, :2]
    across = np.array([-along[1], along[0]]) * points / max(float(np.linalg.norm(along)), 1e-300)
    if across @ crest[len(crest) // 2, :2] < 0:
        across = -across
    places = [(crest[int(share * (len(crest) - 1)), :2], side * across)
              for share in (0.5, 0.3, 0.7, 0.1, 0.9) for side in (1.0, -1.0)]  # fmt: skip
    room = [min((math.dist(p + scale * way, q) for q in taken), default=math.inf) for p, way in places]
    enough = 15.0 * scale
    return next(
        (place for place, free in zip(places, room, strict=True) if free > enough), places[int(np.argmax(room))]
    )


def _ply_map(surface: PlySurface, title: str, box: Box | None) -> tuple[Any, Any, TopView, Box]:
    """Figure, axes, view and box of a map on the formed ply."""
    frame = box or figures.view_box(surface.x[:, surface.active])
    figure = figures.new_figure(8.2, 7.2)
    axes = figures.plan_axes(figure, frame, title)
    x = fill_inactive(surface.x, surface.active)
    view = view_from_above(x, surface.cell_fraction > 0, frame, PIXELS, surface)
    return figure, axes, view, frame


def coloured(
    figure: Any, axes: Any, view: TopView, surface: PlySurface, image: Array, colours: str,
    limits: tuple[float, float], extend: str = "neither", under: str | None = None,
) -> Any:  # fmt: skip
    """Draw an image in a colour map with a little relief, and its colour bar; `under`: colour below the limits."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    scale = ScalarMappable(Normalize(limits[0], limits[1]), colormaps[colours].with_extremes(under=under))
    rgb = scale.to_rgba(np.nan_to_num(image), norm=True)[..., :3]
    x = fill_inactive(surface.x, surface.active)
    light = np.clip(brightness(view, x, surface.cell_fraction > 0, cast=False)[0], 0.0, 1.2)
    rgb = np.clip(rgb * (0.78 + 0.22 * light)[..., None], 0.0, 1.0)
    rgb[~view.covered] = 1.0
    axes.imshow(rgb, extent=view.box, origin="lower", interpolation="antialiased")
    edge = view.covered.astype(float)
    axes.contour(edge, levels=[0.5], colors=figures.MUTED, linewidths=0.7, extent=view.box, origin="lower")
    bar = figure.colorbar(scale, ax=axes, shrink=0.85, extend=extend)
    bar.ax.tick_params(labelsize=figures.NOTE_PT)
    return bar


def _seen(sheet: SheetSnapshot) -> Array:
    """Points (3, k) to frame: those of a ply's cells; of a diaphragm the part that is not flat, with a margin."""
    there = np.pad(sheet.exists, 1)
    nodes = there[1:, 1:] | there[:-1, 1:] | there[1:, :-1] | there[:-1, :-1]
    points = sheet.x[:, nodes]
    if sheet.kind != "diaphragm":
        return points
    x, y, z = sheet.x
    raised = z > z.min() + 0.03 * max(float(np.ptp(z)), 1e-9)
    if not raised.any() or float(np.ptp(z)) < 2.0:
        return points
    reach = 1.5 * max(float(np.abs(x[raised]).max()), float(np.abs(y[raised]).max()))
    near = points[:, (np.abs(points[0]) <= reach) & (np.abs(points[1]) <= reach)]
    return near if near.size else points
