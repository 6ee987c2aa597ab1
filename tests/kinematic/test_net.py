"""The kinematic net against what is known of inextensible nets, and where it has to give up."""

import numpy as np
import pytest

from ddf.kinematic.drape import NetError, drape_ply
from ddf.mesh.distance import DistanceField
from ddf.mesh.ply import mesh_ply
from ddf.metrics import PlySurface, fibre_strain_range, shear_angle
from ddf.verify.kinematic_net import cell_shear, drape_square, exact_hemisphere, sphere_shear_deg


def square(half, element, turn=0.0):
    """A square ply."""
    return mesh_ply([(-half, -half), (half, -half), (half, half), (-half, half)], [], [], turn, element)


def surface(drape):
    m = drape.mesh
    return PlySurface(m.name, drape.x, m.x, m.spacing, m.active, m.cell_fraction)


def lying_cylinder(radius):
    """Half a cylinder along x over the platform."""
    origin, shape = np.array([-120.0, -radius - 10, -10.0]), (241, int(2 * radius) + 21, int(radius) + 21)
    x, y, z = (o + np.arange(n) for o, n in zip(origin, shape, strict=True))
    up = np.maximum(z, 0.0)
    r = np.maximum(np.hypot(y[:, None], up[None]), 1e-9)
    values = np.stack([r - radius, 0 * r, y[:, None] / r, up[None] / r], axis=-1)
    return DistanceField(np.broadcast_to(values, (x.size, *values.shape)).astype(np.float32), origin, 1.0)


@pytest.fixture(scope="module")
def hemisphere():
    return exact_hemisphere()


def test_table_of_the_known_answer():
    got = sphere_shear_deg(np.array([0.1, 0.5, 1.0, 1.2]))
    assert got == pytest.approx([5.7264, 28.2568, 54.3183, 63.7495], abs=1e-4)


def test_hemisphere_agrees_with_the_pin_jointed_net(hemisphere):
    z, got = cell_shear(drape_square(hemisphere, 2.0))
    assert np.abs(z).max() > 0.85  # near the equator: 0.96 on the diagonal
    assert np.abs(got - sphere_shear_deg(z)).max() < 0.05


def test_error_falls_with_the_square_of_the_spacing():
    fine = exact_hemisphere(0.5)
    errors = []
    for element in (16.0, 8.0, 4.0):
        z, got = cell_shear(drape_square(fine, element))
        near = np.abs(z) < 0.55  # what the coarsest net covers
        errors.append(np.abs(got - sphere_shear_deg(z))[near].max())
    assert errors[0] / errors[1] > 3.0
    assert errors[1] / errors[2] > 3.0


def test_flat_tool_gives_no_shear():
    ply = square(50.0, 5.0, turn=20.0)
    drape = drape_ply(ply, None, (10.0, -5.0))
    there = ply.active
    assert np.abs(drape.x[:, there] - ply.x[:, there]).max() < 1e-6
    assert drape.laid_percent == pytest.approx(100.0)


@pytest.mark.parametrize("turn", [0.0, 30.0, 45.0, 75.0])
def test_cylinder_develops_without_shear(turn):
    ply = square(60.0, 3.0, turn)
    drape = drape_ply(ply, lying_cylinder(60.0), (0.0, 0.0))
    net = surface(drape)
    assert np.nanmin(drape.x[2, ply.active]) > 1.0  # it stays on the cylinder, and goes far round it
    assert np.nanmin(drape.x[2, ply.active]) < 40.0
    assert np.abs(shear_angle(net)).max() < 0.05
    assert np.abs(np.array(fibre_strain_range(net))).max() < 1e-6


def test_fibres_keep_their_length_and_hug_the_tool(hemisphere):
    drape = drape_square(hemisphere, 4.0)
    assert np.abs(np.array(fibre_strain_range(surface(drape)))).max() < 1e-9
    points = np.ascontiguousarray(drape.x[:, drape.mesh.active].T)
    assert np.abs(hemisphere.platform_distance(points)).max() < 1e-6


def test_turning_tool_and_ply_together_changes_nothing(hemisphere):
    angles = []
    for turn in (0.0, 90.0):
        drape = drape_ply(square(60.0, 4.0, turn), hemisphere, (0.0, 0.0))
        angles.append(shear_angle(surface(drape)))
    assert np.abs(angles[0] - angles[1]).max() < 1e-4


def test_a_net_that_cannot_close_says_where_and_how_far(hemisphere):
    with pytest.raises(NetError, match=r"cannot be laid beyond node .* fold|shear by more than 90") as caught:
        drape_ply(square(150.0, 4.0), hemisphere, (0.0, 0.0))
    drape = caught.value.drape
    i, j = drape.failed
    around = drape.x[2, i - 2 : i + 3, j - 2 : j + 3]
    assert np.nanmin(around) < 4.0  # at the sharp foot, not on the dome
    assert 20.0 < drape.laid_percent < 100.0
    assert f"{drape.laid_percent:.1f} %" in str(caught.value)
    assert "start_mm" in caught.value.hint


def test_ply_with_a_hole_and_a_start_off_centre(hemisphere):
    hole = [(-40.0, -10.0), (-20.0, -10.0), (-20.0, 10.0), (-40.0, 10.0)]
    ply = mesh_ply([(-60, -60), (60, -60), (60, 60), (-60, 60)], [hole], [], 45.0, 3.0)
    drape = drape_ply(ply, hemisphere, (15.0, 10.0), foot_radius_mm=10.0)
    assert np.isfinite(drape.x[:, ply.active]).all()
    assert np.hypot(*(drape.start_point[:2] - [15.0, 10.0])) < 3.0
    assert np.linalg.norm(drape.start_point) == pytest.approx(60.0, abs=0.01)
