"""Small contact scenes and calls of the contact kernels."""

from __future__ import annotations

import numpy as np

from ddf.contact.layers import NOWHERE, UNKNOWN, chunk_scratch, layer_forces, touched
from ddf.contact.patch import patch_centres
from ddf.contact.tool import POINTS, point_scratch, tool_forces
from ddf.contact.tool_point import FREE, PRESS
from ddf.model import PAIR


def make_pair(**values):
    pair = np.zeros(1, PAIR)
    defaults = {"sign": 1.0, "offset": 1.0, "stiffness": 2.0, "damping": 0.0, "friction": 0.0, "mass": 1e-9}
    for key, value in (defaults | values).items():
        pair[key] = value
    return pair[0]


def packed(x, cover=1.0):
    """Positions (3, n, m) as contact wants a master's: (n, m, 4), the last component its cover."""
    return np.ascontiguousarray(np.moveaxis(np.concatenate([x, np.broadcast_to(cover, (1, *x.shape[1:]))]), 0, -1))


class Layers:
    """Slave nodes on a master sheet; places and slips are kept between calls."""

    def __init__(self, xs, xm, spacing, pair, area=1.0):
        self.pair = pair
        self.shape, self.master = xs.shape[1:], xm.shape[1:]
        self.area = np.full(self.shape, area)
        self.cover: float | np.ndarray = 1.0
        self.centre = patch_centres(np.ones(self.master, bool))
        origin = xm[:2, 0, 0].reshape(2, 1, 1)
        start = (xs[:2] - origin) / spacing
        unknown = np.full((1, *self.shape), UNKNOWN)
        self.place = np.concatenate([start, unknown, np.zeros((2, *self.shape))])
        self.slip = np.zeros((2, *self.shape))
        self.out = np.zeros(4)

    def settle(self, xs, xm, rounds=12):
        """Converge the projection; springs are unstretched there, and nodes at rest. Long steps: depths are whole."""
        for _ in range(rounds):
            self.forces(xs, xm, 1.0)
            self.slip[:] = 0.0
        return self

    def forces(self, xs, xm, dt=1e-6, seam=None, rates=None):
        """Forces on slave and master; `out` has the energies of this call. rates: velocities of both, else at rest."""
        vs, vm = (np.zeros_like(xs), np.zeros_like(xm)) if rates is None else rates
        fs, fm = np.zeros_like(xs), np.zeros_like(xm)
        self.out = np.zeros(4)
        n = self.shape[0]
        for low, high in ((0, n),) if seam is None else ((0, seam), (seam, n)):
            buffer, span = np.zeros((*self.master, 4)), np.tile(np.array([NOWHERE, 0]), (self.master[0], 1))
            rest = np.zeros(self.shape, np.int8)
            scratch = tuple(part[0] for part in chunk_scratch(1))
            layer_forces(
                xs, vs, fs, np.zeros(self.shape), self.area, packed(xm, self.cover), packed(vm, 0.0), self.centre,
                self.place, self.slip, rest,
                buffer, span, self.pair, 1e6, dt, low, high, scratch, self.out,
            )  # fmt: skip
            for i in range(self.master[0]):
                first, end = touched(span, i)
                outside = np.ones(self.master[1], bool)
                outside[min(first, self.master[1]) : end] = False
                assert not buffer[i, outside].any(), "forces beyond the noted columns"
            fm += np.moveaxis(buffer[..., :3], -1, 0)
        return fs, fm


def curved_scene(rng, noise=1.0):
    """A slave patch pressed some hundredths of a millimetre into a curved master; spacing 2.5."""
    u, v = np.meshgrid(np.arange(6) * 2.5, np.arange(7) * 2.5, indexing="ij")
    xm = np.array([u, v, 0.01 * u**2]) + rng.normal(size=(3, 6, 7)) * 0.05 * noise
    u, v = np.meshgrid(3 + np.arange(5) * 1.3, 3 + np.arange(5) * 1.7, indexing="ij")
    xs = np.array([u, v, 0.01 * u**2 + 0.95]) + rng.normal(size=(3, 5, 5)) * 0.02 * noise
    return xs, xm


def resultants(*pairs):
    """Force and moment of (x, f) pairs, and their scales."""
    force, moment, scale, lever = np.zeros(3), np.zeros(3), 0.0, 0.0
    for x, f in pairs:
        x, f = x.reshape(3, -1).T, f.reshape(3, -1).T
        force, moment = force + f.sum(axis=0), moment + np.cross(x, f).sum(axis=0)
        scale, lever = scale + np.abs(f).sum(), max(lever, np.abs(x).max())
    return force, moment, scale, scale * lever


class Tool:
    """A sheet of cells over a tool that is given by its distance function on a grid."""

    def __init__(self, distance, cells, *, stiffness=10.0, damping=0.0, friction=0.0, size=60.0):
        self.spacing, self.origin = 1.0, np.array([-0.5 * size, -0.5 * size, -0.5 * size])
        axis = self.origin[0] + np.arange(int(size) + 1) * self.spacing
        points = np.array(np.meshgrid(axis, axis, axis, indexing="ij"))
        d, gradient = distance(points)
        self.values = np.ascontiguousarray(np.stack([d, *gradient], axis=-1).astype(np.float32))
        self.law = (0.75, stiffness, damping, friction)
        self.dx, self.dy = (np.asarray(a, dtype=float) for a in cells)
        self.anchors = np.full((POINTS, 3, self.dx.size + 1, self.dy.size + 1), FREE)
        x, y = (0.5 * (np.pad(d, (1, 0)) + np.pad(d, (0, 1))) for d in (self.dx, self.dy))
        self.area = x[:, None] * y[None, :]
        self.out, self.work = np.zeros(4), 0.0

    def forces(self, x, v=None, *, others=None, mass=None, z=0.0, speed=0.0, dt=1e-6, seam=None):
        """The tool's forces; others: all other forces on nodes, mass (n, m); without them nodes go on as they do."""
        n, m = x.shape[1:]
        others = np.zeros_like(x) if others is None else others
        inverse = np.zeros((n, m)) if mass is None else np.where(mass > 0.0, 1.0 / np.where(mass > 0.0, mass, 1.0), 0.0)
        v = np.zeros_like(x) if v is None else v
        self.out, self.work = np.zeros(4), 0.0
        self.press, pressed = np.zeros((n, m, PRESS)), np.zeros(n, bool)
        sleep, scratch = np.zeros((n, m), np.int16), tuple(part[0] for part in point_scratch(1, m))
        for low, high in ((0, n),) if seam is None else ((0, seam), (seam, n)):
            carry = np.zeros((m + 2, PRESS))
            work, _ = tool_forces(
                x, v, others, packed(x).reshape(-1), packed(v, 0.0).reshape(-1), inverse, self.press, pressed, carry,
                self.area, self.dx, self.dy, self.values, self.origin, self.spacing, self.law,
                (False, np.zeros(4)), (z, speed), 1e6, dt, self.anchors, sleep, low, high, self.out, scratch,
            )  # fmt: skip
            self.work += work
            if high < n:
                self.press[high] += carry[:m]
        return np.moveaxis(self.press[..., :3], -1, 0).copy()


def inclined_plane(degrees):
    """Distance from a plane through the origin that falls towards +x."""
    t = np.deg2rad(degrees)
    normal = np.array([np.sin(t), 0.0, np.cos(t)])

    def distance(points):
        return np.tensordot(normal, points, 1), np.broadcast_to(normal.reshape(3, 1, 1, 1), points.shape)

    return distance, normal
