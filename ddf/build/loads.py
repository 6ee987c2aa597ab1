"""A case's stages or breakpoints as a load path."""

from __future__ import annotations

import numpy as np

from ddf.case import Case
from ddf.loads.path import LoadPath


def load_path(case: Case) -> LoadPath:
    """The case's stages or breakpoints as a load path; values left out are held."""
    process = case.process
    start = (process.atmosphere_kPa, process.atmosphere_kPa, 0.0)
    default = case.solver.mass_damping_1_s
    if process.stages is not None:
        time: list[float] = [0.0]
        rows: list[tuple[float, ...]] = [start]
        for stage in process.stages:
            time.append(time[-1] + stage.duration_s)
            wanted = (stage.cavity_pressure_kPa, stage.box_pressure_kPa, stage.tool_lift_mm)
            rows.append(tuple(old if new is None else new for old, new in zip(rows[-1], wanted, strict=True)))
        smooth = [stage.ramp == "smooth" for stage in process.stages]
        damping = [default if s.mass_damping_1_s is None else s.mass_damping_1_s for s in process.stages]
        names = tuple(stage.name for stage in process.stages)
        values = np.array(rows)
    else:
        points = process.breakpoints
        assert points is not None
        time = list(points.time_s)
        given = (points.cavity_pressure_kPa, points.box_pressure_kPa, points.tool_lift_mm)
        values = np.column_stack(
            [np.full(len(time), s) if g is None else np.array(g) for s, g in zip(start, given, strict=True)]
        )
        smooth, damping = [points.ramp == "smooth"] * (len(time) - 1), [default] * (len(time) - 1)
        names = tuple(f"segment-{k}" for k in range(1, len(time)))
    return LoadPath(
        np.array(time), values[:, 0], values[:, 1], values[:, 2], np.array(smooth), np.array(damping), names,
        process.atmosphere_kPa,
    )  # fmt: skip
