"""Scenes of verification problems: one ply by itself, some nodes held, gravity, damping; and what moves them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.build import build_scene, state_at_rest
from ddf.build.rim import no_rims, rim_lists
from ddf.build.step import stiffest
from ddf.case.load import case_from_dict
from ddf.case.presets import PRESETS
from ddf.case.schema import WovenMaterial
from ddf.dynamics import timestep
from ddf.elements.shell_membrane.rotations import normals
from ddf.errors import DdfError, UnstableError
from ddf.loads.path import LoadPath
from ddf.materials import shear_law
from ddf.model import Model, State, sheet_shells, sheet_vectors, without_mirror
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.problem import LATTICE, SHELL_MEMBRANE, FloatArray, Options

Table = dict[str, Any]

GRAVITY = 9810.0  # mm/s2
TONNE_PER_GSM_MM2 = 1e-12
AROUND_MM = 50.0  # how much longer than the ply the frame is: a case wants 20 mm a side


def fabric_of(options: Options, bending: bool = False) -> WovenMaterial:
    """The fabric asked for; left out, the plain weave that ships with ddf.

    bending: the problem is about bending. Raises DdfError where the fabric then has none.
    """
    fabric = options.fabric or PRESETS["plain-weave-6k-320"]
    assert isinstance(fabric, WovenMaterial)
    if bending and min(fabric.bending_rigidity_Nmm) == 0.0:
        raise DdfError("the fabric has no bending rigidity", "this problem needs bending_rigidity_Nmm above 0")
    return fabric


def areal_mass(fabric: WovenMaterial) -> float:
    """Mass per area [tonne/mm2]."""
    return fabric.areal_density_gsm * TONNE_PER_GSM_MM2


def entered_law(fabric: WovenMaterial) -> tuple[FloatArray, FloatArray]:
    """Shear angles [rad] and N_s [N/mm] of the fabric's law, as `build` hands it to the kernels' table."""
    table = fabric.shear_table
    return shear_law.shear_samples(
        fabric.shear_law, fabric.thickness_mm, fabric.shear_modulus_floor_MPa, fabric.shear_modulus_polynomial_MPa,
        None if table is None else (table.angle_deg, table.normalised_shear_force_N_mm),
    )  # fmt: skip


def case_scene(
    fabric: WovenMaterial, size_mm: Sequence[float], element_mm: float, ply: Table | None = None, **tables: Table
) -> Scene:
    """Scene of a case with one rectangular ply, without added mass; `ply` and `tables` add keys to the case's own.

    The ply's grid ends at its edges.
    """
    own: Table = {"material": "fabric", "size_mm": list(size_mm), "element_mm": element_mm}
    frame = [max(50.0, side + AROUND_MM) for side in size_mm]
    raw: dict[str, Table] = {
        "materials": {"fabric": fabric.model_dump(exclude={"base"})},
        "frame": {"length_mm": frame[0], "width_mm": frame[1]},
        "diaphragms": {"element_mm": min(20.0, 0.5 * min(size_mm))},
        "process": {"stages": [{"name": "all", "duration_s": 1.0}]},
        "solver": {"mass_scaling": 1.0},
    }
    for name, table in tables.items():
        raw[name] = raw.get(name, {}) | table
    return build_scene(case_from_dict(raw | {"plies": [own | (ply or {})]}), rings=0)


def ply_scene(
    fabric: WovenMaterial, size_mm: Sequence[float], element_mm: float, orientation_deg: float = 0.0,
    formulation: str = LATTICE, fibre_deg: float = 0.0, **solver: float,
) -> Scene:  # fmt: skip
    """A rectangular ply of that size about the origin, in the plane z = 0, free, at rest, undamped, without gravity.

    orientation_deg: of the grid; fibre_deg: of family 1 to the grid, of a shell-membrane ply only; solver: keys of the
    case's solver.
    """
    ply = {"orientation_deg": orientation_deg, "formulation": formulation}
    whole = case_scene(fabric, size_mm, element_mm, ply=ply, solver=dict(solver))
    scene = damped(alone(whole, 1), 0.0)
    sheet = scene.model.sheets[0]
    tangent = shear_law.largest_tangent(*entered_law(fabric))
    spacing, rigidity = (float(sheet["a1"]), float(sheet["a2"])), (float(sheet["bend1"]), float(sheet["bend2"]))
    mass = areal_mass(fabric) * whole.sheets[1].mass_scaling
    if formulation == SHELL_MEMBRANE:
        sheet["fibre"] = np.deg2rad(fibre_deg)
        omega2 = timestep.shell_membrane_omega2(
            stiffest(fabric), tangent, fabric.transverse_shear_N_mm, spacing, 0.0, mass
        )
        limit = timestep.damped_limit(math.sqrt(omega2), whole.case.solver.fibre_damping)
    else:
        limit = 2.0 / math.sqrt(timestep.ply_omega2(tangent, rigidity, spacing, 0.0, mass))
    safe = scene.case.solver.step_safety * limit
    sheet_vectors(scene.model, scene.state.x, 0)[2] = 0.0
    return replace(scene, model=scene.model._replace(dt=safe), step_limit=safe)


def alone(scene: Scene, k: int) -> Scene:
    """The scene with sheet k only: no other sheet, no contact, no tool."""
    model = scene.model
    sheet = model.sheets[k]
    n, first = int(sheet["rows"] * sheet["cols"]), int(sheet["node"])
    blocks = model.blocks[model.blocks["sheet"] == k].copy()
    blocks["sheet"] = 0
    sheets = model.sheets[k : k + 1].copy()
    sheets["node"] = sheets["shell"] = 0
    sheets["bed"] = 0.0
    names = ("mass", "inverse_mass", "area", "inverse_area", "bar1", "bar2", "cell", "triple1", "triple2", "cover")
    pools = {name: getattr(model, name)[first : first + n].copy() for name in names}
    small = model._replace(
        sheets=sheets, blocks=blocks, pairs=model.pairs[:0], **pools,
        weight=model.weight[4 * first : 4 * (first + n)].copy(),
        centre=model.centre[2 * first : 2 * (first + n)].copy(),
        **rim_lists(no_rims(1), sheets, blocks), exposed=model.exposed[:0], tool_sheet=-1,
        **without_mirror(pools["inverse_mass"], len(blocks)),
    )  # fmt: skip
    x = scene.state.x[3 * first : 3 * (first + n)].copy()
    return replace(scene, model=small, state=state_at_rest(small, x, np.zeros(0)), sheets=(scene.sheets[k],))


def copied_state(state: State) -> State:
    """The same state in arrays of its own."""
    return State(*(array.copy() for array in state))


def damped(scene: Scene, damping_1_s: float) -> Scene:
    """The scene under constant loads with a mass damping [1/s]."""
    air = np.full(2, scene.path.atmosphere)
    path = LoadPath(
        np.array([0.0, 1.0]), air, air, np.zeros(2), np.zeros(1, bool), np.array([damping_1_s]), ("hold",), air[0]
    )
    return replace(scene, path=path)


def with_gravity(scene: Scene, gravity: Sequence[float]) -> Scene:
    """The scene with an acceleration (3,) [mm/s2] on all masses."""
    return replace(scene, model=scene.model._replace(gravity=np.asarray(gravity, dtype=float)))


def held(scene: Scene, mask: NDArray[np.bool_], k: int = 0) -> Scene:
    """The scene with nodes (rows, cols) of sheet k held at the velocity that the state gives them."""
    model: Model = scene.model
    mass, inverse = model.mass.copy(), model.inverse_mass.copy()
    first = int(model.sheets[k]["node"])
    place = first + np.flatnonzero(mask)
    mass[place] = inverse[place] = 0.0
    return replace(scene, model=model._replace(mass=mass, inverse_mass=inverse, line_mass=inverse))


def directors(scene: Scene, k: int = 0) -> FloatArray:
    """Directors (3, rows, cols) of sheet k, a shell-membrane ply, a view."""
    return sheet_shells(scene.model, scene.state.director, k, 3)


def erect_directors(scene: Scene, clamp: NDArray[np.bool_], k: int = 0) -> None:
    """Put the directors of sheet k normal to it where it is now; those of clamped nodes (rows, cols) along z."""
    directors(scene, k)[:] = normals(positions(scene, k))
    directors(scene, k)[:, clamp] = np.array([0.0, 0.0, 1.0])[:, None]


def positions(scene: Scene, k: int = 0) -> FloatArray:
    """Positions (3, rows, cols) of sheet k, a view."""
    return sheet_vectors(scene.model, scene.state.x, k)


def velocities(scene: Scene, k: int = 0) -> FloatArray:
    """Velocities (3, rows, cols) of sheet k, a view."""
    return sheet_vectors(scene.model, scene.state.v, k)


def march(sim: Simulation, steps: int) -> None:
    """Advance, in one batch without contacts: only they need the short ones of `Simulation.advance`."""
    if sim.model.pairs.size:
        sim.advance(steps)
    else:
        sim._batch(steps)


def lead(sim: Simulation, mask: NDArray[np.bool_], target: FloatArray, steps: int) -> None:
    """Advance while held nodes (rows, cols) go straight to their target positions (3, count) [mm]."""
    x, v = positions(sim.scene), velocities(sim.scene)
    v[:, mask] = (target - x[:, mask]) / (steps * sim.model.dt)
    march(sim, steps)


def settle(sim: Simulation, speed_mm_s: float, longest_s: float, steps: int = 200) -> float:
    """Advance until nothing in the ply goes anywhere faster than a speed; returns the time it took [s].

    The speed is that between two looks an even number of steps apart, for the families are corrected in turn (see
    `elements.tension`). Raises UnstableError where it has not come to rest after `longest_s`, or is no number any more.
    """
    start, x = sim.time, positions(sim.scene)
    while True:
        before = x.copy()
        march(sim, steps)
        fastest = float(np.sqrt(((x - before) ** 2).sum(axis=0).max())) / (steps * sim.model.dt)
        if fastest <= speed_mm_s:
            return sim.time - start
        if not math.isfinite(fastest) or sim.time - start > longest_s:
            raise UnstableError(
                f"not at rest after {sim.time - start:.3g} s: {fastest:.3g} mm/s, wanted {speed_mm_s:.3g}",
                "another element size or material may be too stiff or too soft for this problem's damping",
            )
