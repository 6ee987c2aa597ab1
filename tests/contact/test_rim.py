"""Contact on a ply's rim: what rim nodes get goes to those they go on from, without loss of force, moment or energy."""

import numpy as np
import touching as t
from differences import gradient

from ddf.build.rim import RINGS, rim_entries, rim_nodes
from ddf.contact.patch import patch_centres
from ddf.contact.rim import clear_rim, extend, hand_over, with_rim
from ddf.mesh.ply import mesh_ply

CORNER = np.array([[0.0, 0.0], [17.0, 0.0], [17.0, 9.0], [11.0, 15.0], [0.0, 15.0]])


class Cornered:
    """A slave that lies across the edges and a cut corner of a master with a rim."""

    def __init__(self, rng):
        self.ply = mesh_ply(CORNER, [], [], 0.0, 2.5, rings=RINGS)
        self.rim = rim_entries(self.ply.active)
        noise = rng.normal(size=self.ply.x.shape) * 0.05
        self.xm = self.complete(np.where(self.ply.active, self.ply.x + noise, 0.0))
        u, v = np.meshgrid(np.linspace(2.0, 18.0, 7), np.linspace(3.0, 16.0, 6), indexing="ij")
        self.xs = np.array([u, v, 0.94 + 0.03 * rng.normal(size=u.shape)])
        self.scene = t.Layers(self.xs, self.xm, 2.5, t.make_pair(friction=0.3))
        exists = self.ply.active | rim_nodes(self.rim, self.ply.active.shape)
        self.scene.centre = patch_centres(exists)
        self.scene.cover = np.where(exists, 1.0, -3.0)

    def complete(self, x):
        """With the rim in place."""
        return with_rim(x, self.rim)

    def forces(self, scene, xs, xm, **given):
        """Forces on slave and on the master's own nodes."""
        fs, fm = scene.forces(xs, self.complete(xm), **given)
        flat = fm.reshape(3, -1)
        for c in range(3):
            np.add.at(flat[c], self.rim["parent"], self.rim["weight"] * flat[c, self.rim["node"]])
            flat[c, self.rim["node"]] = 0.0
        return fs, fm


def test_forces_on_a_rim_are_the_gradient_of_the_energy():
    case = Cornered(np.random.default_rng(3))
    case.scene.settle(case.xs, case.xm, 30)
    place, slip = case.scene.place.copy(), case.scene.slip.copy()

    def energy(xm):
        scene = t.Layers(case.xs, case.xm, 2.5, case.scene.pair)
        scene.centre, scene.cover, scene.place, scene.slip = case.scene.centre, 1.0, place.copy(), slip.copy()
        return scene.settle(case.xs, case.complete(xm), 6).out[0]

    case.scene.cover = 1.0
    fs, fm = case.forces(case.scene, case.xs, case.xm)
    edge = case.ply.active & ~np.roll(case.ply.active, -1, axis=0)
    assert np.abs(fm[:, edge]).max() > 0.1 * np.abs(fs).max()
    slope = np.where(case.ply.active, gradient(energy, np.where(case.ply.active, case.xm, 0.0), 1e-5), 0.0)
    assert np.abs(fm + slope).max() < 1e-6 * np.abs(fs).max()


def test_forces_and_moments_on_a_rim_balance():
    rng = np.random.default_rng(5)
    case = Cornered(rng)
    case.scene.settle(case.xs, case.xm, 4)
    case.scene.place[:2] += rng.normal(size=case.scene.place[:2].shape) * 0.1
    speeds = rng.normal(size=case.xs.shape) * 1e3, case.complete(rng.normal(size=case.xm.shape) * 1e3)
    fs, fm = case.forces(case.scene, case.xs, case.xm, dt=1e-5, rates=speeds)
    force, moment, scale, couple = t.resultants((case.xs, fs), (case.xm, fm))
    assert np.abs(force).max() < 1e-12 * scale
    assert np.abs(moment).max() < 1e-12 * couple


def test_kernels_do_as_the_formulas():
    rng = np.random.default_rng(7)
    case = Cornered(rng)
    n, m = case.ply.active.shape
    node = 11  # of other sheets in the pools before
    rim, back = case.rim.copy(), np.sort(case.rim, order=("parent", "node"))
    for entries in (rim, back):
        entries["node"] += node
        entries["parent"] += node
    x = rng.normal(size=(3, n, m))
    quads = np.concatenate([np.zeros((node, 4)), np.moveaxis(np.concatenate([x, x[:1]]), 0, -1).reshape(-1, 4)])
    flat = quads.ravel()
    extend(flat, rim, 0, len(rim))
    assert np.allclose(np.moveaxis(flat[4 * node :].reshape(n, m, 4), -1, 0)[:3], case.complete(x), rtol=0, atol=1e-14)
    assert np.array_equal(flat[4 * node :].reshape(n, m, 4)[..., 3], x[0])

    buffer, span = rng.normal(size=(n, m, 4)), np.tile(np.array([1, m - 1]), (n, 1))
    wanted = np.zeros((4, n * m))
    for entry in case.rim:
        if 1 <= entry["node"] % m < m - 1:
            wanted[:, entry["parent"]] += entry["weight"] * buffer.reshape(-1, 4)[entry["node"]]
    f, normal = np.zeros((3, n, m)), np.zeros((n, m))
    hand_over(f, normal, 0.25, buffer, span, back, 0, len(back), node)
    assert np.allclose(f.reshape(3, -1), wanted[:3], rtol=0, atol=1e-13)
    assert np.allclose(normal.ravel(), 0.25 * wanted[3], rtol=0, atol=1e-13)

    f, normal = np.ones((3, n, m)), np.ones((n, m))
    clear_rim(f, normal, rim, 0, len(rim), node)
    there = rim_nodes(case.rim, (n, m))
    assert not f[:, there].any()
    assert not normal[there].any()
    assert (f[:, ~there] == 1.0).all()
    assert (normal[~there] == 1.0).all()
