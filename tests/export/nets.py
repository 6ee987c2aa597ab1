"""Lattices and a net that several tests share."""

import numpy as np

from ddf.metrics import PlySurface

RADIUS = 50.0
NET = {
    "model": "kinematic",
    "plies": [{"size_mm": [190.0, 180.0], "orientation_deg": 30.0, "element_mm": 4.0}],
    "tool": {"shape": "hemisphere", "radius_mm": RADIUS, "position_mm": [20.0, -10.0], "turn_deg": 25.0},
    "kinematic": {"start_mm": [20.0, -10.0], "offset_mm": 0.5},
    "output": {"pictures": False},
}


def lattice(stretch, shear_deg, tilt_deg=0.0, cells=6, a=2.0):
    """A flat ply with family 1 stretched along x and family 2 sheared towards it, tilted about y."""
    u, v = np.meshgrid(a * np.arange(cells + 1), a * np.arange(cells + 1), indexing="ij")
    g, b = np.radians(shear_deg), np.radians(tilt_deg)
    flat = np.stack([stretch * u + v * np.sin(g), v * np.cos(g), 0 * u])
    x = np.stack([flat[0] * np.cos(b), flat[1], flat[0] * np.sin(b)])
    start = np.stack([u, v, 0 * u])
    return PlySurface("p", x, start, (a, a), np.ones(u.shape, bool), np.ones((cells, cells)))
