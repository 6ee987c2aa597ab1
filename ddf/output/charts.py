"""Charts of a run over time: energies with their ratios, and the stages as a strip of pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.output import figures
from ddf.output.plots import formed_image
from ddf.output.raster import Box
from ddf.output.snapshot import Snapshot

Columns = Mapping[str, NDArray[Any]]


def draw_energies(history: Columns) -> Any:
    """Energies [mJ] over process time, from the columns of history.csv; below, ratios [%]."""
    figure = figures.new_figure(9.0, 6.6)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    time = history["time_s"]
    for colour, (label, values) in zip(figures.COLOURS, _energy_lines(history).items(), strict=False):
        upper.plot(time, values, label=label, color=colour, linewidth=1.6)
    upper.set_ylabel("energy [mJ]")
    upper.set_title("Energies", loc="left", color=figures.INK, fontsize=11)
    upper.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    internal = np.maximum(history["kinetic_over_internal_percent"], 1e-4)
    lower.semilogy(time, internal, color=figures.COLOURS[1], linewidth=1.4, label="kinetic / internal")
    error = np.maximum(np.abs(history["energy_error_percent"]), 1e-4)
    lower.semilogy(time, error, color=figures.COLOURS[0], linewidth=1.2, label="|energy error|")
    lower.set(xlabel="process time [s]", ylabel="ratio [%]", ylim=(1e-3, 1e3))
    lower.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    _mark_stages((upper, lower), time, history["stage"])
    for axes in (upper, lower):
        axes.grid(color="#e5e8eb", linewidth=0.6)
        axes.tick_params(colors=figures.MUTED, labelsize=8)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _energy_lines(history: Columns) -> dict[str, NDArray[Any]]:
    """Curves by label [mJ]: strain by kind over all sheets, kinetic, contact, dissipated, work."""
    lines: dict[str, NDArray[Any]] = {
        "work of pressure and tool": history["work_pressure_mJ"] + history["work_tool_mJ"]
    }
    kinds = {
        "membrane": "diaphragms, stretching", "shear": "plies, shear", "bending": "bending",
        "fibre_tension": "plies, fibre tension",
    }  # fmt: skip
    for kind, label in kinds.items():
        parts = [v for key, v in history.items() if key.startswith(f"strain_{kind}_")]
        if parts:
            lines[label] = np.sum(parts, axis=0)
    lines["dissipated"] = np.sum([v for key, v in history.items() if key.startswith("dissipated_")], axis=0)
    lines["contact springs"] = history["contact_spring_mJ"]
    lines["kinetic"] = history["kinetic_mJ"]
    return lines


def _mark_stages(axes: Sequence[Any], time: NDArray[Any], stages: NDArray[Any]) -> None:
    """Lines where a stage ends, and the names of the stages over the upper axes."""
    starts = [0, *(np.flatnonzero(stages[1:] != stages[:-1]) + 1).tolist(), len(stages)]
    edges = [0.0, *(float(time[k - 1]) for k in starts[1:])]
    for one in axes:
        for edge in edges[1:-1]:
            one.axvline(edge, color=figures.MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    pad = 0.006 * max(edges[-1], 1e-12)
    for number, (edge, first) in enumerate(zip(edges[:-1], starts[:-1], strict=True)):
        axes[0].text(
            edge + pad, 0.985 if number % 2 == 0 else 0.935, str(stages[first]),
            transform=axes[0].get_xaxis_transform(), ha="left", va="top", fontsize=8, color=figures.MUTED,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1},
        )  # fmt: skip


def draw_stages(snapshots: Sequence[Snapshot], sheet: str | None = None, box: Box | None = None) -> Any:
    """The sheet (left out: the top one) at each snapshot as a strip, under one light and one scale."""
    if not snapshots:
        raise ValueError("no snapshots to draw")
    name = sheet or snapshots[0].sheets[-1].name
    frame = box or _strip_box(snapshots[-1])
    count = len(snapshots)
    figure = figures.new_figure(min(3.0 * count, 16.0), min(3.0, 16.0 / count) + 0.4)
    for number, snapshot in enumerate(snapshots, start=1):
        part = snapshot.sheet(name)
        title = f"{snapshot.stage}\n{1e3 * snapshot.time_s:.0f} ms, lift {snapshot.loads['tool_lift_mm']:.0f} mm"
        axes = figures.plan_axes(figure, frame, "", (1, count, number))
        axes.set_title(title, fontsize=8.5, color=figures.INK)
        axes.imshow(formed_image(part, None, frame, pixels=500), extent=frame, origin="lower")
        axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
        if number == count:
            figures.scale_bar(axes, frame)
    return figure


def _strip_box(last: Snapshot) -> Box:
    """The plies' box with room around it; all of the first sheet where there is no ply."""
    plies = [sheet for sheet in last.sheets if sheet.kind == "ply"] or [last.sheets[0]]
    return figures.view_box(np.concatenate([sheet.x.reshape(3, -1) for sheet in plies], axis=1), 40.0)
