"""Bias extension of a net of inextensible fibres pinned to each other: its least energy, whatever its zones.

With u, v the lengths along both families the tangents x_u = e(a), x_v = e(b) have to agree, x_uv = x_vu: so the
direction a depends on u only, b on v only. A strip symmetric about its middle has one unknown function, the turn
t(u) of a family towards the load, and a cell (u, v) is sheared by g = t(u) + t(v). Fibres that start at a grip do not
turn there: t = 0 over the W / sqrt 2 of u next to each grip. In between

    minimise U = int int W_s(t(u) + t(v)) du dv over the strip |u - v| < W / sqrt 2
    with 2 int sin(45 deg + t(u)) du = H + d;      F = dU/dd is the multiplier of the constraint

One value of t all over gives the usual zones (no shear, g/2, g) and formula. That is not the least energy of a law
that stiffens: near the ends a fibre line crosses cells of half the shear, is cheaper to turn and turns further, so the
middle shears less than the usual kinematics say.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ddf.errors import DdfError
from ddf.verify.problem import FloatArray


class Net(NamedTuple):
    """A strip of width W, its free length D = H - W between the grips' triangles cut into lines."""

    inside: FloatArray  # (lines, lines) area of cell (u, v), both free, that is in the strip [mm2]
    beside: FloatArray  # (lines,) area of the cells of line u whose other line is next to a grip [mm2]
    piece: float  # length of a line's piece along the fibre [mm]


def make_net(width: float, height: float, lines: int = 96) -> Net:
    """Areas by 8 x 8 points a cell."""
    free, reach, points = (height - width) / np.sqrt(2.0), width / np.sqrt(2.0), 8
    piece = free / lines
    at = (np.arange(lines * points) + 0.5) * piece / points
    near = np.abs(at[:, None] - at[None, :]) < reach
    inside = near.reshape(lines, points, lines, points).mean(axis=(1, 3)) * piece**2
    length = np.clip(reach - at, 0.0, None) + np.clip(reach - (free - at), 0.0, None)
    return Net(inside, length.reshape(lines, points).mean(axis=1) * piece, piece)


def least_energy(net: Net, way: float, law: tuple[FloatArray, FloatArray], start: float) -> tuple[FloatArray, float]:
    """Turns t (lines,) [rad] of least energy at a way of the grips [mm], and the force F [N].

    law: N_s [N/mm] over angles [rad], with N_s cos g rising; start: a turn to start from. Newton's steps on
    dU/dt = F d(way)/dt and the way, halved while they make these worse.
    """
    angle, force = law
    moment = force * np.cos(angle)
    tangent = np.gradient(moment, angle)
    lines = net.beside.size

    def residual(y: FloatArray) -> tuple[FloatArray, FloatArray]:
        t, pull = y[:-1], y[-1]
        g = t[:, None] + t[None, :]
        full, half = np.sign(g) * np.interp(np.abs(g), angle, moment), np.sign(t) * np.interp(np.abs(t), angle, moment)
        lever = 2.0 * net.piece * np.cos(0.25 * np.pi + t)
        slope = 2.0 * (net.inside * full).sum(axis=1) + 2.0 * net.beside * half - pull * lever
        gap = 2.0 * net.piece * np.sum(np.sin(0.25 * np.pi + t) - np.sqrt(0.5)) - way
        stiff = 2.0 * net.inside * np.interp(np.abs(g), angle, tangent)
        own = 2.0 * net.beside * np.interp(np.abs(t), angle, tangent) + 2.0 * pull * net.piece * np.sin(
            0.25 * np.pi + t
        )
        matrix = np.zeros((lines + 1, lines + 1))
        matrix[:-1, :-1] = stiff + np.diag(stiff.sum(axis=1) + own)
        matrix[:-1, -1] = -lever
        matrix[-1, :-1] = lever
        return np.append(slope, gap), matrix

    y = np.append(np.full(lines, start), 1.0)
    value, matrix = residual(y)
    for _ in range(200):
        move = np.linalg.solve(matrix, -value)
        share = 1.0
        while True:
            ahead, ahead_matrix = residual(y + share * move)
            if np.linalg.norm(ahead) < np.linalg.norm(value) or share < 1e-3:
                break
            share *= 0.5
        y, value, matrix = y + share * move, ahead, ahead_matrix
        if np.abs(share * move[:-1]).max() < 1e-6:
            return y[:-1], float(y[-1])
    raise DdfError(f"no least energy of the net found at {way:g} mm")


def mean_shear(net: Net, t: FloatArray, radius: float) -> float:
    """Mean shear angle [rad] of the cells whose middle is within a radius [mm] of the strip's."""
    at = (np.arange(t.size) + 0.5 - 0.5 * t.size) * net.piece
    near = np.hypot(at[:, None], at[None, :]) < radius
    return float((t[:, None] + t[None, :])[near].mean())
