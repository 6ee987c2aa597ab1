"""Cost of a ply a node and step by its formulation, in the solver's own step, alone: no contact, no diaphragms.

`pytest tests/benchmarks/test_formulations.py --benchmark-only`. Thompson et al. 2020 measured 1.48 for shells and
membranes over membranes alone.
"""

from __future__ import annotations

import numpy as np
import pytest

from ddf.simulate import Simulation
from ddf.verify.problem import LATTICE, SHELL_MEMBRANE, Options
from ddf.verify.scenes import fabric_of, march, ply_scene, velocities

FORMULATIONS = {
    "lattice": (LATTICE, True),
    "membrane": (SHELL_MEMBRANE, False),
    "shell+membrane": (SHELL_MEMBRANE, True),
}
STEPS = 20


@pytest.mark.parametrize("size", [88, 176, 351])
@pytest.mark.parametrize("name", FORMULATIONS)
def test_step_of_a_ply(benchmark, name, size):
    formulation, bending = FORMULATIONS[name]
    fabric = fabric_of(Options())
    if not bending:
        fabric = fabric.model_copy(update={"bending_rigidity_Nmm": (0.0, 0.0)})
    side = 2.0 * (size - 1)
    scene = ply_scene(fabric, (side, side), 2.0, formulation=formulation)
    v = velocities(scene)
    v[2] = 10.0 * np.sin(np.linspace(0.0, 6.0, size))[:, None]
    sim = Simulation(scene)
    march(sim, STEPS)
    benchmark.pedantic(march, args=(sim, STEPS), rounds=15)
    assert np.isfinite(scene.state.x).all()
    if benchmark.stats is None:  # not timed, only run
        return
    benchmark.extra_info["ns_per_node_and_step"] = round(benchmark.stats.stats.median / STEPS / size**2 * 1e9, 2)
    benchmark.extra_info["least_ns"] = round(benchmark.stats.stats.min / STEPS / size**2 * 1e9, 2)
    benchmark.extra_info["step_s"] = scene.model.dt
