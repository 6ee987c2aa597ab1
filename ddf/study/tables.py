"""Tables of a speed-accuracy study: CSV, JSON and markdown, with the settings to copy."""

from __future__ import annotations

import csv
import io
import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ddf.output.folder import RunFolder
from ddf.provenance import provenance
from ddf.study.front import USES, Result
from ddf.study.rungs import Rung
from ddf.sweep.plan import Plan, assignments

COLUMNS = (
    ("steps_s", "steps [s]"), ("memory_MiB", "memory [MiB]"), ("outline_mean_mm", "outline, mean [mm]"),
    ("outline_largest_mm", "largest [mm]"), ("wrinkle_position_mm", "wrinkles apart [mm]"),
    ("wrinkle_amplitude_mm", "amplitude [mm]"), ("wrinkles_missing", "missing"), ("wrinkles_extra", "extra"),
    ("shear_rms_deg", "shear [deg]"),
)  # fmt: skip


def result_rows(
    results: Sequence[Result], front: Sequence[Result], chosen: Mapping[str, Result]
) -> list[dict[str, Any]]:
    """A flat row a rung, in the order of the study."""
    rows = []
    for number, result in enumerate(results):
        row: dict[str, Any] = {"number": number, "rung": result.rung.name, "state": result.state}
        row |= {f"axis_{name}": value for name, value in result.rung.setting.items()}
        row |= {} if result.cost is None else asdict(result.cost)
        row |= {} if result.errors is None else asdict(result.errors)
        row |= {"front": result in front, "use": " ".join(use for use, r in chosen.items() if r is result)}
        row |= {"audit": "; ".join(result.warnings), "reason": result.reason.replace("\n", " ")}
        rows.append(row | {"settings": " ".join(assignments(result.rung.changes))})
    return rows


def write_csv(out: RunFolder, rows: list[dict[str, Any]]) -> None:
    """Write study.csv."""
    header = list(dict.fromkeys(key for row in rows for key in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, header, lineterminator="\n", restval="")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})
    out.write_text("study.csv", text.getvalue())


def study_json(
    plan: Plan, results: Sequence[Result], front: Sequence[Result], chosen: Mapping[str, Result]
) -> dict[str, Any]:
    """All that was measured."""
    return provenance() | {
        "title": plan.title,
        "case": str(plan.case),
        "common": list(plan.common),
        "rungs": result_rows(results, front, chosen),
        "front": [result.rung.name for result in front],
        "recommended": {use: result.rung.name for use, result in chosen.items()},
    }


def markdown(plan: Plan, results: Sequence[Result], front: Sequence[Result], chosen: Mapping[str, Result]) -> str:
    """All rungs by their time, those of the front in bold, and the commands of the recommended ones."""
    lines = [f"# {plan.title[:1].upper()}{plan.title[1:]}", ""]
    for use, how, _ in USES:
        if use in chosen:
            result = chosen[use]
            seconds, error = result.pair
            title = f"{use} {how}".strip()
            lines += [f"**{title}**: {result.rung.name}, {seconds:.3g} s, outline {error:.2g} mm off:", ""]
            lines += [f"    {command(plan, result.rung)}", ""]
    header = ["no.", "rung", *(title for _, title in COLUMNS), "audit"]
    lines += [_line(header), _line(["---"] * len(header))]
    order = sorted(range(len(results)), key=lambda k: results[k].pair)
    for number in order:
        lines.append(_line(_cells(number, results[number], results[number] in front)))
    threads = sorted({result.cost.threads for result in results if result.cost is not None})
    note = f"Wall time of the steps on {' or '.join(map(str, threads))} thread(s), meshing, compiling and output "
    note += "left out; peak memory of the process. In bold: no other rung is both faster and closer."
    lines += ["", note]
    return "\n".join(lines) + "\n"


def command(plan: Plan, rung: Rung) -> str:
    """The command that runs a rung."""
    settings = [part for item in assignments(rung.changes) for part in ("--set", item)]
    return shlex.join(["ddf", "run", str(plan.case), *settings])


def _cells(number: int, result: Result, bold: bool) -> list[str]:
    name = f"**{result.rung.name}**" if bold else result.rung.name
    if result.cost is None or result.errors is None:
        return [str(number), name, *[""] * len(COLUMNS), f"{result.state}: {result.reason.splitlines()[0][:100]}"]
    values = asdict(result.cost) | asdict(result.errors)
    return [str(number), name, *(_number(values[key]) for key, _ in COLUMNS), "; ".join(result.warnings)]


def _number(value: float) -> str:
    if isinstance(value, int):
        return str(value)
    return "-" if math.isnan(value) else f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"
