"""Fibres, thickness and closest points against closed forms and a net on a hemisphere."""

import csv

import numpy as np
import pytest
from nets import NET, RADIUS, lattice

from ddf.case import case_from_dict
from ddf.errors import UsageError
from ddf.export.closest import closest_on_tool
from ddf.export.fibres import element_fields
from ddf.export.part import FormedPly, formed_part
from ddf.export.tables import export_fibres
from ddf.output.results import read_vtu
from ddf.run import run_case


def test_a_sheared_ply_thickens_as_its_area_shrinks():
    fields = element_fields(FormedPly(lattice(1.02, 30.0, tilt_deg=40.0), 0.5, 0.0))
    np.testing.assert_allclose(fields["shear_angle_deg"], 30.0)
    np.testing.assert_allclose(fields["area_ratio"], 1.02 * np.cos(np.radians(30.0)))
    np.testing.assert_allclose(fields["thickness_mm"] * fields["area_ratio"], 0.5)
    c, s = np.cos(np.radians(40.0)), np.sin(np.radians(40.0))
    np.testing.assert_allclose(fields["fibre_1"], np.broadcast_to([c, 0.0, s], (6, 6, 3)), atol=1e-12)
    np.testing.assert_allclose(fields["fibre_1_angle_deg"], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(fields["fibre_2"], axis=-1), 1.0)
    np.testing.assert_allclose(fields["fibre_2_angle_deg"], np.degrees(np.arctan2(np.cos(np.pi / 6), c * 0.5)))


def test_elements_stand_on_the_tool_in_its_own_frame(part, tmp_path):
    vtu, table = export_fibres(part, tmp_path)
    with table.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    columns = {key: np.array([float(row[key]) for row in rows]) for key in rows[0] if key != "surface"}
    on_tool = np.array([row["surface"] == "tool" for row in rows])
    point = np.stack([columns[f"tool_{axis}_mm"] for axis in "xyz"], axis=1)
    normal = np.stack([columns[f"normal_{axis}"] for axis in "xyz"], axis=1)
    assert 0.4 < on_tool.mean() < 0.9
    # the tool's axis is its frame's: points lie on the sphere but for the mesh's chord, normals through its centre
    np.testing.assert_allclose(np.linalg.norm(point[on_tool], axis=1), RADIUS, atol=0.03)
    np.testing.assert_allclose(normal[on_tool], point[on_tool] / RADIUS, atol=0.03)
    np.testing.assert_allclose(point[~on_tool, 2], 0.0)
    centre = np.stack([columns[f"{axis}_mm"] for axis in "xyz"], axis=1)
    distance = np.where(on_tool, np.linalg.norm(centre, axis=1) - RADIUS, centre[:, 2])
    np.testing.assert_allclose(columns["gap_mm"], distance - 0.5, atol=0.03)
    # the net starts on the pole, with family 1 at 30 deg in the case's frame: 5 deg in the tool's
    pole = np.argmin(np.hypot(*centre[:, :2].T))
    assert columns["fibre_1_angle_deg"][pole] == pytest.approx(5.0, abs=1.0)
    dome = centre[:, 2] > 15.0  # elements across the foot are twisted: their middle lines are shorter
    cosine = np.cos(np.radians(columns["shear_angle_deg"]))
    assert cosine[dome].min() < 0.9
    np.testing.assert_allclose((columns["thickness_mm"] * cosine)[dome], 0.5, rtol=5e-3)
    assert columns["flat_area_mm2"].sum() == pytest.approx(190.0 * 180.0, rel=2e-3)
    frame = read_vtu(vtu)
    assert frame["fibre_1"].shape == (len(rows), 3)
    np.testing.assert_allclose(frame["thickness_mm"], columns["thickness_mm"], rtol=1e-6)
    np.testing.assert_allclose(frame["gap_mm"], columns["gap_mm"], atol=1e-5)


def test_the_nearer_of_tool_and_platform_is_taken(part):
    points = np.array([[0.0, 0.0, 60.0], [0.0, 0.0, 45.0], [RADIUS + 3.0, 0.0, 1.0], [RADIUS + 1.0, 0.0, 5.0]])
    found = closest_on_tool(part.tool, points)
    np.testing.assert_array_equal(found.on_tool, [True, True, False, True])
    np.testing.assert_allclose(found.distance[:3], [10.0, -5.0, 1.0], atol=0.03)
    np.testing.assert_allclose(found.normal[2], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(closest_on_tool(None, points).distance, points[:, 2])


def test_what_cannot_be_exported_is_refused(run, tmp_path):
    with pytest.raises(UsageError, match="no ply 'top'"):
        formed_part(run, ["top"])
    with pytest.raises(UsageError, match="no run"):
        formed_part(tmp_path)
    run_case(case_from_dict(NET | {"output": {"pictures": False}}), tmp_path / "other")
    (tmp_path / "other" / "ply-1.pvd").unlink()
    with pytest.raises(UsageError, match="no frames of ply-1"):
        formed_part(tmp_path / "other")
