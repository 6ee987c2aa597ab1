"""The picture of a map: verdicts as markers, the documented rule as lines."""

from __future__ import annotations

from typing import Any

import numpy as np

from ddf.output import figures
from ddf.study.stability.map import REFUSED, STABLE, STOPPED, VERDICTS, WARNED, WRONG, Limit, Map

#: colour and marker of each verdict: blue is right, orange and black are caught, a red cross is not
STYLES = {
    STABLE: (figures.COLOURS[0], "o"),
    REFUSED: (figures.COLOURS[6], "s"),
    STOPPED: (figures.COLOURS[7], "^"),
    WARNED: (figures.COLOURS[4], "D"),
    WRONG: (figures.COLOURS[1], "X"),
}
MARGIN = 0.12  # beside the spots, of their range
DASHES = ("-", "--", ":", "-.")


def _limits(axes: Any, chart: Map) -> None:
    """All spots with a margin on every side; lines do not move it."""
    for logarithmic, values, limit in (
        (chart.log_x and not chart.symlog_x, [spot.x for spot in chart.spots], axes.set_xlim),
        (chart.log_y, [spot.y for spot in chart.spots], axes.set_ylim),
    ):
        low, high = min(values), max(values)
        if logarithmic:
            margin = (high / low) ** MARGIN if high > low else 2.0
            limit(low / margin, high * margin)
        elif chart.symlog_x and limit == axes.set_xlim:
            limit(low - MARGIN * chart.symlog_x, 3.0 * high)
        else:
            margin = MARGIN * (high - low) or 1.0
            limit(low - margin, high + margin)


def draw_map(limit: Limit, chart: Map) -> Any:
    """Spots that the rule calls safe are filled, the others hollow; each bears what was measured."""
    figure = figures.new_figure(8.6, 5.2)
    axes = figure.subplots()
    for verdict, meaning in VERDICTS.items():
        colour, marker = STYLES[verdict]
        for safe in (True, False):
            spots = [spot for spot in chart.spots if spot.verdict == verdict and spot.safe == safe]
            if spots:
                face = colour if safe else "none"
                label = f"{meaning}, {'within' if safe else 'beyond'} the rule"
                axes.scatter([s.x for s in spots], [s.y for s in spots], s=64, marker=marker, facecolors=face,
                             edgecolors=colour, linewidths=1.4, label=label, zorder=3)  # fmt: skip
    for spot in chart.spots:
        if np.isfinite(spot.measure):
            axes.annotate(f"{spot.measure:.2g}", (spot.x, spot.y), (7, -3), textcoords="offset points", fontsize=7,
                          color=figures.MUTED)  # fmt: skip
    axes.set(xscale="log" if chart.log_x else "linear", yscale="log" if chart.log_y else "linear")
    if chart.symlog_x:
        axes.set_xscale("symlog", linthresh=chart.symlog_x)
    for axis, logarithmic in ((axes.xaxis, chart.log_x and not chart.symlog_x), (axes.yaxis, chart.log_y)):
        if logarithmic:
            figures.label_logarithmic(axis)
    _limits(axes, chart)
    for number, line in enumerate(chart.lines):
        axes.plot(line.x, line.y, DASHES[number % len(DASHES)], color=figures.COLOURS[2], linewidth=1.5,
                  label=line.name)  # fmt: skip
    axes.set_xlabel(chart.x_label, fontsize=figures.LABEL_PT)
    axes.set_ylabel(chart.y_label, fontsize=figures.LABEL_PT)
    axes.set_title(f"{limit.title}\nnumbers: {chart.measure}", loc="left", color=figures.INK, fontsize=11)
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.grid(color="#e5e8eb", linewidth=0.6)
    axes.tick_params(colors=figures.MUTED, labelsize=8, which="both")
    axes.spines[["top", "right"]].set_visible(False)
    return figure
