"""Exports of a forming run's folder: the tool's frame at the end of the process, and the animation of its frames."""

import numpy as np
import pytest
from PIL import Image

from ddf.build import build_scene
from ddf.case import case_from_dict, resolved_toml
from ddf.errors import UsageError
from ddf.export.animation import export_animation
from ddf.export.part import formed_part
from ddf.export.tables import element_table
from ddf.model import sheet_vectors
from ddf.output.charts import moment
from ddf.output.folder import RunFolder
from ddf.output.snapshot import ply_surface, take_snapshot
from ddf.output.tables import write_profiles
from ddf.output.vtu import FrameWriter

CASE = {
    "frame": {"length_mm": 260.0, "width_mm": 240.0},
    "diaphragms": {"element_mm": 20.0, "element_max_mm": 30.0},
    "plies": [{"size_mm": [120.0, 120.0], "element_mm": 10.0}, {"size_mm": [100.0, 100.0], "element_mm": 10.0}],
    "tool": {"shape": "hemisphere", "radius_mm": 20.0},
    "process": {"stages": [
        {"name": "evacuate", "duration_s": 0.01, "cavity_pressure_kPa": 0.0},
        {"name": "lift", "duration_s": 0.02, "tool_lift_mm": 20.0},
    ]},
}  # fmt: skip
LEVEL = 25.0  # height of both plies in the second frame [mm]


@pytest.fixture(scope="module")
def formed(tmp_path_factory):
    """A folder as a run leaves it: the plies flat at first, and lifted flat at the end."""
    scene = build_scene(case_from_dict(CASE))
    out = RunFolder.create(tmp_path_factory.mktemp("forming") / "run")
    frames = FrameWriter(out, scene)
    frames.write(take_snapshot(scene, scene.state))
    for k in scene.ply_sheets:
        sheet_vectors(scene.model, scene.state.x, k)[2] = LEVEL
    scene.state.clock[:2] = scene.steps, scene.path.duration
    frames.write(take_snapshot(scene, scene.state))
    write_profiles(out, [ply_surface(scene, scene.state, k) for k in scene.ply_sheets])
    out.write_text("case.resolved.toml", resolved_toml(scene.case))
    out.write_json("metrics.json", {"plies": [{"ply": scene.sheets[k].name} for k in scene.ply_sheets]})
    out.write_json("run.json", {"stop_reason": "finished"})
    return out.path, scene


def test_heights_are_over_the_platform_at_the_end(formed):
    path, scene = formed
    part = formed_part(path, ["ply-2"])
    (ply,) = part.plies
    height = LEVEL - scene.tool_z(scene.path.duration)
    np.testing.assert_allclose(ply.surface.x[2][ply.surface.active], height, atol=1e-9)
    assert part.tool.top_mm == pytest.approx(20.0, abs=0.01)
    table = element_table(ply, part.tool)
    middle = np.argmin(np.hypot(table["x_mm"], table["y_mm"]))
    between = scene.sheets[0].thickness_mm + 1.5 * 0.5  # the diaphragm, the ply below, half its own
    assert table["gap_mm"][middle] == pytest.approx(np.hypot(height, np.sqrt(50.0)) - 20.0 - between, abs=0.02)


def test_animation_shows_every_frame_with_its_moment(formed, tmp_path):
    path, scene = formed
    gif = export_animation(path, tmp_path, "ply-1")
    with Image.open(gif) as film:
        assert film.n_frames >= 2
        first = np.asarray(film.convert("L"), dtype=float)
        film.seek(film.n_frames - 1)
        last = np.asarray(film.convert("L"), dtype=float)
        assert film.info["duration"] > 1500  # the last frame stays
    assert np.abs(first - last)[:60].max() > 60  # the title has changed
    assert first[200:500, 200:500].std() > 3  # a ply with its lines
    loads = scene.path
    assert "lift: 30 ms" in moment(loads, 0.03)
    assert "evacuate: 10 ms\ncavity 0.0 kPa, box 101.3 kPa" in moment(loads, 0.01)
    with pytest.raises(UsageError, match="no ply 'x'"):
        export_animation(path, tmp_path, "x")


def test_a_run_that_is_not_finished_is_refused(formed, tmp_path):
    path, _ = formed
    (tmp_path / "run.json").write_text('{"stop_reason": "interrupted"}')
    (tmp_path / "case.resolved.toml").write_text((path / "case.resolved.toml").read_text())
    with pytest.raises(UsageError, match="not finished"):
        formed_part(tmp_path)
