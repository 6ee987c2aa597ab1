"""Contact between sheets: gradient of its spring energy, momenta, friction."""

import numpy as np
import pytest
import touching as t
from differences import gradient

from ddf.contact.friction import TANGENTIAL


@pytest.mark.parametrize(
    ("sign", "deeper", "edge"),
    [(1.0, 0.0, False), (-1.0, 0.0, False), (1.0, 0.3, False), (1.0, 0.6, False), (1.0, 0.1, True)],
)
def test_force_is_the_gradient_of_the_spring_energy(sign, deeper, edge):
    xs, xm = t.curved_scene(np.random.default_rng(0))
    xs[2] -= deeper
    if sign < 0:
        xs[2] -= 1.9
    cover = np.clip(np.arange(6.0)[:, None] / 4.0, 0.0, 1.0) * np.ones((6, 7)) if edge else np.ones((6, 7))
    start = t.Layers(xs, xm, 2.5, t.make_pair(sign=sign))
    start.cover = cover
    start.settle(xs, xm, 30)

    def energy(a, b):
        scene = t.Layers(xs, xm, 2.5, start.pair)
        scene.cover = cover
        scene.place, scene.slip = start.place.copy(), start.slip.copy()
        return scene.settle(a, b, 6).out[0]

    fs, fm = start.forces(xs, xm)
    scale = np.abs(fs).max()
    assert (np.abs(fs[2]) > 0).sum() >= 8
    # the push off an edge is taken to the first order in the height above a curved surface
    bound = 2e-3 if edge else 1e-6
    assert np.abs(fs + gradient(lambda y: energy(y, xm), xs, 1e-5)).max() < bound * scale
    assert np.abs(fm + gradient(lambda y: energy(xs, y), xm, 1e-5)).max() < bound * scale


@pytest.mark.parametrize("seed", range(10))
def test_momenta_are_conserved_whatever_happens(seed):
    rng = np.random.default_rng(seed)
    xs, xm = t.curved_scene(rng, 4.0)
    scene = t.Layers(xs, xm, 2.5, t.make_pair(friction=0.5, damping=1e-4))
    scene.settle(xs, xm, 4)
    scene.place[:2] += rng.normal(size=scene.place[:2].shape) * 0.15  # far from converged
    scene.slip += rng.normal(size=scene.slip.shape) * 0.02
    xs = xs + rng.normal(size=xs.shape) * 0.1
    rates = rng.normal(size=xs.shape) * 1e3, rng.normal(size=xm.shape) * 1e3
    fs, fm = scene.forces(xs, xm, dt=1e-5, rates=rates)
    assert (np.abs(fs).max(axis=0) > 0).sum() > 3
    assert scene.out[2] > 0.0
    force, moment, scale, couple = t.resultants((xs, fs), (xm, fm))
    assert np.abs(force).max() < 1e-12 * scale
    assert np.abs(moment).max() < 1e-12 * couple


@pytest.mark.parametrize("seed", range(4))
def test_sticking_contact_gives_back_what_it_stores(seed):
    rng = np.random.default_rng(seed)
    xs, xm = t.curved_scene(rng)
    scene = t.Layers(xs, xm, 2.5, t.make_pair(friction=1e6)).settle(xs, xm, 30)
    dt, work, energy = 1e-6, [0.0], []
    vs, vm = (np.tensordot(rng.normal(size=(3, 3)) * 0.1, x, 1) * 1e2 for x in (xs, xm))
    for step in range(401):
        fs, fm = scene.forces(xs, xm, dt, rates=(vs, vm))
        energy.append(scene.out[0] + scene.out[1])
        work.append(work[-1] - ((fs * vs).sum() + (fm * vm).sum()) * dt * (0.5 if step in (0, 400) else 1.0))
        xs, xm = xs + dt * vs, xm + dt * vm
    assert np.abs(energy[-1] - energy[0]) > 0.05 * energy[0]
    # to the first order in the height above the surface: its change while a slip is held is left out
    assert energy[-1] - energy[0] == pytest.approx(work[-1], rel=0.01, abs=1e-3 * energy[0])


