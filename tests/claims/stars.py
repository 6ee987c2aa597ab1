"""Synthetic formed plies: flat or squeezed squares with straight wrinkles where a test wants them."""

import numpy as np

from ddf.claims.formed import Formed, FormedPly
from ddf.metrics import PlySurface

SIZE = 300.0


def square(angle_deg=0.0, spacing=5.0, inward=lambda x, y: 0.0, shear=0.0, name="ply"):
    """A square ply with fibres at an angle; its lattice is drawn to the middle by `inward` (share), then sheared.

    The lattice is cut to the square by its outline alone: cells outside have no fabric.
    """
    count = 2 * int(0.75 * SIZE / spacing) + 1
    line = (np.arange(count) - count // 2) * spacing
    u, v = np.meshgrid(line, line, indexing="ij")
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    x0 = np.stack([c * u - s * v, s * u + c * v, 0.0 * u])
    share = 1.0 - inward(x0[0], x0[1])
    x = np.stack([x0[0] * share, x0[1] * share, x0[2]])
    x[:2] += np.tan(shear) * v * np.array([c, s])[:, None, None]  # along family 1
    middle = 0.25 * (x0[:, 1:, 1:] + x0[:, :-1, 1:] + x0[:, 1:, :-1] + x0[:, :-1, :-1])
    t = np.linspace(-0.5, 0.5, 61)[:-1] * SIZE
    half = np.full_like(t, 0.5 * SIZE)
    corners = np.concatenate([[t, -half], [half, t], [-t, half], [-half, -t]], axis=1)
    grid = np.array([[c, s], [-s, c]]) @ corners / spacing + count // 2
    return PlySurface(
        name=name, x=x, x0=x0, spacing=(spacing, spacing), active=np.ones(u.shape, bool), outline=[grid.T],
        cell_fraction=(np.abs(middle[:2]).max(axis=0) < 0.5 * SIZE).astype(float),
    )  # fmt: skip


def wrinkle(azimuth_deg, amplitude=5.0, fibres_deg=0.0, turn_deg=0.0, radii=(40.0, 120.0)):
    """A straight wrinkle on the radius at an azimuth, turned about its middle; fibres at an angle and across."""
    radial = np.array([np.cos(np.radians(azimuth_deg)), np.sin(np.radians(azimuth_deg))])
    way = np.array([np.cos(np.radians(azimuth_deg + turn_deg)), np.sin(np.radians(azimuth_deg + turn_deg))])
    middle, half = 0.5 * sum(radii) * radial, 0.5 * (radii[1] - radii[0]) * way
    start, end = middle - half, middle + half
    return {
        "number": 1, "ply": "ply", "start_x_mm": start[0], "start_y_mm": start[1], "end_x_mm": end[0],
        "end_y_mm": end[1], "length_mm": radii[1] - radii[0], "amplitude_mm": amplitude,
        "mean_amplitude_mm": 0.7 * amplitude, "direction_deg": azimuth_deg + turn_deg,
        "angle_to_radial_deg": lines_apart(turn_deg, 0.0),
        "angle_to_family_1_deg": lines_apart(azimuth_deg + turn_deg, fibres_deg),
        "angle_to_family_2_deg": lines_apart(azimuth_deg + turn_deg, fibres_deg + 90.0),
    }  # fmt: skip


def lines_apart(first, second):
    """Angle between undirected lines, 0 to 90 deg."""
    return abs((first - second + 90.0) % 180.0 - 90.0)


def star(fibres_deg, azimuths, percent=10.0, surface=None, **how):
    """A ply with a wrinkle at each azimuth."""
    rows = [wrinkle(azimuth, fibres_deg=fibres_deg, **how) for azimuth in azimuths]
    return FormedPly(square(fibres_deg) if surface is None else surface, rows, percent)


def formed(*plies):
    """A run of these plies, bottom first."""
    return Formed("run", plies, (0.0, 0.0))
