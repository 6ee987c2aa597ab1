"""Sharp vertices of the tool: found on its mesh, and met by the sheet wherever they come up."""

import numpy as np
import pytest
from differences import gradient
from touching import packed

from ddf.build.summits import first_spots, summit_records
from ddf.contact.patch import patch_centres
from ddf.contact.summit import PUSH, SPOT, add_pushes, summit_forces
from ddf.contact.tool_point import CHUNK, FREE, POINT_ROWS, PRESS
from ddf.mesh.diaphragm import mesh_diaphragm
from ddf.mesh.summits import angle_defects, summits
from ddf.mesh.tool import build_tool

STIFFNESS, CELL = 10.0, 4.0
NODES = 8


class Spike:
    """A vertex at (px, py, 0), its axis upwards, under a sheet of cells of 4 mm about the origin."""

    def __init__(self, px, py):
        self.cells = np.full(NODES - 1, CELL)
        self.summits = np.array([[px, py, 0.0, 0.0, 0.0, 1.0]])
        self.spots = np.zeros((1, SPOT))
        self.spots[0] = 3.5, 3.5, FREE, 0.0, 0.0
        self.centre = patch_centres(np.ones((NODES, NODES), bool))
        self.out = np.zeros(4)
        self.work = 0.0

    def sheet(self, height, slope=(0.0, 0.0)):
        lines = (np.arange(NODES) - 0.5 * (NODES - 1)) * CELL
        x, y = np.meshgrid(lines, lines, indexing="ij")
        return np.array([x, y, height + slope[0] * x + slope[1] * y])

    def forces(self, x, v=None, *, damping=0.0, speed=0.0, seam=None, steps=1):
        """Forces on the nodes after so many steps in the same place; `out` and `work` of the last."""
        v, zero = np.zeros_like(x) if v is None else v, np.zeros_like(x)
        for _ in range(steps):
            self.out[:] = 0.0
            pushes = np.full((1, PUSH), -1.0)
            self.work = summit_forces(
                packed(x).reshape(-1), packed(v, 0.0).reshape(-1), zero, np.zeros((NODES, NODES)), self.centre,
                self.cells, self.cells, (0.75, STIFFNESS, damping, 0.3), (0.0, speed), 1e-6, self.summits, self.spots,
                pushes, self.out, np.zeros(POINT_ROWS * CHUNK),
            )  # fmt: skip
        press, pressed = np.zeros((NODES, NODES, PRESS)), np.zeros(NODES, bool)
        for low, high in ((0, NODES),) if seam is None else ((0, seam), (seam, NODES)):
            add_pushes(press, pressed, pushes, low, high)
        assert (press.any(axis=(1, 2)) <= pressed).all()
        return np.moveaxis(press[..., :3], -1, 0)


@pytest.mark.parametrize(
    ("shape", "fillet", "count", "angle"),
    [
        ("regular-tetrahedron", 0.5, 1, np.pi),
        ("regular-tetrahedron", 2.0, 1, np.pi),
        ("cube-corner-tetrahedron", 0.0, 1, np.pi / 2),
        ("box", 0.5, 0, np.pi / 2),
    ],
)
def test_sharp_vertices_are_found_with_place_and_axis(shape, fillet, count, angle):
    mesh = build_tool(shape, height_mm=40.0, length_mm=60.0, width_mm=50.0, fillet_mm=fillet)
    places, axes = summits(mesh, 2.4)
    assert len(places) == count
    top = mesh.points[:, 2].max()
    if count:
        assert places[0, 2] == pytest.approx(top, abs=0.1)
        assert np.allclose(axes, [[0.0, 0.0, 1.0]], atol=0.02)
    # all of a vertex's solid angle, nothing on edges and faces
    high = mesh.points[:, 2] > 0.5 * top
    assert angle_defects(mesh)[high].sum() == pytest.approx((count or 4) * angle, rel=1e-3)


@pytest.mark.parametrize("shape", ["regular-tetrahedron", "box", "hemisphere", "cylinder"])
def test_what_elements_can_see_is_no_summit(shape):
    mesh = build_tool(shape, height_mm=60.0, radius_mm=40.0, length_mm=80.0, width_mm=60.0, fillet_mm=5.0)
    assert len(summits(mesh, 2.0)[0]) == 0


def _spring(depth):
    """Force of the penalty over its stiffness; stiffer beyond 0.1 and 0.15 mm."""
    return depth + 2.0 * max(0.0, depth - 0.1) + 3.0 * max(0.0, depth - 0.15)


def _waved(rng, height):
    x = Spike(0.0, 0.0).sheet(height, (0.1, -0.05))
    x[2] += 0.004 * (x[0] ** 2 - x[1] ** 2)
    return x + rng.normal(size=x.shape) * 0.02


