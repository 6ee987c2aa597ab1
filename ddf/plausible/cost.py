"""Whether a case can be run on this machine: memory before anything is meshed, steps and time when it is."""

from __future__ import annotations

import math
import os
from contextlib import suppress
from pathlib import Path

import numpy as np

from ddf.case import Case
from ddf.describe import memory_bytes, seconds_estimate
from ddf.plausible.findings import Findings
from ddf.scene import Scene

BYTES_A_NODE = 1000  # of model, state, contact pairs and mesher
BYTES_A_TOOL_CELL = 48  # of the distance field, while it is made
FIELD_MARGIN_MM = 20.0
BYTES_A_FRAME_NODE = 120  # of a compressed .vtu
MANY_STEPS, TOO_MANY_STEPS = 5.0e6, 1.0e9
FEWEST_STEPS = 20  # in a stage
DAY_S = 86_400.0


def machine_memory() -> float:
    """Memory that this process may use [byte]: the machine's, or its container's limit."""
    memory = math.inf
    with suppress(ValueError, OSError, AttributeError):
        memory = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        with suppress(OSError, ValueError):
            memory = min(memory, float(Path(file).read_text()))
    return memory


def node_counts(case: Case) -> dict[str, float]:
    """Nodes of each ply and of a diaphragm, about, from the sizes alone."""
    counts = {}
    corners = []
    for ply in case.plies:
        outline = np.asarray(ply.outline_mm())
        corners.append(outline)
        turn = math.radians(ply.orientation_deg)
        axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        counts[ply.name] = float(np.prod(np.ptp(outline @ axes, axis=0) / ply.element_mm + 1.0))
    d = case.diaphragms
    fine = np.minimum(
        np.ptp(np.concatenate(corners), axis=0) + 2 * d.margin_mm, [case.frame.length_mm, case.frame.width_mm]
    )
    coarse = np.array([case.frame.length_mm, case.frame.width_mm]) - fine
    graded = 2.0 * math.log(d.element_max_mm / d.element_mm) / math.log(d.growth)
    lines = fine / d.element_mm + np.minimum(graded + coarse / d.element_max_mm, coarse / d.element_mm) + 1.0
    counts["a diaphragm"] = float(np.prod(lines))
    return counts


def memory_estimate(case: Case) -> float:
    """Memory of a run [byte], about, before anything is made."""
    counts = node_counts(case)
    nodes = sum(counts.values()) + counts["a diaphragm"]
    field, tool = 0.0, case.tool
    radius = tool.footprint_radius_mm() if tool is not None else None
    if tool is not None and radius is not None:
        height = tool.height_mm or tool.radius_mm or radius
        field = (2 * radius + FIELD_MARGIN_MM) ** 2 * (height + FIELD_MARGIN_MM)
    return BYTES_A_NODE * nodes + BYTES_A_TOOL_CELL * field


def examine_memory(case: Case, found: Findings) -> None:
    """Hold the memory that a case will need against the machine's."""
    need, there = memory_estimate(case), machine_memory()
    counts = node_counts(case)
    most = max(counts, key=lambda name: counts[name])
    places = {ply.name: ("plies", place, "element_mm") for place, ply in enumerate(case.plies)}
    nodes = sum(counts.values()) + counts["a diaphragm"]
    problem = (
        f"about {need / 2**30:.3g} GiB of memory for {nodes:.3g} nodes (most in {most}); "
        f"the machine has {there / 2**30:.3g} GiB"
    )
    found.limit(need, 0.5 * there, there, places.get(most, ("diaphragms", "element_mm")), problem, "larger elements")


def examine_steps(scene: Scene, found: Findings) -> None:
    """Look at step and number of steps, of the whole and of each stage."""
    case, dt, steps = scene.case, scene.model.dt, scene.steps
    key = ("process", "stages" if case.process.breakpoints is None else "breakpoints")
    days = seconds_estimate(scene) / DAY_S
    problem = (
        f"{scene.path.duration:g} s of process in steps of {dt:.3g} s are {steps:.3g} steps, about {days:.2g} days"
    )
    allowed = "shorter stages (inertia permitting), larger elements, or more solver.mass_scaling"
    found.limit(max(steps, MANY_STEPS * days), MANY_STEPS, TOO_MANY_STEPS, key, problem, allowed)
    given = case.solver.step_s
    if given is not None:
        stable, limit = scene.step_limit, scene.step_limit / case.solver.step_safety
        problem = f"{given:g} is over the stable step"
        allowed = f"<= {stable:.3g} with safety ({limit:.3g} without), or left out"
        found.limit(given, stable * (1 + 1e-9), limit, ("solver", "step_s"), problem, allowed)
    spans = np.diff(scene.path.time)
    short = int(np.argmin(spans))
    if spans[short] < FEWEST_STEPS * dt:
        place = (*key, short, "duration_s") if case.process.breakpoints is None else (*key, "time_s", short + 1)
        problem = f"{spans[short]:g} s are {spans[short] / dt:.2g} steps of {dt:.3g} s: a blow, not a stage"
        found.limit(dt / spans[short], 1.0 / FEWEST_STEPS, 1.0, place, problem, f">= {FEWEST_STEPS * dt:.2g}")
    if case.solver.check_interval_steps > max(0.1 * steps, 50):
        problem = f"{case.solver.check_interval_steps} of {steps} steps: guards, frames and Ctrl-C wait that long"
        found.warn(("solver", "check_interval_steps"), problem, f"<= {max(1, steps // 10)}")
    need, there = memory_bytes(scene), machine_memory()
    if need > there:
        problem = f"about {need / 2**30:.3g} GiB of memory; there are {there / 2**30:.3g} GiB"
        found.fault(("diaphragms", "element_mm"), problem, "larger elements")


def frames_bytes(scene: Scene) -> float:
    """Size of all frames of a run on disk [byte], about."""
    if not scene.case.output.vtu:
        return 0.0
    whole = scene.model if scene.half is None else scene.half.whole  # frames are of all of it
    nodes = sum(int(s["rows"] * s["cols"]) for s in whole.sheets)
    return float(BYTES_A_FRAME_NODE * nodes * scene.case.output.frames_per_stage * len(scene.path.names))


def examine_disk(scene: Scene, free: float, found: Findings) -> None:
    """Hold the size of the frames against the free space [byte] of the run's disk."""
    need = frames_bytes(scene)
    key = ("output", "frames_per_stage")
    count = scene.case.output.frames_per_stage * len(scene.path.names)
    problem = f"{count} frames take about {need / 2**30:.3g} GiB; {free / 2**30:.3g} GiB are free"
    found.limit(need, 0.5 * free, free, key, problem, "fewer frames, or another disk")
