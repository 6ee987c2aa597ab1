"""One table of a sweep: a row a case and ply."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from ddf.output.results import open_run
from ddf.sweep.manifest import FINISHED, Entry, Outcome, SweepFolder
from ddf.sweep.plan import Point, scalar_keys

METRICS = (
    "wrinkle_count", "wrinkle_total_length_mm", "wrinkle_largest_amplitude_mm", "wrinkled_area_percent",
    "shear_mean_deg", "shear_p95_deg", "shear_max_deg", "gap_largest_mm",
    "gap_area_percent", "bridging_largest_mm", "bridged_area_percent",
    "locked_area_percent", "outline_area_mm2",
)  # fmt: skip
DRAW_IN = ("draw_in_mid_side_mean_mm", "draw_in_corner_mean_mm")


def swept_keys(entries: list[Entry]) -> list[str]:
    """Keys with numbers or text that are not the same in all cases."""
    keys = scalar_keys([Point(entry.name, entry.changes) for entry in entries])
    return [key for key in keys if len({str(entry.changes.get(key)) for entry in entries}) > 1]


def sweep_rows(folder: SweepFolder, entries: list[Entry], outcomes: dict[str, Outcome]) -> list[dict[str, Any]]:
    """Rows: case, state, reason, wall time, swept keys, checks that failed, ply, metrics; None: not known."""
    rows = []
    for entry in entries:
        outcome = outcomes[entry.name]
        head = {"case": entry.name, "state": outcome.state, "reason": outcome.reason.replace("\n", " "),
                "wall_s": round(outcome.wall_s, 1)}  # fmt: skip
        head |= {key: entry.changes.get(key) for key in swept_keys(entries)}
        tables: list[dict[str, Any]] = [{}]
        missed = None
        if outcome.state == FINISHED:
            run = open_run(folder.run_folder(entry.name))
            tables, missed = run.metrics["plies"], "; ".join(c["name"] for c in run.info["audit"] if not c["ok"])
        for ply in tables:
            row = head | {"audit_misses": missed, "ply": ply.get("ply")} | {key: ply.get(key) for key in METRICS}
            for key in DRAW_IN:
                values = ply.get(key.replace("_mean", "")) or {}
                row[key] = float(np.mean(list(values.values()))) if values else None
            rows.append(row)
    return rows


SHOWN = {
    "wrinkle_count": "wrinkles", "wrinkle_total_length_mm": "length mm", "wrinkle_largest_amplitude_mm": "highest mm",
    "wrinkled_area_percent": "wrinkled %", "shear_p95_deg": "95 % of shear below deg", "gap_largest_mm": "gap mm",
    "locked_area_percent": "locked %", "outline_area_mm2": "outline mm2",
}  # fmt: skip
"""Columns of the table for people, and their heads."""


def table_lines(rows: list[dict[str, Any]]) -> list[str]:
    """The rows of what finished as lines of text: case, ply, the metrics that are known, how many checks failed."""
    done = [row for row in rows if row["state"] == FINISHED]
    columns = {key: head for key, head in SHOWN.items() if any(row[key] is not None for row in done)}
    if not columns:
        return []
    cells = [["case", "ply", *columns.values(), "checks missed"]]
    for row in done:
        values = ["-" if row[key] is None else f"{row[key]:.4g}" if abs(row[key]) < 1e4 else f"{row[key]:.0f}"
                  for key in columns]  # fmt: skip
        cells.append([row["case"], row["ply"], *values, str(len([c for c in row["audit_misses"].split("; ") if c]))])
    widths = [max(len(line[k]) for line in cells) for k in range(len(cells[0]))]
    return [
        "  ".join(
            cell.ljust(width) if k < 2 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        )
        for line in cells
    ]


def write_rows(folder: SweepFolder, rows: list[dict[str, Any]]) -> None:
    """Write table.csv; metrics that no case has are left out."""
    text = io.StringIO()
    empty = [key for key in METRICS if all(row[key] is None for row in rows)]
    writer = csv.DictWriter(
        text, [key for key in rows[0] if key not in empty], lineterminator="\n", extrasaction="ignore"
    )
    writer.writeheader()
    for row in rows:
        writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})
    folder.out.write_text("table.csv", text.getvalue())
