"""What buckling under tension and on a foundation share: checks, note, picture and table."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ddf.scene import Scene
from ddf.verify.buckling import critical_modes, lowest_of, moving_load
from ddf.verify.problem import Answer, Check, Curve, Figure

LOAD_BOUND, LENGTH_BOUND = 0.02, 0.03
MODES = 4
AROUND = np.linspace(0.6, 1.6, 80)


def wrinkling_answer(
    scenes: Sequence[tuple[float, Scene]], k: int, length: float, rigidity: float, foundation: float, mass: float
) -> Answer:
    """Critical load and wavelength of sheet k, `length` long, in a coarse and a fine scene (with element sizes [mm]).

    A deflection with wave number q along y meets N q^2 = B q^4 + K: so N_cr = 2 sqrt(B K), lambda =
    2 pi (B/K)^(1/4); B rigidity [N mm], K foundation [N/mm3], mass areal [tonne/mm2].
    """
    load, wavelength = 2.0 * math.sqrt(rigidity * foundation), 2.0 * math.pi * (rigidity / foundation) ** 0.25
    found = [critical_modes(scene, load, MODES, k) for _, scene in scenes]
    lowest = [lowest_of(modes, length) for modes in found]
    element, scene = scenes[-1]
    first = int(np.argmin(found[-1].load))
    q2 = (math.pi * found[-1].half_waves[first] / length) ** 2
    expected = rigidity * q2 + foundation / q2
    omega = math.sqrt((rigidity * q2**2 + foundation) / mass)
    squares, moved = moving_load(scene, found[-1].shape[first], omega, expected, k)
    waves = f"{found[-1].half_waves[first]:g} half-waves"
    checks = (
        Check("critical load, stiffness", "N/mm", load, lowest[-1][0], LOAD_BOUND),
        Check("wavelength, stiffness", "mm", wavelength, lowest[-1][1], LENGTH_BOUND),
        Check(f"critical load of {waves}, motion", "N/mm", expected, moved, LOAD_BOUND),
    )
    sizes = [size for size, _ in scenes]
    errors = [abs(pair[1] / wavelength - 1.0) for pair in lowest]
    order = math.log(errors[0] / errors[1]) / math.log(sizes[0] / sizes[1])
    note = (
        f"wavelength: error {errors[0]:.1e} at {sizes[0]:g} mm, {errors[1]:.1e} at {sizes[1]:g} mm: "
        f"observed order {order:.2f}"
    )
    lengths = 2.0 * length / found[-1].half_waves
    line = wavelength * AROUND
    wave = (2.0 * math.pi / line) ** 2
    curves = (
        Curve("N = B q^2 + K / q^2", line, rigidity * wave + foundation / wave),
        Curve("modes of ddf", lengths, found[-1].load, points=True),
        Curve("motion of ddf", lengths[[first]], np.array([moved]), points=True),
    )
    table = {"half_waves": found[-1].half_waves, "wavelength_mm": lengths, "load_N_mm": found[-1].load}
    return Answer(checks, Figure("wavelength [mm]", "load [N/mm]", curves), table, (note,))
