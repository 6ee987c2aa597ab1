from __future__ import annotations

import numpy as np
import pytest
from tiny_scene import make_scene

from ddf.errors import UsageError
from ddf.metrics import WrinkleResult, ply_metrics
from ddf.monitors.energy import energies
from ddf.output.checkpoint import load_checkpoint, save_checkpoint
from ddf.output.results import open_run
from ddf.output.snapshot import ply_surface
from ddf.output.tables import HistoryWriter, write_metrics, write_profiles, write_wrinkles


def append(writer, scene, *steps):
    for step in steps:
        writer.append(step, step * 1e-3, "lift", scene.path.at(0.01), energies(scene.model, scene.state), 1e-3, 0.5)


def test_history_is_cut_at_the_step_of_the_checkpoint(scene, folder):
    names = [s.name for s in scene.sheets]
    append(HistoryWriter(folder, names), scene, 0, 50, 100)
    whole = (folder / "history.csv").read_text()
    with (folder / "history.csv").open("a") as stream:
        stream.write("150,0.1")  # a row cut short by a crash
    resumed = HistoryWriter(folder, names, resume_step=50)
    append(resumed, scene, 100)
    assert (folder / "history.csv").read_text() == whole
    history = open_run(folder.path).history()
    assert history["step"].tolist() == [0, 50, 100]
    assert set(history["stage"]) == {"lift"}
    parts = sum(v for key, v in history.items() if key.startswith("strain_") and key != "strain_mJ")
    np.testing.assert_allclose(parts, history["strain_mJ"], rtol=1e-7)
    assert "kinetic_over_internal_ply-1_percent" in history


def test_a_history_with_other_columns_is_refused(scene, folder):
    folder.write_text("history.csv", "step,other\n0,1\n")
    writer = HistoryWriter(folder, [s.name for s in scene.sheets], resume_step=0)
    with pytest.raises(UsageError, match="other columns"):
        append(writer, scene, 50)


def test_profiles_wrinkles_and_metrics_are_read_back(scene, folder):
    surfaces = [ply_surface(scene, scene.state, k) for k in scene.ply_sheets]
    none = WrinkleResult([], np.zeros((1, 1), bool), np.zeros((2, 2)), 0.0)
    write_profiles(folder, surfaces)
    write_wrinkles(folder, [none, none])
    write_metrics(folder, [ply_metrics(surface) for surface in surfaces])
    folder.write_json("run.json", {"reason": "finished"})
    run = open_run(folder.path)
    profile = run.profile("ply-2")
    np.testing.assert_allclose(np.abs(profile["x0_mm"]).max(), 50.0)
    assert profile["point"][-1] == len(profile["point"])
    assert run.wrinkles() == []
    assert (folder / "wrinkles.csv").read_text().startswith("number,ply,start_x_mm")
    assert [ply["ply"] for ply in run.metrics["plies"]] == ["ply-1", "ply-2"]
    assert run.info == {"reason": "finished"}


def test_open_run_says_when_there_is_no_run(tmp_path):
    with pytest.raises(UsageError, match="no run"):
        open_run(tmp_path)
    with pytest.raises(UsageError, match="not a folder"):
        open_run(tmp_path / "nowhere")


def test_a_checkpoint_brings_back_every_bit(scene, folder):
    scene.state.v[:] = np.random.default_rng(1).normal(size=scene.state.v.size)
    save_checkpoint(folder, scene, scene.state, {"rows": [1, 0.1]})
    before = {name: array.copy() for name, array in scene.state._asdict().items()}
    for array in scene.state:
        array[...] = 0
    assert load_checkpoint(folder, scene) == {"rows": [1, 0.1], "step_s": scene.model.dt}
    for name, array in scene.state._asdict().items():
        assert array.tobytes() == before[name].tobytes()


def test_a_checkpoint_of_another_case_is_refused_with_what_differs(scene, folder):
    save_checkpoint(folder, scene, scene.state, {})
    other = make_scene(solver={"mass_scaling": 9.0})
    with pytest.raises(UsageError, match=r"solver\.mass_scaling: not given then, 9\.0 now"):
        load_checkpoint(folder, other)
    load_checkpoint(folder, make_scene(title="Renamed", solver={"threads": 3}))


def test_a_missing_or_broken_checkpoint_is_a_usage_error(scene, folder):
    with pytest.raises(UsageError, match="nothing to resume"):
        load_checkpoint(folder, scene)
    folder.write_bytes("checkpoint.npz", b"PK broken")
    with pytest.raises(UsageError, match="cannot be read"):
        load_checkpoint(folder, scene)
