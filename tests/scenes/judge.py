"""Runs a scene and says how it ended: at rest, not at rest, or stopped, with the figures that this rests on."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from crossings import crossings_of_frame

from ddf.case import case_from_dict
from ddf.errors import DdfError, UnstableError
from ddf.output.results import open_run
from ddf.run import run_case

REST_PERCENT = 0.1  # kinetic over internal energy of a settled end; the audit's limit is 2
BALANCE_PERCENT = 1.0  # of the works of pressures and tool, each without its sign: a lift under vacuum gives back most
CHECKS = {
    "kinetic over internal energy": "kinetic_percent",
    "energy balance error": "balance_percent",
    "deepest penetration of the tool": "penetration_mm",
    "largest fibre strain": "strain_percent",
    "deepest place of a ply in the tool": "ply_in_tool_mm",
}


def judged_run(table: dict[str, Any], folder: Path, *, frames: bool = True) -> dict[str, Any]:
    """Run a case and return what there is to say about it; `end` is settled, moving, unbalanced, stopped or refused.

    With `frames` the crossings of sheets in every frame too.
    """
    row: dict[str, Any] = {"title": table.get("title", "")}
    began = time.perf_counter()
    try:
        result = run_case(case_from_dict(table), folder, threads=1, force=True)
    except UnstableError as error:
        row |= {"end": "stopped", "reason": str(error)}
    except DdfError as error:
        return row | {"end": "refused", "reason": str(error)}
    else:
        if result.stop_reason == "interrupted":
            raise KeyboardInterrupt
        row |= {CHECKS[check["name"]]: check["value"] for check in result.checks if check["name"] in CHECKS}
    run = open_run(folder)
    if "end" not in row:
        row["gross_percent"] = gross_balance(run.history())
        moving, unbalanced = row["kinetic_percent"] > REST_PERCENT, row["gross_percent"] > BALANCE_PERCENT
        row["end"] = "moving" if moving else "unbalanced" if unbalanced else "settled"
    row |= {"steps": run.info["step"], "wall_s": round(time.perf_counter() - began, 1)}
    if not frames:
        return row
    sheets = list(run.info["mesh"]["sheets"])
    return row | {"crossings": crossings_by_time(run, sheets), "last_frame": round(run.frames(sheets[0])[-1][0], 4)}


def gross_balance(history) -> float:
    """Energy error at the end over the works of the pressures and of the tool, each without its sign [%]."""
    last = {name: float(values[-1]) for name, values in history.items() if name != "stage"}
    works = [last[f"work_{kind}_mJ"] for kind in ("pressure", "tool", "thinning")]
    error = last["energy_error_percent"] * max(abs(sum(works)), last["strain_mJ"] + last["kinetic_mJ"])
    return abs(error) / sum(abs(work) for work in works)


def crossings_by_time(run, sheets):
    """[time_s, {"a x b": number of crossings}] of every frame in which any sheets cross."""
    found = []
    for index, (moment, _) in enumerate(run.frames(sheets[0])):
        pairs = {f"{a} x {b}": len(places) for (a, b), places in crossings_of_frame(run, sheets, index).items()}
        if any(pairs.values()):
            found.append([round(moment, 4), {pair: count for pair, count in pairs.items() if count}])
    return found
