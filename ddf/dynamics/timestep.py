"""Stable steps from bounds on the eigenvalues of each sheet's forces over mass.

All bounds are per area: a sheet of areal mass m with several stiffnesses has omega^2 <= the sum of theirs.
Explicit steps with damping that lags half a step are stable for  omega dt <= 2 (sqrt(1 + z^2) - z),  z the
damping ratio at omega. Fibre tension and the contact with the tool are integrated implicitly and set no limit.
"""

from __future__ import annotations

import numpy as np


def damped_limit(omega: float, ratio: float) -> float:
    """Largest stable step [s] at angular frequency omega [1/s] with damping ratio `ratio` there."""
    return 2.0 / omega * (np.sqrt(1.0 + ratio * ratio) - ratio)


def ply_omega2(
    shear: float, bend: tuple[float, float], spacing: tuple[float, float], contact: float, mass: float
) -> float:
    """Bound of omega^2 of a ply's explicit forces.

    Shear 4 N_s' (1/a1^2 + 1/a2^2)/m; bending 16 (D1/a1^4 + D2/a2^4)/m; contact 2 K/m with K the sum of the
    contact stiffnesses [N/mm3] on its two faces.
    """
    a1, a2 = spacing
    stretch = 4.0 * shear * (1 / a1**2 + 1 / a2**2)
    bending = 16.0 * (bend[0] / a1**4 + bend[1] / a2**4)
    return (stretch + bending + 2.0 * contact) / mass


def shell_membrane_omega2(
    stiff: float, shear: float, transverse: float, spacing: tuple[float, float], contact: float, mass: float
) -> float:
    """Bound of omega^2 of a shell-membrane ply, whose fibre tension is explicit.

    Tension 4 E h/a^2/m, E h [N/mm] of the stiffer family, flexural part included, a the shorter side: with one point a
    cell a wave that alternates along one grid direction has gradients along it only, and the squares of the two parts
    of any other wave's gradients add up to no more. Trellis and transverse shear 4 (N_s' + K) q/m,
    q = 1/a1^2 + 1/a2^2; contact as in `ply_omega2`; rotations add nothing (`shell_gyration`).
    """
    q = 1.0 / spacing[0] ** 2 + 1.0 / spacing[1] ** 2
    return (4.0 * stiff / min(spacing) ** 2 + 4.0 * (shear + transverse) * q + 2.0 * contact) / mass


def shell_gyration(
    stiff: float, rigidity: float, transverse: float, thickness: float, spacing: tuple[float, float]
) -> float:
    """Rotary inertia over mass [mm2] of a shell ply: h^2/12, or what keeps its frequencies under the fibres'.

    Rotations alone have omega^2 <= (K + 4 D q)/(m r^2), deflections alone 4 K q/m, both together no more than the sum.
    """
    q = 1.0 / spacing[0] ** 2 + 1.0 / spacing[1] ** 2
    return max(thickness**2 / 12.0, (transverse + 4.0 * rigidity * q) * min(spacing) ** 2 / (4.0 * stiff))


def diaphragm_omega2(
    mu: float, thickness: float, rigidity: float, mass: float, element: float, contact: float
) -> float:
    """Bound of omega^2 of a diaphragm with square elements of the given size.

    Membrane 32 mu t/a^2/m (the largest plane-stress modulus of a rubber is 4 mu at rest: half of that for one point a
    cell, the rest for what forming adds), plate 16 D (2/a^2)^2/m, contact 2 K/m.
    """
    q = 2.0 / element**2
    return (16.0 * mu * thickness * q + 16.0 * rigidity * q * q + 2.0 * contact) / mass


def contact_damping(fraction: float, stiffness: float, mass_a: float, mass_b: float) -> float:
    """Damping per area 2 z sqrt(K m) [N s/mm3], m the reduced areal mass of the two sheets [tonne/mm2]."""
    reduced = mass_a * mass_b / (mass_a + mass_b) if np.isfinite(mass_b) else mass_a
    return float(2.0 * fraction * np.sqrt(stiffness * reduced))
