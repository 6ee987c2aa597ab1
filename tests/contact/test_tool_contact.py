"""Contact with the rigid tool and its platform."""

import numpy as np
import pytest
import touching as t
from differences import gradient

from ddf.contact.tool import settle_row
from ddf.contact.tool_point import FREE

DX, DY = [1.5, 2.0, 2.5, 1.7], [2.0, 1.4, 2.2]


def _sheet(rng, height):
    lines = [np.concatenate([[0.0], np.cumsum(d)]) - 3.0 for d in (DX, DY)]
    u, v = np.meshgrid(*lines, indexing="ij")
    return np.array([u, v, np.full_like(u, height)]) + rng.normal(size=(3, *u.shape)) * 0.1


def _sphere(points):
    r = points - np.array([0.0, 0.0, -15.0]).reshape(3, 1, 1, 1)
    size = np.sqrt((r * r).sum(axis=0)) + 1e-12
    return size - 20.0, r / size


def test_force_is_the_gradient_of_the_penalty_energy_on_a_plane():
    distance, normal = t.inclined_plane(25.0)
    tool = t.Tool(distance, (DX, DY))
    x = _sheet(np.random.default_rng(0), 0.0)
    z = -6.0
    x[0] -= 12.0  # high above the platform: only the plane is met
    x[2] += 0.3 - np.tan(np.deg2rad(25.0)) * x[0] + z
    f = tool.forces(x, z=z, seam=2)
    assert (np.abs(f[2]) > 0).all()
    expected = -gradient(lambda y: (tool.forces(y, z=z), tool.out[0])[1], x)
    away = tool.forces(x, z=z)
    # the field is in single precision: relative 1e-5
    assert np.abs(away - expected).max() < 1e-5 * np.abs(expected).max()
    assert np.allclose(np.cross(f.sum(axis=(1, 2)), normal), 0.0, atol=1e-5 * np.abs(f).sum())


def test_force_is_the_gradient_on_the_platform_and_in_the_corner():
    distance, _ = t.inclined_plane(60.0)
    tool = t.Tool(distance, (DX, DY))
    x = _sheet(np.random.default_rng(1), 0.3)
    x[0] += 2.5
    f = tool.forces(x)
    energy = tool.out[0]
    assert f[0].sum() > 0.1 * f[2].sum()  # the plane pushes as well
    assert energy > 0.0
    expected = -gradient(lambda y: (tool.forces(y), tool.out[0])[1], x)
    assert np.abs(f - expected).max() < 1e-5 * np.abs(expected).max()


def test_force_on_a_sphere_is_nearly_the_gradient():
    tool = t.Tool(_sphere, (DX, DY))
    x = _sheet(np.random.default_rng(2), 5.3)
    f = tool.forces(x, z=-0.0)
    expected = -gradient(lambda y: (tool.forces(y), tool.out[0])[1], x)
    assert np.abs(f - expected).max() < 0.05 * np.abs(expected).max()  # h^2 k of the 1 mm grid


def test_row_blocks_do_not_change_a_force():
    rng = np.random.default_rng(3)
    x, v = _sheet(rng, 0.2), rng.normal(size=(3, 5, 4)) * 100.0
    one, two = (t.Tool(_sphere, (DX, DY), damping=1e-5, friction=0.3) for _ in range(2))
    a, b = one.forces(x, v, z=-5.0), two.forces(x, v, z=-5.0, seam=2)
    assert np.abs(a).max() > 0.0
    assert np.abs(a - b).max() < 1e-14 * np.abs(a).max()
    assert one.out == pytest.approx(two.out, rel=1e-12)


def test_work_is_force_times_the_tools_way():
    x = _sheet(np.random.default_rng(4), 5.2)
    tool = t.Tool(_sphere, (DX, DY))
    f = tool.forces(x, speed=800.0, dt=1e-5)
    assert tool.work == pytest.approx(f[2].sum() * 800.0 * 1e-5, rel=1e-12)


def test_friction_stays_in_its_cone_and_never_gives_energy():
    rng = np.random.default_rng(5)
    distance, normal = t.inclined_plane(0.0)
    x, dt = _sheet(rng, 0.7) * 1.0, 1e-5
    x[2] = 0.7
    tool = t.Tool(distance, ([3.0], [3.0]), friction=0.3, damping=1e-4)
    x = x[:, :2, :2].copy()
    v = np.zeros_like(x)
    slid = 0
    for _ in range(600):
        v = 0.9 * v + rng.normal(size=x.shape) * np.array([200.0, 200.0, 30.0])[:, None, None]
        v[2] -= 2e3 * (x[2] - 0.7)
        x = x + dt * v
        f = tool.forces(x, v, dt=dt)
        assert (f[2] >= 0.0).all()
        assert (np.hypot(f[0], f[1]) <= 0.3 * f[2] * (1.0 + 1e-9) + 1e-15).all()
        slid += np.count_nonzero((np.hypot(f[0], f[1]) > 0.29 * f[2]) & (f[2] > 0.0))
        assert tool.out[2] >= -1e-12
    assert slid > 20