def test_a_master_that_stretches_and_turns_takes_the_slip_along_but_does_not_draw_it_out():
    """Both sheets move as one, stretched by half, sheared and turned: no work, no energy."""
    u, v = np.meshgrid(np.arange(7.0), np.arange(7.0), indexing="ij")
    xm = np.array([2.5 * u, 2.5 * v, 0.0 * u])
    xs = np.ascontiguousarray(np.array([4.0 + 2.0 * u, 3.7 + 2.1 * v, 0.7 + 0.0 * u])[:, :4, :4])
    scene = t.Layers(xs, xm, 2.5, t.make_pair(friction=10.0)).settle(xs, xm)
    still = np.zeros_like(xm)
    for _ in range(10):
        scene.forces(xs, xm, 1e-3, rates=(np.ones_like(xs) * [[[20.0]], [[-9.0]], [[0.0]]], still))
    held = scene.out[1]
    first = scene.forces(xs, xm)[0]
    assert held > 0.1
    for part in np.linspace(0.0, 1.0, 101)[1:]:
        c, s = np.cos(part), np.sin(part)
        way = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ [[1 + 0.5 * part, 0.3 * part, 0], [0, 1, 0], [0, 0, 1]]
        last = scene.forces(np.tensordot(way, xs, 1), np.tensordot(way, xm, 1))[0]
        assert scene.out[1] == pytest.approx(held, rel=1e-9)
    # the force has turned with the master's lines: S_1 by one radian
    turned = np.tensordot([[c, -s, 0], [s, c, 0], [0, 0, 1]], first, 1)
    assert np.abs(last - turned).max() < 1e-6 * np.abs(first).max()


def test_turned_scene_has_turned_forces():
    rng = np.random.default_rng(3)
    xs, xm = t.curved_scene(rng)
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    q *= np.sign(np.linalg.det(q))
    ys, ym = np.tensordot(q, xs, 1), np.tensordot(q, xm, 1)
    plain = t.Layers(xs, xm, 2.5, t.make_pair(friction=0.4, damping=1e-4))
    turned = t.Layers(xs, xm, 2.5, plain.pair)
    plain.settle(xs, xm)
    turned.settle(ys, ym)
    move = rng.normal(size=xs.shape) * 0.01
    rate, still = move / 1e-5, np.zeros_like(xm)
    a, b = plain.forces(xs + move, xm, 1e-5, rates=(rate, still))
    c, d = turned.forces(ys + np.tensordot(q, move, 1), ym, 1e-5, rates=(np.tensordot(q, rate, 1), still))
    assert np.abs(np.tensordot(q, a, 1) - c).max() < 1e-10 * np.abs(a).max()
    assert np.abs(np.tensordot(q, b, 1) - d).max() < 1e-10 * np.abs(a).max()


def test_row_blocks_of_the_slave_do_not_change_forces():
    xs, xm = t.curved_scene(np.random.default_rng(5))
    one, two = (t.Layers(xs, xm, 2.5, t.make_pair(friction=0.4)).settle(xs, xm) for _ in range(2))
    move = np.random.default_rng(6).normal(size=xs.shape) * 0.01
    a, b = one.forces(xs + move, xm), two.forces(xs + move, xm, seam=2)
    assert np.array_equal(a[0], b[0])
    assert np.abs(a[1] - b[1]).max() < 1e-14 * np.abs(a[1]).max()


@pytest.mark.parametrize("dt", [1e-6, 1e-5])
@pytest.mark.parametrize("rate", [0.0, -2e3, 1e3])
def test_a_contact_found_deep_comes_in_slowly_and_its_energy_is_booked(dt, rate):
    """Free nodes half an offset deep in a held master, damped, until they are out; the ledger closes."""
    xm, height, mass = _flat_master(), 0.5, 5e-9
    xs, still = _nodes(height=height), np.zeros_like(xm)
    vs = np.zeros_like(xs) + np.array([0.0, 0.0, rate])[:, None, None]
    scene = t.Layers(xs, xm, 20.0, t.make_pair(damping=1e-5))
    scene.place[3:] = 0.0
    whole = t.Layers(xs, xm, 20.0, scene.pair).settle(xs, xm).forces(xs, xm)[0][2, 0, 0]
    work = lost = fastest = 0.0
    for step in range(round(0.02 / dt)):
        f = scene.forces(xs, xm, dt, rates=(vs, still))[0]
        if step == 0:
            assert 0.0 <= f[2, 0, 0] < (dt / 1e-4 + 4.0 * max(-rate, 0.0) * dt / height) * whole
        lost += scene.out[3]
        work += 0.5 * (f * vs).sum() * dt
        vs = vs + dt * f / mass
        work += 0.5 * (f * vs).sum() * dt
        xs, fastest = xs + dt * vs, max(fastest, vs[2, 0, 0])
    assert xs[2, 0, 0] > 1.0 - 1e-6
    at_once = height**2 + 2.0 * 0.3**2  # energy of a node with all of the penalty from the first step on
    if rate >= 0.0:  # else it goes deeper first
        assert 0.5 * mass * (fastest**2 - rate**2) < 0.1 * at_once
    assert scene.out[0] == pytest.approx(0.0, abs=1e-9)
    # to the first order in the step: the viscous force lags half a step
    assert work + lost == pytest.approx(0.0, abs=0.03 * 0.5 * mass * fastest**2 * xs[0].size), (work, lost)


