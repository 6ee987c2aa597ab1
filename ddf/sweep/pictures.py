"""Comparing pictures of a sweep: the formed plies as small multiples, metrics over the swept keys, outlines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ddf.compare.pictures import common_box, draw_outlines, ply_photograph
from ddf.metrics import PlySurface
from ddf.output import figures
from ddf.output.reopen import formed_ply, plies_of
from ddf.output.results import open_run
from ddf.sweep.manifest import FINISHED, Entry, Outcome, SweepFolder

MOST_PANELS = 25
MOST_KEYS = 4
CURVES = (
    ("wrinkle_count", "wrinkles"),
    ("wrinkle_total_length_mm", "wrinkle length [mm]"),
    ("wrinkle_largest_amplitude_mm", "largest amplitude [mm]"),
    ("draw_in_mid_side_mean_mm", "draw-in, sides [mm]"),
    ("shear_p95_deg", "shear, 95th perc. [deg]"),
)


def draw_sweep(
    folder: SweepFolder, entries: list[Entry], outcomes: dict[str, Outcome], rows: list[dict[str, Any]],
    keys: list[str], title: str,
) -> None:  # fmt: skip
    """Write formed.png, outlines.png (top plies) and curves.png of the cases that finished."""
    done = [entry.name for entry in entries if outcomes[entry.name].state == FINISHED]
    if not done:
        return
    runs = [open_run(folder.run_folder(name)) for name in done[:MOST_PANELS]]
    surfaces = [formed_ply(run, plies_of(run)[-1]) for run in runs]
    figures.save_picture(folder.out, "formed", draw_formed_plies(surfaces, done[:MOST_PANELS]))
    outlines = []
    for surface, run in zip(surfaces, runs, strict=True):
        profile = run.profile(surface.name)
        points = np.stack([profile["x_mm"], profile["y_mm"]], axis=1)
        outlines.append([points[profile["loop"] == number] for number in np.unique(profile["loop"])])
    figures.save_picture(folder.out, "outlines", draw_outlines(outlines, done[:MOST_PANELS], title=title))
    figures.save_picture(folder.out, "curves", draw_curves(rows, keys, title))


def draw_formed_plies(surfaces: list[PlySurface], labels: list[str]) -> Any:
    """Photographs of formed plies to one scale."""
    box = common_box(surfaces)
    columns = min(4, math.ceil(math.sqrt(len(surfaces))))
    lines = math.ceil(len(surfaces) / columns)
    figure = figures.new_figure(4.0 * columns, 4.3 * lines)
    for place, (surface, label) in enumerate(zip(surfaces, labels, strict=True), start=1):
        axes = figures.plan_axes(figure, box, "", (lines, columns, place))
        axes.set_title(f"{label} ({surface.name})", fontsize=9, loc="left", color=figures.INK)
        axes.imshow(ply_photograph(surface, box, 500), extent=box, origin="lower", interpolation="antialiased")
        axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
        figures.scale_bar(axes, box)
    return figure


def draw_curves(rows: list[dict[str, Any]], keys: list[str], title: str) -> Any:
    """Metrics of each ply over each swept key with numbers (or, with none, over the cases).

    Points that differ in one key only are joined.
    """
    known = [row for row in rows if row["state"] == FINISHED]
    numeric = [key for key in keys if all(isinstance(row[key], int | float) for row in known)][:MOST_KEYS]
    shown = [(key, label) for key, label in CURVES if any(row[key] is not None for row in known)]
    columns = numeric or ["case"]
    figure = figures.new_figure(4.4 * max(len(columns), 1) + 1.6, 2.1 * len(shown) + 0.6)
    grid = figure.subplots(len(shown), len(columns), squeeze=False, sharex="col")
    plies = list(dict.fromkeys(row["ply"] for row in known))
    for line, (metric, label) in enumerate(shown):
        for column, key in enumerate(columns):
            axes = grid[line][column]
            for number, ply in enumerate(plies):
                colour = figures.COLOURS[number % len(figures.COLOURS)]
                _curve(axes, [row for row in known if row["ply"] == ply], key, keys, metric, colour, ply)
            low, high = axes.get_ylim()
            axes.set_ylim(min(0.0, low), high + 0.05 * (high - min(0.0, low)))  # a small change should look small
            axes.grid(color="#e5e8eb", linewidth=0.6)
            axes.tick_params(colors=figures.MUTED, labelsize=8)
            axes.spines[["top", "right"]].set_visible(False)
            if column == 0:
                axes.set_ylabel(label, fontsize=8)
            if line == len(shown) - 1:
                axes.set_xlabel(key, fontsize=9)
                if key == "case":
                    axes.tick_params(axis="x", rotation=30)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, color=figures.INK)
    handles, names = grid[0][0].get_legend_handles_labels()
    unique = dict(zip(names, handles, strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside right upper", fontsize=8, frameon=False)
    return figure


def _curve(
    axes: Any, rows: list[dict[str, Any]], key: str, keys: list[str], metric: str, colour: str, ply: str
) -> None:
    groups: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        if row[metric] is not None:
            others = [str(row[other]) for other in keys if other != key] if key != "case" else []
            groups.setdefault("|".join(others), []).append(row)
    for group in groups.values():
        points = sorted(((row[key], row[metric]) for row in group), key=lambda p: p[0]) if key != "case" else \
            [(row[key], row[metric]) for row in group]  # fmt: skip
        style = "o" if key == "case" else "o-"
        axes.plot(*zip(*points, strict=True), style, color=colour, markersize=4, linewidth=1.2, label=ply)
