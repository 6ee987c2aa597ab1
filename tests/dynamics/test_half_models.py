"""A half model does what the whole does that stays symmetric."""

from __future__ import annotations

import numpy as np
import pytest

from ddf.build import build_scene
from ddf.case import case_from_dict
from ddf.dynamics.handle import held
from ddf.dynamics.mirror import meet_image
from ddf.metrics import boundary_profile
from ddf.model import State, sheet_scalars, sheet_vectors
from ddf.monitors.audit import self_contact
from ddf.monitors.energy import energies
from ddf.monitors.layers import depth_in_layers
from ddf.output.snapshot import ply_surface
from ddf.simulate import Simulation

STAGES = [
    {"name": "evacuate-cavity", "duration_s": 0.01, "cavity_pressure_kPa": 0.0},
    {"name": "lift", "duration_s": 0.03, "tool_lift_mm": 15.0},
    {"name": "evacuate-box", "duration_s": 0.02, "box_pressure_kPa": 60.0},
    {"name": "hold", "duration_s": 0.02, "mass_damping_1_s": 300.0},
]
TOOL = {"shape": "cube-corner-tetrahedron", "height_mm": 20.0, "fillet_mm": 5.0}


def scene_of(symmetry, angles=(0.0,), **changes):
    """A ply of 80 mm an angle, 20 cells along it (28 at 45 degrees), over a small tetrahedron."""
    plies = [
        {"name": f"ply-{k}", "size_mm": [80.0, 80.0], "orientation_deg": angle, "element_mm": 4.1}
        | changes.get("ply", {})
        for k, angle in enumerate(angles)
    ]
    raw = {
        "frame": {"length_mm": 200.0, "width_mm": 160.0}, "diaphragms": {"element_mm": 5.0, "margin_mm": 10.0},
        "plies": plies, "process": {"stages": STAGES}, "tool": TOOL | changes.get("tool", {}),
        "solver": {"symmetry": symmetry},
    }  # fmt: skip
    return build_scene(case_from_dict(raw))


def largest_difference(one, other):
    """Between the positions of all nodes of two scenes that exist [mm]."""
    away = 0.0
    for k in range(len(one.sheets)):
        there = sheet_scalars(one.model, one.model.area, k) > 0.0
        x, y = (sheet_vectors(s.model, s.state.x, k) for s in (one, other))
        away = max(away, float(np.linalg.norm(x - y, axis=0)[there].max()))
    return away


def both(angles, steps, **changes):
    """The whole scene and the half one's whole after some steps."""
    scenes = [scene_of(symmetry, angles, **changes) for symmetry in ("off", "auto")]
    assert scenes[0].half is None
    assert scenes[1].half is not None
    for scene in scenes:
        sim = Simulation(scene)
        sim.advance(steps)
        sim.close()
    return scenes[0], scenes[1].whole()


def test_half_of_a_flat_stack_moves_as_the_whole():
    whole, half = both((0.0, 90.0), 200)
    assert largest_difference(whole, half) < 1e-9
    assert float(np.abs(whole.state.v).max()) > 1.0  # it moves
    one, other = (energies(scene.model, scene.state) for scene in (whole, half))
    assert other.total_work == pytest.approx(one.total_work, rel=1e-9)
    assert other.error == pytest.approx(one.error, rel=1e-5)
    for part, value in one.dissipated.items():
        assert other.dissipated[part] == pytest.approx(value, rel=1e-6, abs=1e-6 * one.total_work)
    assert np.abs(half.state.press - whole.state.press).max() < 1e-9 * whole.state.press.max()
    assert np.abs(half.state.f - whole.state.f).max() < 1e-6 * np.abs(whole.state.f).max()
    assert depth_in_layers(half) == pytest.approx(depth_in_layers(whole), rel=1e-6)


def test_half_of_a_ply_at_45_degrees_errs_as_its_families_in_turn_do():
    """Families are corrected one after the other: the whole itself is its own image only up to that."""
    whole, half = both((45.0,), 200)
    assert largest_difference(whole, half) < 2e-3


@pytest.mark.parametrize("angles", [(0.0,), (45.0, 0.0)])
def test_formed_half_has_the_outline_and_the_energies_of_the_whole(angles):
    whole, half = both(angles, 2500)
    assert largest_difference(whole, half) < 0.1  # the tool's own facets are not symmetric: 0.03 mm
    one, other = (energies(scene.model, scene.state) for scene in (whole, half))
    assert other.total_work == pytest.approx(one.total_work, rel=2e-3)
    assert other.total_strain == pytest.approx(one.total_strain, rel=1e-2)
    assert other.error_share == pytest.approx(one.error_share, abs=1e-3)
    for k in whole.ply_sheets:
        outlines = [boundary_profile(ply_surface(scene, scene.state, k)) for scene in (whole, half)]
        drawn_in = np.linalg.norm(np.concatenate([p[:, :2] for p in outlines[0].deformed]), axis=1)
        halves = np.linalg.norm(np.concatenate([p[:, :2] for p in outlines[1].deformed]), axis=1)
        assert np.abs(drawn_in - halves).max() < 0.01 * (56.6 - drawn_in.min() + 1.0)
    assert self_contact(half)[0] == self_contact(whole)[0]


