from __future__ import annotations

import numpy as np
import pytest

from ddf.elements.shear import shear_energy
from ddf.model import sheet_vectors
from ddf.output.results import FinishedRun
from ddf.output.snapshot import middle_offset_mm, ply_surface, shear_force, take_snapshot
from ddf.output.vtu import FrameWriter


def test_a_snapshot_has_every_field_of_every_sheet(scene):
    snapshot = take_snapshot(scene, scene.state)
    assert [s.kind for s in snapshot.sheets] == ["diaphragm", "ply", "ply", "diaphragm"]
    assert snapshot.stage == "lift"
    assert snapshot.loads["tool_lift_mm"] == pytest.approx(20.0)
    for sheet in snapshot.sheets:
        for values in sheet.cell_fields.values():
            assert values.shape == sheet.exists.shape
            assert np.isfinite(values[sheet.exists]).all()
        np.testing.assert_allclose(sheet.point_fields["speed_mm_s"], 1.5 * np.sqrt(3))


def test_the_thickness_keeps_the_volume_and_a_flat_scene_is_not_stretched(scene, flat_scene):
    cells = take_snapshot(scene, scene.state).sheets[0].cell_fields
    t0 = scene.case.diaphragms.thickness_mm
    np.testing.assert_allclose(cells["thickness_mm"] * cells["stretch_1"] * cells["stretch_2"], t0)
    flat = take_snapshot(flat_scene, flat_scene.state)
    np.testing.assert_allclose(flat.sheets[3].cell_fields["stretch_1"], flat_scene.case.diaphragms.pre_stretch)
    assert np.abs(flat.sheets[1].cell_fields["shear_angle_deg"]).max() < 1e-5


def test_shear_force_is_the_slope_of_the_shear_energy(flat_scene):
    table = flat_scene.model.shear_tables[0]

    def energy(angle):
        x = np.zeros((3, 2, 2))
        x[0, 1] = 1.0
        x[0, :, 1] += np.sin(angle)
        x[1, :, 1] = np.cos(angle)
        return shear_energy(x, np.ones((2, 2)), table)

    for angle in (0.2, -0.6, 0.9):
        slope = (energy(angle + 1e-5) - energy(angle - 1e-5)) / 2e-5
        assert shear_force(np.array([angle]), table)[0] * np.cos(angle) == pytest.approx(slope, rel=1e-4)


def test_distance_is_zero_where_a_sheet_conforms(scene):
    k = 1
    x = sheet_vectors(scene.model, scene.state.x, k)
    x[2] = scene.tool_z(scene.path.duration) + middle_offset_mm(scene, k)
    far = np.hypot(x[0], x[1]) > 40
    surface = ply_surface(scene, scene.state, k)
    gap = surface.distance(np.ascontiguousarray(surface.x[:, far].T)) - surface.offset_mm
    np.testing.assert_allclose(gap, 0.0, atol=1e-9)


def test_the_outline_of_a_turned_ply_follows_the_fabric(scene):
    k = scene.ply_sheets[1]
    x = sheet_vectors(scene.model, scene.state.x, k)
    x[:] += np.array([3.0, 4.0, 5.0])[:, None, None]
    x[:, ~scene.sheets[k].mesh.active] = 1e6
    surface = ply_surface(scene, scene.state, k)
    near = np.abs(surface.x).max(axis=0) < 1e5
    from ddf.metrics import boundary_profile

    profile = boundary_profile(surface)
    assert near[surface.active].all()
    moved = profile.deformed[0][:, :2] - profile.initial[0][:, :2]
    np.testing.assert_allclose(moved, np.tile([3.0, 4.0], (len(moved), 1)), atol=1e-9)


def test_frames_are_read_back_and_pruned(scene, folder):
    writer = FrameWriter(folder, scene)
    snapshots = []
    for time in (0.0, 0.01, 0.03):
        scene.state.clock[1] = time
        snapshots.append(take_snapshot(scene, scene.state))
        writer.write(snapshots[-1])
    run = FinishedRun(folder.path)
    frame, sheet = run.read_frame("ply-2", 1), snapshots[1].sheet("ply-2")
    assert frame["time_s"] == 0.01
    assert len(frame["cells"]) == sheet.exists.sum()
    np.testing.assert_array_equal(frame["points"], sheet.x[:, frame["row"], frame["col"]].T)
    np.testing.assert_allclose(frame["shear_angle_deg"], sheet.cell_fields["shear_angle_deg"][sheet.exists], rtol=1e-6)
    lift = run.read_frame("tool", 2)["points"] - run.read_frame("tool", 0)["points"]
    np.testing.assert_allclose(lift, np.tile([0.0, 0.0, 20.0], (len(lift), 1)), atol=1e-9)
    again = FrameWriter(folder, scene)
    assert again.count == 3
    again.prune(after_time=0.01)
    assert [time for time, _ in run.frames("tool")] == [0.0, 0.01]
    assert not (folder / "frames/ply-1-0002.vtu").exists()
    assert again.count == 2
