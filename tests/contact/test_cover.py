"""Contact has faded to nothing wherever a ply's smooth surface is extended from a patch beside."""

import numpy as np

from ddf.contact.patch import weights
from ddf.model import sheet_scalars

COARSE = ("plies.0.element_mm=6", "plies.1.element_mm=6", "diaphragms.element_mm=10")


def test_no_contact_where_patches_change(make_scene):
    """At random places of two plies with darts and slits, one of them at 45 degrees to its outline."""
    scene = make_scene("box-net-shape", *COARSE)
    model, rng = scene.model, np.random.default_rng(1)
    for k in scene.ply_sheets:
        cover, cell, s = sheet_scalars(model, model.cover, k), sheet_scalars(model, model.cell, k), model.sheets[k]
        node, n, m = int(s["node"]), int(s["rows"]), int(s["cols"])
        centre = model.centre[2 * node : 2 * (node + n * m)].reshape(n, m, 2)
        beside = 0
        for u, v in rng.uniform(0.0, 1.0, (4000, 2)) * [n - 1.01, m - 1.01]:
            i, j = int(u + 0.5), int(v + 0.5)
            p, q = centre[i, j]
            if cell[int(u), int(v)] == 0.0 or p < 0 or (p, q) == (i, j):
                continue
            beside += 1
            a, b = weights(u - p)[:3], weights(v - q)[:3]
            assert np.array(a) @ cover[p - 1 : p + 2, q - 1 : q + 2] @ np.array(b) <= 1e-12, (u, v)
        assert beside > 100
        assert np.mean(cover[cell > 0.0] >= 1.0) > 0.7  # most of the fabric in full
