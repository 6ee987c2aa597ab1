"""Compile every kernel by a run of a tiny case: what `ddf.kernel_cache.warm_kernels` starts as a process of its own.

Two processes share the work, each with about half of the phases of a step; the run then finds them compiled and
compiles the rest.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from typing import Any

TINY: dict[str, Any] = {
    "title": "compiling",
    "frame": {"length_mm": 200, "width_mm": 200},
    "diaphragms": {"element_mm": 10.0},
    "plies": [{"size_mm": [80, 80], "element_mm": 8.0}, {"size_mm": [80, 80], "element_mm": 8.0}],
    "tool": {"shape": "hemisphere", "radius_mm": 20.0},
    "process": {
        "stages": [
            {"name": "evacuate", "duration_s": 0.001, "cavity_pressure_kPa": 0.0},
            {"name": "lift", "duration_s": 0.002, "tool_lift_mm": 1.0},
        ]
    },
    "solver": {"energy_error_limit_percent": 1000.0},
    "output": {"frames_per_stage": 1, "pictures": False},
}


CONTACT = "contact"


def main(half: str = "") -> None:
    """Compile all, or with half = CONTACT no more than contact and fibre tension."""
    from ddf.case import case_from_dict
    from ddf.run import run_case

    if half == CONTACT:
        _compile_phases(contact=True)
        return
    other = subprocess.Popen([sys.executable, "-m", "ddf.compile_kernels", CONTACT], stderr=subprocess.DEVNULL)
    _compile_phases(contact=False)
    other.wait()  # what it may have left out is compiled here
    with tempfile.TemporaryDirectory(prefix="ddf-compile-") as folder:
        run_case(case_from_dict(TINY), f"{folder}/run", threads=1, compiled=True)


def _compile_phases(contact: bool) -> None:
    """Compile phases of a step for the types with which `step.advance` calls them."""
    import numpy as np
    from numba import float64, int64, typeof

    from ddf.build import build_scene
    from ddf.case import case_from_dict
    from ddf.dynamics import contacts, mirror, phases
    from ddf.model import sheet_vectors
    from ddf.output.raster import view_from_above
    from ddf.postprocess import measure
    from ddf.simulate import Simulation

    sim = Simulation(build_scene(case_from_dict(TINY)))
    model, state, work = (typeof(handle) for handle in sim.handles)  # type: ignore[no-untyped-call]
    vector = float64[::1]
    if contact:
        phases.pull_family.compile((model, state, work, int64, int64, int64, int64))
        contacts.layers.compile((model, state, work, int64, int64, float64, float64))
        phases.leave.compile((model, state, work, vector, int64, float64, int64, int64))
        contacts.tool.compile((model, state, work, int64, vector, int64, float64, float64))
        phases.drift.compile((model, state, work, vector, int64))
        contacts.collect.compile((model, state, work, int64))
        mirror.fold_back.compile((model, state, work, float64, int64))
        mirror.follow.compile((model, state, work, int64))
        mirror.follow_tension.compile((model, state, int64))
        mirror.follow_speed.compile((model, state, int64))
        for k in sim.scene.ply_sheets:  # a wrinkle, for all that follows and measures them
            x = sheet_vectors(sim.scene.model, sim.scene.state.x, k)
            x[2] += 10.0 * np.exp(-((x[1] / 5.0) ** 2))
        measure(sim.scene)
        view_from_above(sim.scene.state.x[:12].reshape(3, 2, 2), np.ones((1, 1), bool), (0.0, 1.0, 0.0, 1.0), pixels=2)
    else:
        phases.internal.compile((model, state, work, vector, int64, vector))
        sim.seek(0.0)
    sim.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
