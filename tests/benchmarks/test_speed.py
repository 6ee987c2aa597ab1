"""Times of the kernels and of whole steps. Run with `pytest tests/benchmarks --benchmark-only`."""

from __future__ import annotations

import time

import numpy as np
import pytest
from numba import njit

from ddf.contact.layers import NOWHERE, UNKNOWN, chunk_scratch, layer_forces
from ddf.contact.patch import patch_centres
from ddf.elements import bending, rubber, shear
from ddf.elements.bending import bending_forces
from ddf.elements.plate import plate_forces
from ddf.elements.rubber import rubber_forces
from ddf.elements.shear import shear_forces
from ddf.elements.tension import LINES, line_scratch, pull_lines, pull_rows
from ddf.materials.shear_law import shear_samples, shear_table
from ddf.model import PAIR, SHEET
from ddf.simulate import BATCH, Simulation

SIZES = (88, 176, 351, 1000)
OGDEN = np.array([[0.150904, 3.0918], [0.813392, 0.81451]])


class Ply:
    """A slightly wavy square ply of n x n nodes of 1 mm, with all that its kernels need."""

    def __init__(self, n):
        u, v = np.meshgrid(np.arange(n) * 1.0, np.arange(n) * 1.0, indexing="ij")
        self.n, self.x = n, np.array([u, v, 0.02 * np.sin(0.2 * u) * np.cos(0.3 * v)])
        self.v, self.f = np.zeros_like(self.x), np.zeros_like(self.x)
        one = np.ones((n, n))
        self.cell, self.bar1, self.bar2 = one.copy(), one.copy(), one.copy()
        self.cell[-1], self.cell[:, -1], self.bar1[-1], self.bar2[:, -1] = 0.0, 0.0, 0.0, 0.0
        self.triple1, self.triple2 = one.copy(), one.copy()
        self.triple1[[0, -1]], self.triple2[:, [0, -1]] = 0.0, 0.0
        sheet = np.zeros(1, SHEET)
        sheet["a1"] = sheet["a2"] = 1.0
        sheet["bend1"] = sheet["bend2"] = sheet["bend_in_plane"] = 0.34  # as woven materials have it by default
        self.sheet = sheet[0]
        self.inverse = np.full((n, n), 1.0 / 1.6e-9)
        self.table = shear_table(*shear_samples("monotone", 0.5, 0.002, [0.4576, -7.394, 36.36, -59.31, 32.37], None))
        self.work = np.zeros(max(bending.SCRATCH, shear.SCRATCH))
        self.weight = bending.tangent_weights(self.bar1, self.bar2)
        self.lines = np.zeros(line_scratch(n))
        self.kept = np.zeros((n, n))
        self.law = (1.0, 1e-10 * 20_000.0, 0.5e-5 * 20_000.0, 1e-10, 1e-5)

    def shear(self):
        shear_forces(self.x, self.f, self.cell, self.table, 0, self.n, self.work)

    def bending(self):
        bending_forces(self.x, self.f, self.weight, self.triple1, self.triple2, self.sheet, 0, self.n, self.work)

    def tension(self):
        _pull_all(self.x, self.v, self.inverse, self.bar1, self.bar2, self.kept, self.law, self.lines)

    def all(self):
        self.shear()
        self.bending()
        self.tension()


@njit
def _pull_all(x, v, inverse, bar1, bar2, kept, law, lines):
    """Both families twice, as in a step."""
    for sweep in range(2):
        for a in range(0, x.shape[2], LINES):
            b = min(a + LINES, x.shape[2])
            pull_lines(x, v, inverse, bar1, kept, law, sweep == 1, -1, a, b, 0, x.shape[1], lines)
        for a in range(0, x.shape[1], LINES):
            b = min(a + LINES, x.shape[1])
            pull_rows(x, v, inverse, bar2, kept, law, sweep == 1, -1, a, b, 0, x.shape[2], lines)


def _note(benchmark, count, unit="node"):
    if benchmark.stats is None:  # not timed, only run
        return
    benchmark.extra_info[f"ns_per_{unit}"] = round(benchmark.stats.stats.median / count * 1e9, 2)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kernel", ["shear", "bending", "tension", "all"])