def test_open_gaps_have_no_force_and_lose_their_slip():
    xs, xm = t.curved_scene(np.random.default_rng(7))
    xs[2] += 1.0
    scene = t.Layers(xs, xm, 2.5, t.make_pair(friction=0.4)).settle(xs, xm, 3)
    scene.slip[:] = 0.1
    fs, fm = scene.forces(xs, xm)
    assert not fs.any()
    assert not fm.any()
    assert not scene.slip.any()


def _flat_master(count=40, spacing=20.0):
    u, v = np.meshgrid(np.arange(count) * spacing, np.arange(5) * spacing, indexing="ij")
    return np.array([u, v, 0.0 * u])


def _nodes(at=40.0, height=0.98):
    u, v = np.meshgrid(at + np.arange(4) * 3.0, 35.0 + np.arange(3) * 3.0, indexing="ij")
    return np.array([u, v, np.full_like(u, height)])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("damping", [0.0, 2e-5])
def test_friction_stays_in_its_cone_and_never_gives_energy(seed, damping):
    rng = np.random.default_rng(seed)
    xm, x = _flat_master(), _nodes()
    mu, mass, dt = 0.45, 1e-9, 1e-5
    scene = t.Layers(x, xm, 20.0, t.make_pair(friction=mu, damping=damping, mass=mass)).settle(x, xm, 3)
    speed = np.zeros_like(x)
    slid = stuck = 0
    damped = 0.0
    for _ in range(400):
        speed = 0.9 * speed + rng.normal(size=x.shape) * np.array([300.0, 300.0, 60.0])[:, None, None]
        speed[2] -= 2.0e3 * (x[2] - 0.98)  # stay about where it touches
        x = x + dt * speed
        fs, _ = scene.forces(x, xm, dt, rates=(speed, np.zeros_like(xm)))
        tangential, normal = np.hypot(fs[0], fs[1]), fs[2]
        assert (normal >= 0.0).all()
        assert (tangential <= mu * normal * (1.0 + 1e-12)).all()
        slid += (tangential > mu * normal * (1.0 - 1e-9))[normal > 0].sum()
        stuck += (tangential < 0.99 * mu * normal).sum()
        assert scene.out[2] >= -1e-15
        # a spring whose contact ends within the step has pushed to its end: 1/2 K A g (g' dt - g) too much
        assert scene.out[3] >= -0.5 * 2.0 * 12 * 0.02 * np.abs(speed).max() * dt
        damped += scene.out[3]
    assert damped >= -1e-15 if damping else damped > -1e-3
    assert slid > 50
    assert stuck > 50


def test_sliding_dissipates_the_friction_forces_work():
    xm, x = _flat_master(), _nodes()
    scene = t.Layers(x, xm, 20.0, t.make_pair(friction=0.3)).settle(x, xm, 3)
    lost, sliding = [], (np.broadcast_to(np.array([1e3, 0.0, 0.0])[:, None, None], x.shape).copy(), np.zeros_like(xm))
    for _ in range(400):
        x = x + np.array([1e-3, 0.0, 0.0])[:, None, None]
        fs, _ = scene.forces(x, xm, rates=sliding)
        lost.append(scene.out[2])
    normal = 2.0 * 0.02 * 12  # K A gap, 12 nodes
    assert -fs[0].sum() == pytest.approx(0.3 * normal, rel=1e-9)
    assert np.sum(lost[200:]) == pytest.approx(0.3 * normal * 0.2, rel=1e-6)


