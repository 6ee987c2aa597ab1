"""The end of a run: what the folder says about how it went."""

from __future__ import annotations

from logging import Logger
from typing import Any

import numpy as np

from ddf.describe import seconds_estimate, speedup
from ddf.monitors.audit import Check, time_check
from ddf.past_runs import learn
from ddf.postprocess import finish_folder, report_of
from ddf.provenance import peak_memory_mib, provenance
from ddf.run.loop import Runner
from ddf.run.progress import RunResult
from ddf.scene import Scene


def finish(runner: Runner, reason: str) -> RunResult:
    """Write what a run that stopped at its end or at a signal leaves, and return how it ended."""
    scene, out, watch = runner.scene, runner.out, runner.watch
    result = RunResult(out.path, reason, runner.sim.step, runner.sim.time, watch.seconds)
    result.notes += [
        f"the step was cut to {cut['step_s']:.3g} s at {cut['time_s']:.6g} s: {cut['reason']}" for cut in runner.cuts
    ]
    if reason == "finished":
        with watch("post-processing"):
            result.checks, result.plies = finish_folder(scene, out, runner.energy, runner.sim.time, result.notes)
        share = runner.sim.step / scene.steps
        learn(share * seconds_estimate(scene) / speedup(runner.threads), watch.seconds["steps"])
        if runner.choice is not None and runner.choice.seconds is not None:
            result.checks.append(time_check(watch.seconds["steps"], runner.choice.seconds))
    write_info(runner, reason, "", result.checks)
    if reason == "finished":
        report_of(scene, out, result.notes)
    _sum_up(runner.log, result)
    return result


def write_info(runner: Runner, reason: str, message: str, checks: list[Check] | None = None) -> None:
    """run.json: where it came from, how long it took, how it ended."""
    scene, sim = runner.scene, runner.sim
    info = provenance() | {
        "case": scene.case.title,
        "threads": runner.threads,
        "stop_reason": reason,
        "message": message,
        "step": sim.step,
        "steps": runner.steps,
        "process_time_s": sim.time,
        "step_s": scene.model.dt,
        "step_limit_s": scene.step_limit,
        "step_cuts": runner.cuts,
        "wall_s": {key: round(value, 3) for key, value in runner.watch.seconds.items()},
        "peak_memory_MiB": peak_memory_mib(),
        "mesh": mesh_summary(scene),
        "audit": checks or [],
    }
    if scene.half is not None:
        info["half_model"] = scene.half.where
    if runner.choice is not None:
        info["fidelity"] = runner.choice.record()
    runner.out.write_json("run.json", info)


def _sum_up(log: Logger, result: RunResult) -> None:
    """The log's last lines: checks that failed, what is missing, how the run ended."""
    for check in result.checks:
        if not check["ok"]:
            log.warning("%s: %.3g %s (limit %g)", *(check[key] for key in ("name", "value", "unit", "limit")))
    for note in result.notes:
        log.warning("%s", note)
    wall = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in result.wall_s.items())
    log.info("%s at %.6g s, step %d; wall time: %s", result.stop_reason, result.time_s, result.step, wall)


def mesh_summary(scene: Scene) -> dict[str, Any]:
    """Sheets and their grids, with added mass, for people and run.json."""
    sheets = {}
    for info, sheet in zip(scene.sheets, scene.model.sheets, strict=True):
        sheets[info.name] = {
            "rows": int(sheet["rows"]),
            "cols": int(sheet["cols"]),
            "mass_g": info.true_mass * 1e6,
            "added_mass_g": info.added_mass * 1e6,
        }
    return {"sheets": sheets, "contact_nodes": int(np.count_nonzero(scene.model.exposed))}
