"""Buckling of a flat ply compressed along y between supports: critical loads by stiffness and by motion.

Under a load N per width along y the stiffness against small deflections w is K(N) = K0 - N G. Critical are

    K0 phi = N G phi                                  by the tangent of the step's own forces at two loads
    omega^2(N) = 0,  omega^2 = omega0^2 (1 - N/N_cr)  by the motion that starts in the shape phi, solved by the step

omega^2 comes from three amplitudes q of the shape at equal times: q1 + q3 = 2 q2 cos(omega tau), cosh beyond N_cr.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import eigsh

from ddf.model import sheet_scalars
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.verify.probe import Probe
from ddf.verify.problem import FloatArray
from ddf.verify.scenes import copied_state, march, positions

AMPLITUDE_MM = 1e-6
SHARE = 0.5  # of 1/omega0 between two looks at the amplitude
LOADS = np.array([0.0, 0.4, 0.8, 1.2])  # over the expected critical load


class Modes(NamedTuple):
    """Lowest critical loads [N/mm] with their half-waves along y, and shapes (rows, cols) of unit height."""

    load: FloatArray
    half_waves: FloatArray
    shape: list[FloatArray]


def squeezed(scene: Scene, load: float, k: int = 0) -> Scene:
    """The scene in a state of its own with sheet k evenly compressed along y by a load [N/mm] in its fibres."""
    stretch, stiff = 1.0, float(scene.model.sheets[k]["eh2"])
    for _ in range(5):
        stretch = float(np.exp(-load * stretch / stiff))
    loaded = replace(scene, state=copied_state(scene.state))
    positions(loaded, k)[1] *= stretch
    return loaded


def critical_modes(scene: Scene, load: float, count: int, k: int = 0) -> Modes:
    """The `count` lowest modes of sheet k, from the tangents unloaded and at a load near the critical one [N/mm]."""
    free = sheet_scalars(scene.model, scene.model.inverse_mass, k) > 0.0
    inner = np.flatnonzero(free)
    stiff = []
    for now in (0.0, load):
        loaded = squeezed(scene, now, k)
        stiff.append(csc_array(Probe(loaded, k).stiffness(positions(loaded, k), (2,)))[inner][:, inner])
    loads, vectors = eigsh(stiff[0], count, (stiff[0] - stiff[1]) / load, sigma=0.0, v0=np.ones(inner.size))
    shapes, half_waves = [], []
    for vector in vectors.T:
        shape = np.zeros(free.shape)
        shape[free] = vector / np.abs(vector).max()
        row = shape[np.abs(shape).max(axis=1).argmax()]
        order = np.arange(row.size)
        waves = np.abs(np.sin(np.pi * np.outer(order[1:-1], order) / (row.size - 1)) @ row)
        shapes.append(shape)
        half_waves.append(1 + int(np.argmax(waves)))
    return Modes(np.asarray(loads), np.array(half_waves, float), shapes)


def moving_load(scene: Scene, shape: FloatArray, omega: float, load: float, k: int = 0) -> tuple[FloatArray, float]:
    """omega^2 [1/s2] at LOADS times `load`, from motion in a shape of frequency omega [1/s] unloaded; where it is 0.

    The critical load [N/mm] is that of the line through these points.
    """
    squares = []
    for share in LOADS:
        now = squeezed(scene, share * load, k)
        x = positions(now, k)
        flat = x[2].copy()
        x[2] += AMPLITUDE_MM * shape
        weight = shape * sheet_scalars(now.model, now.model.mass, k)
        sim, q = Simulation(now), []
        steps = max(1, round(SHARE / (omega * now.model.dt)))
        for _ in range(3):
            march(sim, steps)
            q.append(np.sum(weight * (x[2] - flat)))
        cosine = 0.5 * (q[0] + q[2]) / q[1]
        angle = np.arccos(cosine) if cosine <= 1.0 else 1j * np.arccosh(cosine)
        squares.append(float(np.real((angle / (steps * now.model.dt)) ** 2)))
    slope, start = np.polyfit(LOADS * load, squares, 1)
    return np.array(squares), float(-start / slope)


def lowest_of(modes: Modes, length: float) -> tuple[float, float]:
    """Critical load [N/mm] and wavelength [mm] between whole half-waves: N = B k^2 + K / k^2 through the modes."""
    k2 = (np.pi * modes.half_waves / length) ** 2
    (b, foundation), *_ = np.linalg.lstsq(np.column_stack([k2, 1.0 / k2]), modes.load, rcond=None)
    return float(2.0 * np.sqrt(b * foundation)), float(2.0 * np.pi * (b / foundation) ** 0.25)