def test_elastic_sticking_dissipates_nothing():
    xm, x = _flat_master(), _nodes()
    scene = t.Layers(x, xm, 20.0, t.make_pair(friction=5.0)).settle(x, xm, 3)
    lost = stored = 0.0
    for k in range(1, 401):  # ten cycles of forty steps, back to the start
        y = x.copy()
        last = 0.01 * np.sin(2.0 * np.pi * (k - 1) / 40)
        y[0] += 0.01 * np.sin(2.0 * np.pi * k / 40)
        rate = np.zeros_like(x)
        rate[0] = (y[0] - x[0] - last) / 1e-6
        scene.forces(y, xm, rates=(rate, np.zeros_like(xm)))
        lost, stored = lost + scene.out[2], max(stored, scene.out[1])
    assert stored == pytest.approx(0.5 * TANGENTIAL * 2.0 * 1e-4 * 12, rel=1e-6)
    assert abs(lost) < 1e-3 * stored


def _slide(degrees, mu, steps=2000):
    """Positions along a rigid incline of loose nodes under gravity, from rest, every step [mm]."""
    a, g, mass = np.deg2rad(degrees), 9810.0, 1e-5
    gravity = g * np.array([np.sin(a), 0.0, -np.cos(a)])  # the scene is turned, not the plane
    x, xm = _nodes(height=1.0 - mass * g * np.cos(a) / 2.0), _flat_master()
    dt = 0.2 * np.sqrt(mass / 2.0) / 2.0
    scene = t.Layers(x, xm, 20.0, t.make_pair(friction=mu, damping=4e-3, mass=mass)).settle(x, xm, 3)
    v, path = np.zeros_like(x), []
    for _ in range(steps):
        fs, _ = scene.forces(x, xm, dt, rates=(v, np.zeros_like(xm)))
        v += dt * (fs / mass + gravity.reshape(3, 1, 1))
        x = x + dt * v
        path.append(x[0].mean() - _nodes()[0].mean())
    return dt, np.array(path), v


@pytest.mark.parametrize(("degrees", "mu"), [(30.0, 0.2), (30.0, 0.0), (40.0, 0.52)])
def test_block_slides_down_an_incline(degrees, mu):
    dt, path, v = _slide(degrees, mu)
    a = np.deg2rad(degrees)
    acceleration = 9810.0 * (np.sin(a) - mu * np.cos(a))
    half = path.size // 2
    measured = (path[-1] - path[half] - (path[half] - path[0])) / (half * dt) ** 2
    assert measured == pytest.approx(acceleration, rel=5e-3)
    assert np.abs(v[1:]).max() < 1e-3 * v[0].max()


def test_block_sticks_under_enough_friction():
    _, path, v = _slide(20.0, 0.8)  # enough for the first swing, twice as far as the rest
    elastic = 1e-5 * 9810.0 * np.sin(np.deg2rad(20.0)) / (2.0 * TANGENTIAL)
    assert path[-1] == pytest.approx(elastic, rel=0.01)
    assert np.abs(v).max() < 0.1


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.52])
@pytest.mark.parametrize("way", [6.0, -6.0])
def test_a_node_that_slides_over_an_edge_takes_its_energy_along(friction, way):
    """Off the edge and onto it, sliding at Coulomb's limit: work done on the contact is stored or lost."""
    u, v = np.meshgrid(np.arange(12) * 4.0, np.arange(8) * 4.0, indexing="ij")
    xm = np.array([u, v, 0.0 * u])
    x = np.array([30.0 - 0.5 * way, 14.3, 0.95]).reshape(3, 1, 1)
    scene = t.Layers(x, xm, 4.0, t.make_pair(friction=friction, stiffness=3.0), area=4.0)
    scene.cover = np.clip(0.5 + (30.0 - xm[0]) / 4.0, -3.0, 3.0)  # from whole to none over a cell
    scene.settle(x, xm, 20)
    dt, steps = 1e-4, 10_000
    before = scene.forces(x, xm, dt)[0]
    first, largest = scene.out[:2].sum(), 0.0
    speed, still = np.array([way / (steps * dt), 0.0, 0.0]).reshape(3, 1, 1), np.zeros_like(xm)
    work = lost = 0.0
    for _ in range(steps):
        x = x + dt * speed
        after = scene.forces(x, xm, dt, rates=(speed, still))[0]
        work -= 0.5 * ((before + after) * speed).sum() * dt
        lost += scene.out[2:].sum()
        largest = max(largest, scene.out[:2].sum())
        before = after
    assert abs(scene.out[:2].sum() - first) > 0.9 * 0.5 * 3.0 * 4.0 * 0.05**2
    assert work - (scene.out[:2].sum() - first) - lost == pytest.approx(0.0, abs=0.02 * largest)
