"""The picture of a claim: the formed plies it is about with their wrinkles, and each quantity over its threshold."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np

from ddf.claims.formed import Formed, FormedPly
from ddf.claims.verdict import FAILS, HOLDS, Finding, Judged, Panel, Runs
from ddf.compare.pictures import common_box, ply_photograph
from ddf.metrics import shear_angle
from ddf.metrics.surface import fill_inactive
from ddf.output import figures
from ddf.output.plots import SHEAR_RANGE_DEG, coloured
from ddf.output.raster import view_from_above

PIXELS = 600
STATE_COLOURS = {HOLDS: "#009e73", FAILS: "#d55e00"}  # else grey
WRINKLE = "#d55e00"


def draw_claim(item: Judged, runs: Runs) -> Any:
    """Panels of the claim's plies in a row, and below them its quantities over their thresholds."""
    shown = [panel for panel in item.claim.panels if runs.get(panel.forming)]
    rated = [f for f in item.findings if f.relation and not f.reason]
    figure = figures.new_figure(max(9.0, 4.4 * len(shown)), (4.8 if shown else 0.0) + 1.4 + 0.32 * max(len(rated), 1))
    parts = figure.subfigures(2, 1, height_ratios=(4.8 if shown else 0.01, 1.4 + 0.32 * max(len(rated), 1)))
    if shown:
        plies = [runs[panel.forming][0].plies[panel.ply] for panel in shown]
        box = common_box([ply.surface for ply in plies])
        for place, (panel, ply) in enumerate(zip(shown, plies, strict=True), start=1):
            _draw_panel(parts[0], panel, ply, runs[panel.forming][0], box, (1, len(shown), place))
    if rated:
        _draw_findings(parts[1].subplots(), rated)
    else:
        reasons = "\n".join(textwrap.fill(f"{f.quantity}: {f.reason}", 110) for f in item.findings if f.reason)
        parts[1].text(0.02, 0.8, f"no evidence\n{reasons}", va="top", fontsize=8, color=figures.MUTED)
    title = f"Claim {item.claim.number}: {item.claim.title}: {item.verdict}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=figures.TITLE_PT, color=figures.INK)
    return figure


def _draw_panel(figure: Any, panel: Panel, ply: FormedPly, run: Formed, box: Any, place: tuple[int, int, int]) -> None:
    title = panel.forming if len(run.plies) == 1 else f"{panel.forming}: {ply.name}"
    axes = figures.plan_axes(figure, box, title, place)
    axes.set_title(title, loc="left", fontsize=figures.LABEL_PT, color=figures.INK)
    axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
    surface = ply.surface
    if panel.shear:
        view = view_from_above(
            fill_inactive(surface.x, surface.active), surface.cell_fraction > 0, box, PIXELS, surface
        )
        limits = (-SHEAR_RANGE_DEG, SHEAR_RANGE_DEG)
        bar = coloured(figure, axes, view, surface, view.cells(shear_angle(surface)), "PuOr", limits)
        bar.set_label("shear angle [deg]", fontsize=8)
        for loop in ply.outlines[0]:
            axes.plot(*np.vstack([loop, loop[:1]]).T, color=figures.MUTED, linewidth=0.9, linestyle=(0, (5, 3)))
    else:
        axes.imshow(ply_photograph(surface, box, PIXELS), extent=box, origin="lower", interpolation="antialiased")
    for row in ply.wrinkles:
        ends = [[row[f"{end}_{axis}_mm"] for end in ("start", "end")] for axis in "xy"]
        width = float(np.clip(0.35 * row["amplitude_mm"], 0.8, 6.0))
        axes.plot(*ends, color=WRINKLE, linewidth=width, alpha=0.6, solid_capstyle="round")
    axes.plot(*run.axis_xy, "+", color=figures.INK, markersize=7)
    figures.scale_bar(axes, box)


def _draw_findings(axes: Any, rated: list[Finding]) -> None:
    """Every quantity over its threshold on a logarithmic scale: point, and bar from the lowest to the highest."""
    for line, finding in enumerate(rated):
        colour = STATE_COLOURS.get(finding.state, figures.MUTED)
        scale = finding.threshold if finding.threshold > 0 else 1.0
        value, low, high = (max(v / scale, 0.02) for v in (finding.value, finding.low, finding.high))
        axes.plot([low, high], [line, line], color=colour, linewidth=3, alpha=0.5, solid_capstyle="butt")
        axes.plot([value], [line], "o", color=colour, markersize=6)
        side = "→" if finding.relation == "above" else "←"
        axes.annotate(f"{side} {finding.state}", (1.0, line), xycoords=("axes fraction", "data"), xytext=(6, 0),
                      textcoords="offset points", va="center", fontsize=8, color=colour)  # fmt: skip
    axes.axvline(1.0, color=figures.INK, linewidth=1.0)
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    low, high = min(low, 0.5), max(high, 2.0)
    ticks = [tick for tick in (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if low <= tick <= high]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_xlim(low, high)
    axes.set_yticks(range(len(rated)), [f.quantity for f in rated], fontsize=8)
    axes.set_ylim(len(rated) - 0.4, -0.6)
    axes.set_xlabel("value over threshold; the arrow points to the side that the claim expects", fontsize=8)
    axes.tick_params(colors=figures.MUTED, labelsize=8, which="both")
    axes.grid(color="#e5e8eb", linewidth=0.6, axis="x")
    axes.spines[["top", "right"]].set_visible(False)