def test_half_model_has_the_same_bits_on_two_threads():
    states = []
    for threads in (1, 2):
        scene = scene_of("auto", (45.0, 0.0))
        sim = Simulation(scene, threads)
        sim.advance(700)
        sim.close()
        states.append(scene.state)
    for name, one, other in zip(State._fields, *states, strict=True):
        assert (one == other).all(), name


def test_nodes_on_the_plane_stay_and_ghosts_follow():
    scene = scene_of("auto", (45.0, 0.0))
    sim = Simulation(scene)
    sim.advance(1500)
    sim.close()
    model, axis = scene.model, scene.half.axis
    for k in range(len(scene.sheets)):
        s = model.sheets[k]
        first, size = int(s["node"]), int(s["rows"] * s["cols"])
        x = sheet_vectors(model, scene.state.x, k).reshape(3, -1)
        plane = model.plane[(model.plane >= first) & (model.plane < first + size)] - first
        assert plane.size > 10
        assert (x[axis, plane] == 0.0).all()
        ghosts = model.ghosts[(model.ghosts[:, 0] >= first) & (model.ghosts[:, 0] < first + size)] - first
        assert (x[axis, ghosts[:, 0]] == -x[axis, ghosts[:, 1]]).all()
        assert (x[2, ghosts[:, 0]] == x[2, ghosts[:, 1]]).all()


def test_sheet_meets_its_image_by_the_gradient_of_an_energy():
    scene = scene_of("auto")
    model, state = scene.model, scene.state
    x, f = sheet_vectors(model, state.x, 0), sheet_vectors(model, state.f, 0)
    pair = model.pairs[(model.pairs["slave"] == 0) & (model.pairs["master"] == 0)][0]
    block = int(
        np.flatnonzero((model.blocks["sheet"] == 0) & (model.blocks["low"] <= 10) & (model.blocks["high"] > 10))[0]
    )
    handles = held(model), held(state)

    def stored():
        f[:] = 0.0
        return meet_image(*handles, pair, block)

    assert stored() == 0.0
    x[0, 10, 7], x[0, 10, 9] = 0.2, 10.0
    energy = stored()
    force = f[:, 10, 7].copy()
    assert min(energy, force[0]) > 0.0
    assert np.count_nonzero(f) == 1
    x[0, 10, 7] += 1e-6
    assert (stored() - energy) / 1e-6 == pytest.approx(-force[0], rel=1e-4)


def test_wall_begins_where_folds_may_close_and_not_at_the_frames_cells():
    scene = scene_of("auto")
    model = scene.model
    away, x = (sheet_scalars(model, model.away, 0), sheet_vectors(model, scene.state.x, 0)[0])
    least = 0.5 * max(np.pi * float(model.sheets[0]["fold_radius"]), 2.0 * 5.0)
    assert (away == (x > least)).all()
    assert away.any()


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"ply": {"offset_mm": [3.0, 3.0]}}, "ply-0 is not its own image"),
        ({"ply": {"orientation_deg": 30.0}}, "ply-0 is not its own image"),
        ({"tool": {"turn_deg": 37.0}}, "the tool's image is off by"),
        ({"tool": {"fillet_mm": 0.0}}, "sharp vertices"),
        ({"ply": {"formulation": "shell-membrane"}}, "shell-membrane"),
        ({"ply": {"slits_mm": [[[0.0, 40.0], [10.0, 20.0]]]}}, "ply-0 is not its own image"),
    ],
)
def test_scenes_that_are_not_their_own_image_stay_whole(changes, why):
    scene = scene_of("auto", **changes)
    assert scene.half is None
    assert why in scene.symmetry


def test_plane_that_is_normal_to_y():
    """A tool turned by a quarter is its own image in y = 0, and forms as the other one, with plies turned likewise."""
    scene = scene_of("auto", tool={"turn_deg": 90.0}, ply={"offset_mm": [4.0, 0.0]})
    assert scene.half is not None
    assert scene.half.where == "y > 0"
    whole = scene_of("off", tool={"turn_deg": 90.0}, ply={"offset_mm": [4.0, 0.0]})
    for one in (scene, whole):
        sim = Simulation(one)
        sim.advance(round(0.031 / one.model.dt))
        sim.close()
    assert largest_difference(whole, scene.whole()) < 0.02