def test_a_vertex_between_nodes_is_met_at_the_depth_it_has():
    spike = Spike(0.7, -1.1)
    f = spike.forces(spike.sheet(-0.25), steps=4)
    assert f[2].sum() == pytest.approx(CELL**2 * STIFFNESS * _spring(0.25), rel=1e-9)
    assert np.abs(f[:2]).max() < 1e-12
    tilted = spike.forces(spike.sheet(-0.6, (0.3, -0.2)), steps=20)
    normal = np.array([-0.3, 0.2, 1.0]) / np.sqrt(1.13)
    height = (-0.6 + 0.3 * 0.7 + 0.2 * 1.1) / np.sqrt(1.13)
    total = CELL**2 * STIFFNESS * _spring(-height)
    assert tilted.sum(axis=(1, 2)) == pytest.approx(total * normal, rel=1e-6)


def test_the_force_is_the_gradient_of_its_energy_on_a_wavy_sheet():
    rng = np.random.default_rng(0)
    for px, py in ((0.7, -1.1), (-3.9, 5.8), (2.0, 2.0)):
        spike = Spike(px, py)
        x = _waved(rng, -0.4)
        f = spike.forces(x, steps=30)
        assert f[2].sum() > 0.0
        expected = -gradient(lambda y, s=spike: (s.forces(y, steps=12), s.out[0])[1], x)
        assert np.abs(f - expected).max() < 1e-6 * np.abs(expected).max()


def test_no_moment_about_the_vertex():
    spike = Spike(0.7, -1.1)
    x = _waved(np.random.default_rng(1), -0.4)
    f = spike.forces(x, steps=30)
    arms = x - np.array([0.7, -1.1, 0.0]).reshape(3, 1, 1)
    moment = np.cross(arms.reshape(3, -1).T, f.reshape(3, -1).T).sum(axis=0)
    assert np.abs(moment).max() < 1e-9 * np.abs(f).sum() * CELL


def test_the_place_follows_the_vertex_from_cell_to_cell_without_a_jump():
    spike = Spike(-8.0, 0.3)
    pushes = [spike.forces(spike.sheet(-0.2), steps=8)]
    for px in np.linspace(-8.0, 8.0, 161)[1:]:
        spike.summits[0, 0] = px
        pushes.append(spike.forces(spike.sheet(-0.2)))
    sums = [f[2].sum() for f in pushes]
    assert np.allclose(sums, sums[0], rtol=1e-9)
    assert np.abs(np.diff(pushes, axis=0)).max() < 0.03 * sums[0]  # 0.1 mm in cells of 4 mm


def test_blocks_of_rows_share_a_push():
    spike = Spike(0.7, 1.3)
    x = _waved(np.random.default_rng(2), -0.4)
    v = np.random.default_rng(3).normal(size=x.shape) * 100.0
    spike.forces(x, steps=30)  # at its place
    whole = spike.forces(x, v, damping=1e-4)
    assert np.abs(whole).max() > 0.0
    for seam in (2, 3, 4, 5):
        assert np.allclose(whole, spike.forces(x, v, damping=1e-4, seam=seam), rtol=1e-9)


def test_the_tool_s_work_is_force_times_way_and_far_vertices_do_nothing():
    spike = Spike(0.7, -1.1)
    f = spike.forces(spike.sheet(-0.3), speed=800.0, steps=4)
    assert spike.work == pytest.approx(f[2].sum() * 800.0 * 1e-6, rel=1e-12)
    assert not spike.forces(spike.sheet(0.1), steps=2).any()
    spike.summits[0, :2] = 30.0, 0.0  # beyond the sheet
    assert not spike.forces(spike.sheet(-0.3), steps=20).any()


def test_first_spots_are_above_the_vertices():
    diaphragm = mesh_diaphragm(300.0, 200.0, (-60.0, 60.0, -50.0, 50.0), 5.0, 16.0, 1.3)
    mesh = build_tool("regular-tetrahedron", height_mm=40.0, fillet_mm=0.0)
    peaks = summit_records(mesh, 5.0, 0.75)
    assert len(peaks) == 1
    spots = first_spots(peaks, diaphragm)
    x, y = (np.interp(spots[:, k], np.arange(v.size), v) for k, v in enumerate((diaphragm.x_lines, diaphragm.y_lines)))
    assert np.allclose(np.array([x, y]).T, peaks[:, :2])
    places, _ = summits(mesh, 2.0)
    assert np.allclose(np.linalg.norm(peaks[:, :3] - places, axis=1), 0.75)  # half a thickness beyond the vertices
    assert summit_records(None, 5.0, 0.75).shape == (0, 6)