def _slide(degrees, mu, steps=3000):
    distance, normal = t.inclined_plane(degrees)
    mass, g, dt = 1e-5, 9810.0, 1e-4  # a block of 1 mm2 and its weight
    tool = t.Tool(distance, ([2.0], [2.0]), friction=mu, damping=5e-3, stiffness=10.0)
    u, v = np.meshgrid([-20.0, -18.0], [-1.0, 1.0], indexing="ij")
    down = np.array([normal[2], 0.0, -normal[0]])
    sink = 0.75 - mass * g * normal[2] / 10.0
    x = u * down.reshape(3, 1, 1) + sink * normal.reshape(3, 1, 1)
    x[1] = v
    z = -100.0
    x[2] += z
    speed, path, start = np.zeros_like(x), [], x.mean(axis=(1, 2))
    while len(path) < steps and x[0].mean() < -3.0:
        f = tool.forces(x, speed, z=z, dt=dt)
        speed += dt * (f / mass - np.array([0.0, 0.0, g]).reshape(3, 1, 1))
        x = x + dt * speed
        path.append((x.mean(axis=(1, 2)) - start) @ down)
    return dt, np.array(path), speed, normal


@pytest.mark.parametrize(("degrees", "mu"), [(35.0, 0.3), (35.0, 0.0)])
def test_block_slides_down_the_tool(degrees, mu):
    dt, path, _, _ = _slide(degrees, mu)
    a, half = np.deg2rad(degrees), path.size // 2
    measured = (path[2 * half - 1] - path[half] - (path[half] - path[1])) / (half * (half - 1) * dt**2)
    assert path.size > 100
    assert measured == pytest.approx(9810.0 * (np.sin(a) - mu * np.cos(a)), rel=0.02)


def test_block_sticks_on_the_tool():
    _, path, speed, _ = _slide(20.0, 0.5)
    assert np.abs(path).max() < 0.05
    assert abs(path[-1] - path[-500]) < 1e-6
    assert np.abs(speed).max() < 0.01


def test_implicit_step_solves_its_equation_and_books_what_it_takes():
    rng = np.random.default_rng(8)
    tool = t.Tool(_sphere, (DX, DY), damping=1e-5, friction=0.3, stiffness=200.0)
    x, v, dt, speed = _sheet(rng, 5.2), rng.normal(size=(3, 5, 4)) * 100.0, 1e-5, 300.0
    others = rng.normal(size=x.shape) * 0.1
    mass = rng.uniform(1e-9, 4e-9, x.shape[1:])
    mass[2, 1] = 0.0  # held
    touch = tool.forces(x, v, others=others, mass=mass, speed=speed, dt=dt)
    press = np.moveaxis(tool.press, -1, 0)
    viscous, tensor = press[9:].copy(), press[[3, 6, 7, 6, 4, 8, 7, 8, 5]].reshape(3, 3, *mass.shape)
    assert tensor[0, 0].max() > mass.max()  # far beyond what an explicit step could do
    total, work, lost = touch + others, 0.0, 0.0
    settled = others.copy()
    for i in range(x.shape[1]):
        done, gone = settle_row(v[:, i], settled[:, i], np.zeros(4), 1.0, tool.press[i], mass[i], speed, 1.0, dt)
        work, lost = work + done, lost + gone
    assert not tool.press.any()
    expected_lost = expected_work = 0.0
    for i, j in np.ndindex(mass.shape):
        if mass[i, j] == 0.0:
            assert np.array_equal(settled[:, i, j], others[:, i, j])
            continue
        a = np.linalg.solve(mass[i, j] * np.eye(3) + tensor[:, :, i, j], total[:, i, j])
        assert settled[:, i, j] == pytest.approx(mass[i, j] * a, rel=1e-9, abs=1e-15)
        taken = settled[:, i, j] - total[:, i, j]
        relative = v[:, i, j] + 0.5 * dt * a - np.array([0.0, 0.0, speed])
        if tensor[:, :, i, j].any():
            expected_lost -= dt * (taken + viscous[:, i, j]) @ relative
            expected_work += dt * taken[2] * speed
    assert lost == pytest.approx(expected_lost, rel=1e-9)
    assert work == pytest.approx(expected_work, rel=1e-9)


