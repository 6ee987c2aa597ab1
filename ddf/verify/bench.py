"""Small scenes of any sheets, contacts and tool, moved by the same kernels and integrator as a run.

A `Sheet` is its start, its reference and its law; `assemble` makes of sheets, contacts and a tool a scene for
`Simulation`. Held nodes have no mass and go at the velocity that stands in the state. Units as in `ddf.model`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ddf.build import state_at_rest
from ddf.build.blocks import row_blocks
from ddf.build.pairs import first_places
from ddf.build.pools import corner_sum
from ddf.build.rim import no_rims, rim_lists
from ddf.case import HyperelasticMaterial, WovenMaterial
from ddf.contact.patch import patch_centres
from ddf.contact.summit import SUMMIT
from ddf.dynamics import timestep
from ddf.elements.bending import tangent_weights
from ddf.loads.path import LoadPath, smooth_ramp
from ddf.materials import ogden, shear_law
from ddf.model import (
    DIAPHRAGM,
    PAIR,
    PLY,
    PRESSURE_BOTTOM,
    SHEET,
    Model,
    State,
    sheet_scalars,
    sheet_vectors,
    without_mirror,
)
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.bench_sheets import BoolArray, FloatArray, Sheet, ToolContact, Touch
from ddf.verify.scenes import entered_law

SAFETY = 0.8  # step over the stable one
CHUNK = 10  # steps between two looks at held nodes that are driven


@dataclass(frozen=True)
class Bench:
    """What `Simulation` needs of a scene, without a case."""

    model: Model
    state: State
    path: LoadPath
    base_z: float

    def simulation(self, threads: int = 1) -> Simulation:
        """The scene in motion."""
        return Simulation(cast(Scene, self), threads)

    def with_step(self, dt: float) -> Bench:
        """The same scene at another step [s]."""
        return replace(self, model=self.model._replace(dt=dt))

    def x(self, k: int = 0) -> FloatArray:
        """Positions of sheet k, a view (3, n, m)."""
        return sheet_vectors(self.model, self.state.x, k)

    def v(self, k: int = 0) -> FloatArray:
        """Velocities of sheet k, a view (3, n, m)."""
        return sheet_vectors(self.model, self.state.v, k)

    def f(self, k: int = 0) -> FloatArray:
        """Forces on sheet k without fibre tension, a view (3, n, m); on held nodes what the holder resists."""
        return sheet_vectors(self.model, self.state.f, k)


def assemble(
    sheets: Sequence[Sheet], path: LoadPath, touches: Sequence[Touch] = (), tool: ToolContact | None = None,
    gravity: ArrayLike = (0.0, 0.0, 0.0),
) -> Bench:  # fmt: skip
    """Model and state of a scene. The step is the stable one of the softest bound over all sheets, times 0.8."""
    records, tables = _records(sheets)
    pairs, exposed, place = _pairs(sheets, touches)
    mass0 = sheets[0].areal_mass
    stiff = tool.stiffness if tool else 0.0
    tool_damping = timestep.contact_damping(tool.damping, stiff, mass0, math.inf) if tool else 0.0
    lines = [np.concatenate([np.diff(s.lines[0]), np.diff(s.lines[1])]) for s in sheets]
    pools, blocks = _pools(sheets, records), row_blocks(records)
    model = Model(
        sheets=records, blocks=blocks, pairs=pairs, **pools, **without_mirror(pools["inverse_mass"], len(blocks)),
        **rim_lists(no_rims(len(records)), records, blocks),
        lines=np.concatenate(lines), tool_lines=np.concatenate(lines),
        shear_tables=tables, tangents=np.zeros((1, 1)), ogden=_terms(sheets), exposed=exposed,
        tool=tool.field.values if tool else np.zeros((2, 2, 2, 4), np.float32),
        tool_origin=np.asarray(tool.field.origin, dtype=float) if tool else np.zeros(3),
        tool_spacing=float(tool.field.spacing) if tool else 1.0, tool_sheet=0 if tool else -1,
        tool_offset=0.5 * sheets[0].thickness, tool_stiffness=stiff, tool_damping=tool_damping, tool_mass=mass0,
        tool_friction=tool.friction if tool else 0.0, tool_boxed=False, tool_walls=np.zeros(4),
        summits=np.zeros((0, SUMMIT)), gravity=np.asarray(gravity, dtype=float),
        dt=_step(sheets, touches),
    )  # fmt: skip
    x = np.concatenate([s.start.ravel() for s in sheets])
    return Bench(model, state_at_rest(model, x, place), path, tool.base_z if tool else 0.0)


def _records(sheets: Sequence[Sheet]) -> tuple[np.ndarray, FloatArray]:
    """SHEET records and shear tables."""
    records = np.zeros(len(sheets), SHEET)
    tables: list[FloatArray] = []
    node = line = 0
    for r, s in zip(records, sheets, strict=True):
        r["node"], r["line"], r["thickness"] = node, line, s.thickness
        r["rows"], r["cols"] = s.held.shape
        r["a1"], r["a2"] = (float(np.diff(a)[0]) for a in s.lines)
        if isinstance(s.material, WovenMaterial):
            r["kind"], r["shear"] = PLY, len(tables)
            r["eh1"], r["eh2"] = s.material.membrane_modulus_N_mm
            r["bend1"], r["bend2"] = s.material.bending_rigidity_Nmm
            r["bend_in_plane"] = s.material.in_plane_rigidity
            tables.append(shear_law.shear_table(*entered_law(s.material)))
        else:
            r["kind"], r["face"], r["rigidity"] = DIAPHRAGM, PRESSURE_BOTTOM, s.rigidity
            r["hourglass"] = 4.0 * ogden.initial_shear_modulus(s.material.abaqus_terms) * s.thickness
        node += s.held.size
        line += sum(s.held.shape) - 2
    return records, np.array(tables) if tables else np.zeros((1, 2, 5))


def _terms(sheets: Sequence[Sheet]) -> FloatArray:
    for s in sheets:
        if isinstance(s.material, HyperelasticMaterial):
            return np.array(s.material.abaqus_terms, dtype=float)
    return np.zeros((1, 2))


def _ends_halved(count: int) -> FloatArray:
    return np.concatenate([[0.5], np.ones(count - 2), [0.5]])


def _pools(sheets: Sequence[Sheet], records: np.ndarray) -> dict[str, Any]:
    """Node pools of the model. Held nodes have no contact area of their own: they are no part of a balance."""
    parts: dict[str, list[np.ndarray]] = {}

    def add(**arrays: np.ndarray) -> None:
        for name, array in arrays.items():
            parts.setdefault(name, []).append(array)

    for s, r in zip(sheets, records, strict=True):
        n, m = s.held.shape
        area, zero = corner_sum(s.cells), np.zeros((n, m))
        bar1 = bar2 = triple1 = triple2 = zero
        if r["kind"] == PLY:
            bar1, bar2, triple1, triple2 = (zero.copy() for _ in range(4))
            bar1[:-1], bar2[:, :-1] = r["a2"] * _ends_halved(m)[None, :], r["a1"] * _ends_halved(n)[:, None]
            triple1[1:-1], triple2[:, 1:-1] = r["a1"] * bar1[1:-1], r["a2"] * bar2[:, 1:-1]
        mass = np.where(s.held, 0.0, s.areal_mass * area)
        add(
            mass=mass.ravel(), inverse_mass=np.where(s.held, 0.0, 1.0 / (s.areal_mass * area)).ravel(),
            area=np.where(s.held, 0.0, area).ravel(), inverse_area=1.0 / area.ravel(),
            bar1=bar1.ravel(), bar2=bar2.ravel(), cell=np.pad(s.cells, ((0, 1), (0, 1))).ravel(),
            triple1=triple1.ravel(), triple2=triple2.ravel(),
            weight=tangent_weights(bar1, bar2).ravel(),
            centre=patch_centres(np.ones((n, m), bool)).ravel(), cover=np.ones(n * m),
        )  # fmt: skip
    return {name: np.ascontiguousarray(np.concatenate(part)) for name, part in parts.items()}


def _places(points: FloatArray, surface: FloatArray) -> FloatArray:
    """Grid coordinates (2, ...) of points (3, ...) on a sheet (3, n, m): from the nearest node along its tangents."""
    n, m = surface.shape[1:]
    flat = points.reshape(3, -1)
    i, j = np.unravel_index(cKDTree(surface.reshape(3, -1).T).query(flat.T)[1], (n, m))
    a, b = (np.gradient(surface, axis=axis)[:, i, j] for axis in (1, 2))
    r = flat - surface[:, i, j]
    aa, bb, ab, ra, rb = ((p * q).sum(axis=0) for p, q in ((a, a), (b, b), (a, b), (r, a), (r, b)))
    inverse = 1.0 / (aa * bb - ab * ab)
    place = np.array([i + (bb * ra - ab * rb) * inverse, j + (aa * rb - ab * ra) * inverse])
    return place.reshape(2, *points.shape[1:])


def _pairs(sheets: Sequence[Sheet], touches: Sequence[Touch]) -> tuple[np.ndarray, BoolArray, FloatArray]:
    """PAIR records, followed nodes and first places; all slave nodes that are not held are followed."""
    records: list[tuple[float, ...]] = []
    exposed: list[np.ndarray] = [np.zeros(0, bool)]
    places: list[np.ndarray] = [np.zeros(0)]
    first = buffer = span = 0
    for t in touches:
        slave, master = sheets[t.slave], sheets[t.master]
        a, b = slave.areal_mass, master.areal_mass
        if master.held.all():
            b = math.inf
        reduced = a if math.isinf(b) else a * b / (a + b)
        offset = 0.5 * (slave.thickness + master.thickness) if t.offset is None else t.offset
        damping = timestep.contact_damping(t.damping, t.stiffness, a, b)
        records.append(
            (t.slave, t.master, first, buffer, span, t.sign, offset, t.friction, t.stiffness, damping, reduced)
        )
        place = _places(slave.start, master.start)
        exposed.append(~slave.held.ravel() & (t.slave != t.master))
        places.append(first_places(place))
        rows = slave.held.shape[0]
        blocks = math.ceil(rows / max(4, math.ceil(rows / 12)))
        first += slave.held.size
        buffer += 4 * master.held.size * blocks
        span += master.held.shape[0] * blocks
    table = np.array(records, dtype=PAIR) if records else np.zeros(0, PAIR)
    return table, np.concatenate(exposed), np.concatenate(places)


def _step(sheets: Sequence[Sheet], touches: Sequence[Touch]) -> float:
    """Stable step [s], the least of all sheets that move, times SAFETY."""
    limits = []
    for k, s in enumerate(sheets):
        mine = [t for t in touches if k in (t.slave, t.master)]
        stiff = sum(t.stiffness for t in mine)
        if isinstance(s.material, WovenMaterial):
            a = tuple(float(np.diff(line)[0]) for line in s.lines)
            shear = shear_law.largest_tangent(*entered_law(s.material))
            omega2 = timestep.ply_omega2(shear, s.material.bending_rigidity_Nmm, (a[0], a[1]), stiff, s.areal_mass)
        else:
            mu = ogden.initial_shear_modulus(s.material.abaqus_terms)
            omega2 = timestep.diaphragm_omega2(mu, s.thickness, s.rigidity, s.areal_mass, s.element, stiff)
        rates = [timestep.contact_damping(t.damping, t.stiffness, s.areal_mass, s.areal_mass) for t in mine]
        rate = 2.0 * sum(rates) / s.areal_mass
        omega = math.sqrt(omega2)
        limits.append(timestep.damped_limit(omega, rate / (2.0 * omega)))
    return SAFETY * min(limits)


def drive(bench: Bench, sim: Simulation, k: int, target: FloatArray, seconds: float) -> None:
    """Move the held nodes of sheet k smoothly to their places in `target` (3, n, m), in `seconds` of process time."""
    held = sheet_scalars(bench.model, bench.model.inverse_mass, k) == 0.0
    x, v = bench.x(k), bench.v(k)
    start, dt = x.copy(), bench.model.dt
    chunks = max(1, round(seconds / (CHUNK * dt)))
    for c in range(1, chunks + 1):
        share = smooth_ramp(np.array([c / chunks]))[0][0]
        aim = start + share * (target - start)
        v[:, held] = ((aim - x) / (CHUNK * dt))[:, held]
        sim.advance(CHUNK)
    v[:, held] = 0.0


def come_to_rest(bench: Bench, sim: Simulation, speed: float, limit_s: float) -> bool:
    """Go on until nothing is faster than `speed` [mm/s] for 20 looks, at most `limit_s`; whether it came to that."""
    quiet, end = 0, sim.time + limit_s
    while quiet < 20 and sim.time < end:
        sim.advance(CHUNK)
        fastest = max(sim.fastest(k) for k in range(bench.model.sheets.size))
        quiet = quiet + 1 if fastest < speed else 0
    return quiet >= 20
