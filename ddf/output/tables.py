"""Tables of a run as CSV: history, boundary profiles, wrinkles; and the metrics as JSON. 1 N mm = 1 mJ."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ddf.errors import UsageError
from ddf.metrics import PlySurface, Wrinkle, WrinkleResult, boundary_profile, wrinkle_row
from ddf.monitors.energy import Energies
from ddf.output.atomic import write_errors
from ddf.output.folder import RunFolder

HISTORY = "history.csv"
LOADS = ("cavity_pressure_kPa", "box_pressure_kPa", "tool_lift_mm")


class HistoryWriter:
    """Appends a row a call to history.csv; every row is on disk when the call returns."""

    def __init__(self, folder: RunFolder, sheets: Sequence[str], resume_step: int | None = None) -> None:
        """`sheets`: names in the model's order. With `resume_step` the rows beyond it are cut off first."""
        self.path = folder / HISTORY
        self.sheets = tuple(sheets)
        self._columns: list[str] | None = None
        if resume_step is None or not self.path.exists():
            folder.write_text(HISTORY, "")
        else:
            self._columns = _cut(folder, resume_step)

    def append(
        self,
        step: int,
        time_s: float,
        stage: str,
        loads: Mapping[str, float],
        energies: Energies,
        step_s: float,
        wall_s: float,
    ) -> None:
        """Add one row. Raises UsageError if the table on disk has other columns, DdfError if it cannot be written."""
        row = {
            "step": step, "time_s": time_s, "stage": stage, **{key: loads[key] for key in LOADS},
            **energy_row(energies, self.sheets), "step_s": step_s, "wall_s": wall_s,
        }  # fmt: skip
        text = "" if self._columns else ",".join(row) + "\n"
        if self._columns and self._columns != list(row):
            raise UsageError(f"{self.path} has other columns than this run", "start again with --force")
        self._columns = list(row)
        line = io.StringIO()
        csv.writer(line, lineterminator="\n").writerow([_cell(value) for value in row.values()])
        with write_errors(self.path), self.path.open("a", encoding="utf-8", newline="") as stream:
            stream.write(text + line.getvalue())
            stream.flush()
            os.fsync(stream.fileno())


def energy_row(energies: Energies, sheets: Sequence[str]) -> dict[str, float]:
    """Energies [mJ] and ratios [%] of one row, by column."""
    row = {"kinetic_mJ": energies.total_kinetic, "strain_mJ": energies.total_strain}
    for name, kinetic, strain in zip(sheets, energies.kinetic, energies.strain, strict=True):
        row[f"kinetic_{name}_mJ"] = kinetic
        row.update({f"strain_{kind}_{name}_mJ": value for kind, value in strain.items()})
    row["contact_spring_mJ"] = energies.contact_spring
    row.update({f"dissipated_{kind}_mJ": value for kind, value in energies.dissipated.items()})
    row.update({f"work_{kind}_mJ": value for kind, value in energies.work.items()})
    row["energy_error_percent"] = 100 * energies.error_share
    row["kinetic_over_internal_percent"] = 100 * energies.kinetic_share()
    for k, name in enumerate(sheets):
        row[f"kinetic_over_internal_{name}_percent"] = 100 * energies.kinetic_share(k)
    return row


def write_profiles(folder: RunFolder, surfaces: Iterable[PlySurface]) -> None:
    """Write profiles/<ply>.csv: the outline's points in order, initial (x0 ..) and deformed (x ..) [mm]."""
    header = ["loop", "point", "x0_mm", "y0_mm", "z0_mm", "x_mm", "y_mm", "z_mm"]
    for surface in surfaces:
        profile = boundary_profile(surface)
        rows = [
            [loop, point, *start, *end]
            for loop, pair in enumerate(zip(profile.initial, profile.deformed, strict=True), start=1)
            for point, (start, end) in enumerate(zip(*pair, strict=True), start=1)
        ]
        write_table(folder, f"profiles/{surface.name}.csv", header, rows)


def write_pattern(folder: RunFolder, surface: PlySurface) -> None:
    """Write the flat pattern of a ply and where each of its points went.

    patterns/<ply>.csv: the outline to cut, loops in order (u, v: grid coordinates; x0, y0 [mm]).
    patterns/<ply>-nodes.csv: every node of the lattice, flat (x0 ..) and on the tool (x ..) [mm].
    """
    loops = boundary_profile(surface).initial
    rows: list[list[Any]] = []
    for loop, (points, grid) in enumerate(zip(loops, surface.outline, strict=True), start=1):
        rows += [[loop, k, *uv, *flat[:2]] for k, (flat, uv) in enumerate(zip(points, grid, strict=False), start=1)]
    write_table(folder, f"patterns/{surface.name}.csv", ["loop", "point", "u", "v", "x0_mm", "y0_mm"], rows)
    header = ["row", "col", "x0_mm", "y0_mm", "x_mm", "y_mm", "z_mm"]
    nodes = [[int(i), int(j), *surface.x0[:2, i, j], *surface.x[:, i, j]] for i, j in np.argwhere(surface.active)]
    write_table(folder, f"patterns/{surface.name}-nodes.csv", header, nodes)


def write_wrinkles(folder: RunFolder, results: Iterable[WrinkleResult]) -> None:
    """Write wrinkles.csv: one row a wrinkle, numbered within its ply by falling amplitude as in the pictures."""
    blank = {name: np.zeros(3) for name in ("start", "end", "crest")}
    header = ["number", *wrinkle_row(Wrinkle(**dict.fromkeys(Wrinkle.__dataclass_fields__, 0.0) | blank))]  # type: ignore[arg-type]
    rows = [
        [number, *wrinkle_row(wrinkle).values()]
        for result in results
        for number, wrinkle in enumerate(result.wrinkles, start=1)
    ]
    write_table(folder, "wrinkles.csv", header, rows)


def write_metrics(folder: RunFolder, plies: Sequence[Mapping[str, Any]], **more: Any) -> None:
    """Write metrics.json: {"plies": [table of each ply], ...}."""
    folder.write_json("metrics.json", {"plies": [dict(ply) for ply in plies], **more})


def read_table(path: Path) -> list[dict[str, str]]:
    """Rows of a CSV table as text by column; a last line that was cut short is left out."""
    with path.open(encoding="utf-8", newline="") as stream:
        text = stream.read()
    return list(csv.DictReader(io.StringIO(text[: text.rfind("\n") + 1])))


def _cut(folder: RunFolder, step: int) -> list[str] | None:
    """Cut history.csv after the rows up to a step; returns its columns, None if it has none."""
    text = (folder / HISTORY).read_text(encoding="utf-8")
    lines = text[: text.rfind("\n") + 1].splitlines(keepends=True)
    if not lines:
        folder.write_text(HISTORY, "")
        return None
    kept = [line for line in lines[1:] if int(line.split(",", 1)[0]) <= step]
    folder.write_text(HISTORY, "".join([lines[0], *kept]))
    return lines[0].strip().split(",")


def write_table(folder: RunFolder, name: str, header: list[str], rows: list[list[Any]]) -> Path:
    """Write rows as CSV, floats with nine digits, and return its path. Raises DdfError."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([[_cell(value) for value in row] for row in rows])
    return folder.write_text(name, text.getvalue())


def _cell(value: Any) -> Any:
    """Floats with nine digits; all else as it is."""
    return f"{value:.9g}" if isinstance(value, float) else value