def test_a_node_pressed_on_the_platform_stays_there_however_stiff_it_is():
    """A free node under a pressure settles at once at depth p / K, and never leaves (dt^2 K/m up to 1000)."""
    for stiffness in (1.0, 10.0, 1000.0):
        mass, dt, pressure = np.full((2, 2), 1e-9), 3e-5, 0.1
        tool = t.Tool(t.inclined_plane(0.0)[0], ([2.0], [2.0]), stiffness=stiffness, damping=0.0)
        x = np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [-1.0, 1.0]], [[0.8, 0.8], [0.8, 0.8]]])
        v, others = np.zeros_like(x), np.zeros_like(x)
        others[2] = -pressure
        touched = False
        for _ in range(400):
            tool.forces(x, v, others=others, mass=mass, dt=dt, z=-0.0)
            f = others.copy()
            for i in range(2):
                settle_row(v[:, i], f[:, i], np.zeros(2), 1.0, tool.press[i], mass[i], 0.0, 1.0, dt)
            v += dt * f / mass
            x = x + dt * v
            touched = touched or bool((x[2] < 0.75).any())
            assert not touched or (x[2] < 0.75 + 1e-9).all()
        assert np.abs(v).max() < 1e-6
        # of 4 mm2 on the platform and 4 on the plane each corner has a quarter
        assert x[2] == pytest.approx(np.full((2, 2), 0.75 - pressure / (2.0 * stiffness)), abs=1e-6)


def test_a_cell_that_falls_is_stopped_in_the_step_in_which_it_would_touch():
    """From 5 m/s, 0.15 mm a step: found inside only then it would be up to so deep, and come out as fast."""
    mass, dt = np.full((2, 2), 4.1e-9), 3e-5
    tool = t.Tool(t.inclined_plane(0.0)[0], ([2.0], [2.0]), stiffness=40.0, friction=0.5)
    deepest, held = 0.0, []
    for height in np.linspace(0.76, 0.9, 15):
        x = np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [-1.0, 1.0]], np.full((2, 2), height)])
        v = np.zeros_like(x)
        v[2], v[0] = -5000.0, 500.0
        tool.anchors[:] = FREE
        for _ in range(20):
            tool.forces(x, v, mass=mass, dt=dt)
            f = np.zeros_like(x)
            for i in range(2):
                settle_row(v[:, i], f[:, i], np.zeros(2), 1.0, tool.press[i], mass[i], 0.0, 1.0, dt)
            v += dt * f / mass
            x = x + dt * v
            deepest = max(deepest, 0.75 - x[2].min())
            held.append(v[0].max() < 500.0 or (x[2] > 0.75).all())
    assert 0.0 < deepest < 0.015  # a tenth of the way of a step
    assert all(held)  # friction acts from the same step on
    assert np.abs(v[2]).max() < 500.0  # of the rebound, from what it was inside


@pytest.mark.parametrize("sideways", [0.0, 3000.0])
@pytest.mark.parametrize("height", [0.9, 0.95, 1.0, 1.05])
def test_energy_closes_when_a_cell_is_thrown_on_the_tool(height, sideways):
    """At 5 m/s and dt^2 K/m of 9, uneven, so that points touch, let go and touch again within steps."""
    mass, dt, pressure = np.full((2, 2), 4.1e-9), 3e-5, 0.1
    tool = t.Tool(t.inclined_plane(0.0)[0], ([2.0], [2.0]), stiffness=40.0, damping=3e-5, friction=0.3)
    x = np.array([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [-1.0, 1.0]], [[height, height], [height, height]]])
    v, others = np.zeros_like(x), np.zeros_like(x)
    v[2], v[0], others[2] = -5000.0, sideways, -pressure
    v[2, 0] *= 0.5
    start, work, lost = 0.5 * (mass * v * v).sum(), 0.0, 0.0
    for _ in range(300):
        tool.forces(x, v, others=others, mass=mass, dt=dt)
        f = others.copy()
        for i in range(2):
            lost += settle_row(v[:, i], f[:, i], np.zeros(2), 1.0, tool.press[i], mass[i], 0.0, 1.0, dt)[1]
        lost += tool.out[2] + tool.out[3]
        middle = v + 0.5 * dt * f / mass
        work += dt * (others * middle).sum()
        v += dt * f / mass
        x = x + dt * v
    assert np.abs(v).max() < 1.0
    kept = 0.5 * (mass * v * v).sum() + tool.out[0] + tool.out[1]
    assert start + work == pytest.approx(lost + kept, rel=1e-4)
    assert lost > 0.9 * start


def test_points_of_a_stretched_diaphragm_stand_for_what_is_clamped(make_scene):
    """The tool meets the sheet as it is clamped: areas with the pre-stretch, as of all else that touches it."""
    model = make_scene(
        "hemisphere", "diaphragms.pre_stretch=1.2", "diaphragms.element_mm=10", "solver.symmetry=off"
    ).model
    sheet = model.sheets[model.tool_sheet]
    first, n, m = int(sheet["line"]), int(sheet["rows"]), int(sheet["cols"])
    dx, dy = (model.tool_lines[first:][a:b] for a, b in ((0, n - 1), (n - 1, n + m - 2)))
    node = int(sheet["node"])
    assert model.area[node : node + n * m].sum() == pytest.approx(dx.sum() * dy.sum(), rel=1e-12)
    assert model.tool_lines == pytest.approx(1.2 * model.lines, rel=1e-12)
