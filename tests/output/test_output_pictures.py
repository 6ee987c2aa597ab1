from __future__ import annotations

import numpy as np
import pytest

from ddf.metrics import Wrinkle, WrinkleResult
from ddf.monitors.energy import energies
from ddf.output import charts, plots
from ddf.output.figures import save_picture
from ddf.output.raster import view_from_above
from ddf.output.report import Report, render_report, write_report
from ddf.output.results import FinishedRun
from ddf.output.shading import node_normals, photograph
from ddf.output.snapshot import ply_surface, take_snapshot
from ddf.output.tables import HistoryWriter


def grid(height):
    x = np.zeros((3, 11, 11))
    x[0], x[1] = np.meshgrid(np.linspace(-10, 10, 11), np.linspace(-10, 10, 11), indexing="ij")
    x[2] = height(x[0], x[1])
    return x, np.ones((10, 10), bool)


def one_wrinkle(ply="ply-1"):
    crest = np.array([[0.0, 0.0, 3.0], [20.0, 5.0, 3.0], [40.0, 8.0, 2.0]])
    numbers = dict.fromkeys(Wrinkle.__dataclass_fields__, 2.0)
    wrinkle = Wrinkle(**(numbers | {"ply": ply, "start": crest[0], "end": crest[-1], "crest": crest}))
    return WrinkleResult([wrinkle], np.zeros((1, 1), bool), np.zeros((2, 2)), 1.0)


def test_the_view_from_above_gives_height_and_place_on_the_grid():
    x, exists = grid(lambda a, b: 0.1 * a)
    view = view_from_above(x, exists, (-12.0, 12.0, -12.0, 12.0), pixels=96)
    inside = np.zeros((96, 96), bool)
    inside[8:88, 8:88] = True
    np.testing.assert_array_equal(view.covered, inside)
    middle = (np.arange(96) + 0.5) / 4 - 12
    np.testing.assert_allclose(view.z[40, 8:88], 0.1 * middle[8:88], atol=1e-12)
    np.testing.assert_allclose(view.u[40, 8:88], (middle[8:88] + 10) / 2, atol=1e-12)
    np.testing.assert_allclose(view.nodes(x[1])[8:88, 30], middle[8:88], atol=1e-12)


def test_the_highest_layer_of_a_fold_is_seen():
    x, exists = grid(lambda a, b: 0 * a)
    x[0] = np.abs(x[0])
    x[2, :5] = 7.0
    view = view_from_above(x, exists, (2.5, 9.5, -9.0, 9.0), pixels=60)
    assert view.z[view.covered].min() == pytest.approx(7.0)


def test_light_comes_from_the_upper_left_and_casts_shadows():
    x, exists = grid(lambda a, b: 6 * np.exp(-(a**2 + b**2) / 6))
    view = view_from_above(x, exists, (-10.0, 10.0, -10.0, 10.0), pixels=100)
    image = photograph(view, x, exists).mean(axis=2)
    assert image.shape == (100, 100)
    assert image[60:70, 30:40].mean() > 1.3 * image[30:40, 60:70].mean()
    np.testing.assert_allclose((node_normals(x, exists) ** 2).sum(axis=0), 1.0)


def test_every_picture_is_drawn_and_the_report_holds_it(scene, folder, monkeypatch):
    monkeypatch.setattr(plots, "PIXELS", 200)
    snapshot = take_snapshot(scene, scene.state)
    k = scene.ply_sheets[1]
    surface = ply_surface(scene, scene.state, k)
    names = [s.name for s in scene.sheets]
    writer = HistoryWriter(folder, names)
    for step, stage in enumerate(["evacuate", "evacuate", "lift", "lift"]):
        now = energies(scene.model, scene.state)
        writer.append(step, 0.01 * step, stage, snapshot.loads, now, 1e-5, 0.0)
    pictures = {
        "formed-top-diaphragm": plots.draw_formed(snapshot.sheets[-1]),
        "formed-ply-2": plots.draw_formed(snapshot.sheets[k], surface),
        "shear-ply-2": plots.draw_shear(surface),
        "distance-ply-2": plots.draw_distance(surface),
        "outline-ply-2": plots.draw_outline(surface, one_wrinkle(), scene.tool_mesh),
        "energies": charts.draw_energies(FinishedRun(folder.path).history(), scene.path),
        "stages": charts.draw_stages(scene.path, [(0.01, surface), (0.03, surface)]),
    }
    for name, figure in pictures.items():
        save_picture(folder, name, figure)
        assert (folder / f"pictures/{name}.png").read_bytes()[:4] == b"\x89PNG"
    write_report(folder, Report(title="A run"))
    html = (folder / "report.html").read_text(encoding="utf-8")
    assert html.count("data:image/png;base64,") == len(pictures)
    assert "<script" not in html
    assert "://" not in html


def test_the_base_of_a_hemisphere_is_a_circle(scene):
    segments = plots.base_segments(scene.tool_mesh)
    np.testing.assert_allclose(np.linalg.norm(segments, axis=2), 20.0, atol=0.2)


def test_the_report_shows_numbers_wrinkles_and_failed_checks():
    from ddf.metrics import wrinkle_row

    ply = {
        "ply": "ply-1", "wrinkle_count": 1, "shear_max_deg": 41.234, "bridging_largest_mm": None,
        "draw_in_mid_side_mm": {"90deg": 12.5}, "wrinkles": [wrinkle_row(one_wrinkle().wrinkles[0])],
    }  # fmt: skip
    audit = [
        {"name": "energy error", "value": 12.0, "limit": 5.0, "ok": False, "meaning": "energy is lost"},
        {"name": "step", "value": 1.0, "limit": 2.0, "ok": True, "meaning": ""},
    ]
    html = render_report(
        Report("A <b> run", plies=[ply], audit=audit, key_numbers={"steps": 12345}, settings="[tool]"), {}
    )
    assert "A &lt;b&gt; run" in html
    assert "41.23" in html
    assert "1 of 2 checks failed" in html
    assert "mid-side at 90° 12.5" in html
    assert "12\u202f345" in html
    assert "[tool]" in html
