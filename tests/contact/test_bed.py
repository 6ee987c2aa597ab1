"""The tool bears plies through the diaphragm: rest, energy, friction, a rising tool."""

import numpy as np
import pytest

from ddf.build.sheets import _bed
from ddf.contact.bed import BED, bear, find_borne, lose

H, STIFFNESS, MASS, AREA = 1.25, 100.0, 3e-8, 4.0


class Node:
    """A ply's node over a flat tool, z = 0 at its face; other impulses as the step gathers them."""

    def __init__(self, height, speed, tilt_deg=0.0):
        t = np.radians(tilt_deg)
        self.normal = np.array([np.sin(t), 0.0, np.cos(t)])
        axis = np.arange(-10.0, 11.0)
        points = np.array(np.meshgrid(axis, axis, axis, indexing="ij"))
        d = np.tensordot(self.normal, points, 1)
        gradient = np.broadcast_to(self.normal[:, None, None, None], points.shape)
        self.field = np.ascontiguousarray(np.stack([d, *gradient], axis=-1).astype(np.float32)), np.full(3, -10.0), 1.0
        self.x = (height * self.normal).reshape(3, 1, 1)
        self.v = (speed * self.normal).reshape(3, 1, 1)
        self.inverse, self.area = np.full((1, 1), 1.0 / MASS), np.full((1, 1), AREA)
        self.sleep, self.borne, self.bed = np.zeros((1, 1), np.int16), np.zeros((1, 1), bool), np.zeros((1, 1, BED))
        self.rise = np.zeros((1, 1))
        self.stored = self.lost = self.rubbed = self.tool_work = self.force = 0.0

    def step(self, dt, load, motion=(0.0, 0.0), keep=1.0, friction=0.0):
        """One step under a load (3,) [N]; returns the load's work."""
        self.look(dt, motion)
        before = keep * self.v[:, 0, 0]
        self.v[:, 0, 0] = before + dt * load / MASS
        f = np.zeros((3, 1, 1))
        _, work, lost, rubbed = bear(self.v, f, self.inverse, self.borne, self.bed, friction, motion, keep, dt, 0, 1)
        self.force = float(f[:, 0, 0] @ self.normal)
        self.tool_work += work
        also = lose(self.v, self.borne, self.bed, motion, dt, 0, 1)
        self.lost += lost + also[0]
        self.rubbed += rubbed + also[1]
        self.x += dt * self.v
        return dt * load @ (0.5 * (before + self.v[:, 0, 0]))

    def look(self, dt, motion=(0.0, 0.0)):
        """Find what bears the node."""
        self.stored, lost, work = find_borne(
            self.x, self.v, self.area, self.inverse, *self.field, (H, STIFFNESS), motion, 1.0, dt,
            self.sleep, self.borne, self.rise, self.bed, 0, 1,
        )  # fmt: skip
        self.lost += lost
        self.tool_work += work

    def kinetic(self):
        return 0.5 * MASS * float((self.v**2).sum())


@pytest.mark.parametrize("tilt", [0.0, 30.0])
def test_a_node_at_rest_is_borne_by_its_load_and_no_more(tilt):
    """Also where dt^2 K A is ten times the mass: what other impulses bring in is part of the implicit step."""
    node, dt = Node(H - 0.01, 0.0, tilt), 2.5e-5
    load = -20.0 * node.normal
    for _ in range(4000):
        node.step(dt, load, keep=0.99)
    assert abs(float(node.v[:, 0, 0] @ node.normal)) < 1e-6
    assert node.force == pytest.approx(20.0, rel=1e-9)
    assert float(node.x[:, 0, 0] @ node.normal) == pytest.approx(H, rel=1e-6)  # the bed has risen


@pytest.mark.parametrize("dt", [2.5e-5, 2.5e-6])
@pytest.mark.parametrize("tilt", [0.0, 30.0])
def test_energy_of_a_node_that_is_thrown_on_is_all_accounted_for(dt, tilt):
    node = Node(H + 0.05, -400.0, tilt)
    begun, done = node.kinetic(), 0.0
    load = -5.0 * node.normal
    for _ in range(int(1e-2 / dt)):
        done += node.step(dt, load)
    node.look(dt)
    balance = begun + done + node.tool_work - node.kinetic() - node.stored - node.lost
    assert abs(balance) < 1e-4 * begun
    assert node.lost > 0.0


def test_friction_holds_up_to_coulombs_limit():
    dt, press = 2.5e-5, 20.0
    for pull, moves in ((0.29, False), (0.31, True)):
        node, done = Node(H, 0.0), 0.0
        node.rise[:] = press / (STIFFNESS * AREA)  # at rest
        for _ in range(20):
            done += node.step(dt, np.array([pull * press, 0.0, -press]), friction=0.3)
        gained = (pull - 0.3) * press * 20 * dt / MASS if moves else 0.0
        assert node.v[0, 0, 0] == pytest.approx(gained, rel=1e-6, abs=1e-9)
        assert node.rubbed == pytest.approx(0.3 * press * node.x[0, 0, 0] if moves else 0.0, rel=0.06, abs=1e-9)
        assert done == pytest.approx(node.kinetic() + node.rubbed, rel=1e-6, abs=1e-9)


def test_a_rising_tool_works_on_what_it_bears():
    node, dt, speed = Node(H, 0.0), 2.5e-5, 300.0
    z, done = 0.0, 0.0
    load = np.array([0.0, 0.0, -20.0])
    for _ in range(400):
        done += node.step(dt, load, motion=(z, speed))
        z += dt * speed
    assert node.v[2, 0, 0] == pytest.approx(speed, rel=1e-3)
    assert node.tool_work == pytest.approx(-done + node.kinetic() + node.stored + node.lost, rel=0.02)
    assert -done == pytest.approx(20.0 * z, rel=0.02)


def test_a_node_far_away_sleeps_and_held_ones_are_left_alone():
    node = Node(H + 5.0, 0.0)
    node.step(1e-6, np.zeros(3))
    assert node.sleep[0, 0] > 0
    held = Node(H - 0.5, 0.0)
    held.inverse[:] = 0.0
    held.step(1e-6, np.zeros(3))
    assert not held.borne.any()


def test_beds_lie_below_where_layers_touch_and_above_one_another():
    skin, fabric = 1.5, 0.5
    touch = [skin + fabric * (k + 0.5) for k in range(4)]
    beds = [_bed([skin] + [fabric] * (k + 1)) for k in range(4)]
    assert beds[0] == pytest.approx(0.5 * skin + 0.5 * 0.5 * (skin + fabric))
    assert beds[0] < beds[1] < touch[0]  # also where the lower ply is missing
    assert all(bed < place for bed, place in zip(beds, touch, strict=True))
    assert beds[2] == beds[3] == 0.0