def test_ply_kernel(benchmark, kernel, size):
    function = getattr(Ply(size), kernel)
    function()
    benchmark.pedantic(function, rounds=15, iterations=max(1, 200_000 // size**2))
    _note(benchmark, size * size)


@pytest.mark.parametrize("size", [100, 300])
@pytest.mark.parametrize("kernel", ["rubber", "rubber+plate"])
def test_diaphragm_kernel(benchmark, kernel, size):
    u, v = np.meshgrid(np.arange(size) * 2.5, np.arange(size) * 2.5, indexing="ij")
    x = 1.02 * np.array([u, v, 0.05 * np.sin(0.1 * u)])
    f, d, work = np.zeros_like(x), np.full(size - 1, 2.5), np.zeros((72, size + 2))
    flat = np.zeros(rubber.SCRATCH)
    sheet = np.zeros(1, SHEET)
    sheet["thickness"], sheet["rigidity"], sheet["hourglass"] = 1.5, 1.085, 5.8

    def run():
        rubber_forces(x, f, d, d, sheet[0], OGDEN, 0.1, 0, size, flat)
        if kernel != "rubber":
            plate_forces(x, f, d, d, 1.085, 0, size, work)

    run()
    benchmark.pedantic(run, rounds=15, iterations=max(1, 100_000 // size**2))
    _note(benchmark, size * size)


@pytest.mark.parametrize("state", ["in-contact", "open", "resting"])
def test_contact_of_a_pair(benchmark, state):
    n, m = 176, 150
    u, v = np.meshgrid(np.arange(n) * 2.0, np.arange(n) * 2.0, indexing="ij")
    height = 0.96 if state == "in-contact" else 1.1
    xs = np.array([u + 8.0, v + 8.0, height + 0.001 * np.sin(u)])
    u, v = np.meshgrid(np.arange(m) * 2.5, np.arange(m) * 2.5, indexing="ij")
    xm = np.array([u, v, 0.001 * np.cos(0.3 * v)])
    pair = np.zeros(1, PAIR)
    for key, value in {"sign": 1, "offset": 1, "friction": 0.5, "stiffness": 2, "damping": 2e-5, "mass": 8e-10}.items():
        pair[key] = value
    fs, area = np.zeros_like(xs), np.full((n, n), 4.0)
    centre = patch_centres(np.ones((m, m), bool))
    place = np.concatenate([xs[:2] / 2.5, np.full((1, n, n), UNKNOWN), np.zeros((2, n, n))])
    still, slip, buffer, out = np.zeros_like(xs), np.zeros((2, n, n)), np.zeros((m, m, 4)), np.zeros(4)
    span, scratch = np.tile(np.array([NOWHERE, 0]), (m, 1)), tuple(part[0] for part in chunk_scratch(1))
    rates = np.zeros((m, m, 4))
    packed = np.ascontiguousarray(np.moveaxis(np.concatenate([xm, np.ones((1, m, m))]), 0, -1))
    reach = 1e6 if state != "resting" else 1e-6
    rest = np.zeros((n, n), np.int8)

    def run():
        layer_forces(
            xs, still, fs, area.copy(), area, packed, rates, centre, place, slip, rest, buffer, span, pair[0],
            reach, 1e-5, 0, n, scratch, out,
        )  # fmt: skip

    run()
    assert fs.any() == (state == "in-contact")
    benchmark.pedantic(run, rounds=20, iterations=5)
    _note(benchmark, n * n)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("scene", ["coarse", "2mm"])
def test_step_of_a_clamped_flat_stack(benchmark, make_scene, scene, threads):
    sizes = ("plies.0.element_mm=4", "diaphragms.element_mm=5") if scene == "coarse" else ()
    made = make_scene("flat-stack", *sizes, "process.stages.0.duration_s=0.004", "process.stages.1.duration_s=0.5")
    sim = Simulation(made, threads)
    while sim.time < 0.0045:
        sim.advance(50)
    nodes = made.model.mass.size
    tracked = int(made.model.exposed.sum())
    assert made.state.springs.sum() > 0.0
    benchmark.pedantic(sim.advance, args=(20,), rounds=10)
    sim.close()
    _note(benchmark, 20 * nodes)
    if benchmark.stats is not None:
        benchmark.extra_info["ms_per_step"] = round(benchmark.stats.stats.median / 20 * 1e3, 3)
    benchmark.extra_info["nodes"], benchmark.extra_info["tracked"] = nodes, tracked
    memory = sum(a.nbytes for part in (made.model, made.state, sim.work) for a in part if isinstance(a, np.ndarray))
    benchmark.extra_info["bytes_per_node"] = round(memory / nodes, 1)


@pytest.mark.parametrize("scene", ["coarse", "2mm"])
def test_self_contact_of_a_flat_stack(benchmark, make_scene, scene):
    """What a flat stack pays for self-contact: the search before each batch of steps, in which nothing else is done."""
    sizes = ("plies.0.element_mm=4", "diaphragms.element_mm=5") if scene == "coarse" else ()
    made = make_scene("flat-stack", *sizes, "process.stages.0.duration_s=0.004", "process.stages.1.duration_s=0.5")
    sim, fastest = Simulation(made), np.inf
    while sim.time < 0.0045:
        sim.advance(50)
    for _ in range(20):
        start = time.thread_time()
        sim.advance(BATCH)
        fastest = min(fastest, time.thread_time() - start)
    own = made.model.pairs["slave"] == made.model.pairs["master"]
    assert sim.work.idle[own].all()
    assert not sim.work.idle[~own].any()
    benchmark.pedantic(sim.seek, args=(0.1,), rounds=40)
    sim.close()
    if benchmark.stats is not None:
        benchmark.extra_info["percent_of_steps"] = round(100.0 * benchmark.stats.stats.min / fastest, 2)
        assert benchmark.stats.stats.min < 0.03 * fastest
