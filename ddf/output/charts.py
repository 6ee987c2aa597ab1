"""Charts of a run over time: energies with their ratios, and the stages as a strip of pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.loads.path import LoadPath
from ddf.metrics import PlySurface
from ddf.output import figures
from ddf.output.plots import formed_image
from ddf.output.snapshot import SheetSnapshot

Columns = Mapping[str, NDArray[Any]]


def draw_energies(history: Columns, path: LoadPath) -> Any:
    """Energies [mJ] over process time, from the columns of history.csv; below, ratios [%]; stages of the load path."""
    figure = figures.new_figure(9.0, 6.6)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    time = history["time_s"]
    for colour, (label, values) in zip(figures.COLOURS, _energy_lines(history).items(), strict=False):
        upper.plot(time, values, label=label, color=colour, linewidth=1.6)
    upper.set_ylabel("energy [mJ]")
    upper.set_title("Energies", loc="left", color=figures.INK, fontsize=figures.TITLE_PT, pad=34)
    upper.legend(fontsize=figures.NOTE_PT, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    internal = np.maximum(history["kinetic_over_internal_percent"], 1e-4)
    lower.semilogy(time, internal, color=figures.COLOURS[1], linewidth=1.4, label="kinetic / internal")
    error = np.maximum(np.abs(history["energy_error_percent"]), 1e-4)
    lower.semilogy(time, error, color=figures.COLOURS[0], linewidth=1.2, label="|energy error|")
    lower.set(xlabel="process time [s]", ylabel="ratio [%]", ylim=(1e-3, 1e3))
    lower.legend(fontsize=figures.NOTE_PT, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    _mark_stages((upper, lower), path, float(time[-1]))
    for axes in (upper, lower):
        axes.grid(color="#e5e8eb", linewidth=0.6)
        axes.tick_params(colors=figures.MUTED, labelsize=figures.NOTE_PT)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _energy_lines(history: Columns) -> dict[str, NDArray[Any]]:
    """Curves by label [mJ]: strain by kind over all sheets, kinetic, contact, dissipated, work."""
    lines: dict[str, NDArray[Any]] = {
        "work of pressures and tool": np.sum([v for key, v in history.items() if key.startswith("work_")], axis=0)
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


def _mark_stages(axes: Sequence[Any], path: LoadPath, end: float) -> None:
    """Lines where a stage ends, and the names of the stages that began before `end` [s] over the upper axes."""
    for one in axes:
        for edge in path.time[1:-1][path.time[1:-1] < end]:
            one.axvline(edge, color=figures.MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    for number, (edge, name) in enumerate(zip(path.time[:-1], path.names, strict=True)):
        if edge < end:
            axes[0].text(
                edge, 1.012 if number % 2 == 0 else 1.06, name, transform=axes[0].get_xaxis_transform(),
                ha="left", va="bottom", fontsize=figures.NOTE_PT, color=figures.MUTED,
            )  # fmt: skip


def draw_stages(path: LoadPath, frames: Sequence[tuple[float, PlySurface]]) -> Any:
    """A ply at some times [s] as a strip from above, under one light and one scale."""
    if not frames:
        raise ValueError("no frames to draw")
    points = np.concatenate([surface.x[:, surface.active] for _, surface in frames], axis=1)
    box, count = figures.view_box(points), len(frames)
    columns = min(count, 3)
    rows = -(-count // columns)
    figure = figures.new_figure(3.6 * columns, 4.2 * rows)
    for number, (time, surface) in enumerate(frames, start=1):
        axes = figures.plan_axes(figure, box, "", (rows, columns, number))
        axes.set_title(moment(path, time), loc="left", fontsize=figures.NOTE_PT, color=figures.INK)
        sheet = SheetSnapshot(surface.name, "ply", surface.x, surface.cell_fraction > 0, {}, {})
        axes.imshow(formed_image(sheet, surface, box, pixels=500), extent=box, origin="lower")
        axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
        if number == count:
            figures.scale_bar(axes, box)
    return figure


def moment(path: LoadPath, time: float) -> str:
    """Stage, time, absolute pressures and lift at a time [s], on two lines."""
    now = path.at(time)
    stage = path.names[int(path.stage(time * (1.0 - 1e-6)))]
    return (
        f"{stage}: {1e3 * time:.0f} ms\ncavity {now['cavity_pressure_kPa']:.1f} kPa, "
        f"box {now['box_pressure_kPa']:.1f} kPa, lift {now['tool_lift_mm']:.0f} mm"
    )
