"""Contact has faded to nothing wherever a ply's smooth surface jumps, and reaches to edges along the grid."""

import numpy as np
import pytest

from ddf.build.pools import ply_cover
from ddf.contact.patch import patch_centres, weights
from ddf.model import sheet_scalars

COARSE = ("plies.0.element_mm=6", "plies.1.element_mm=6", "diaphragms.element_mm=10")


def at_place(values, centre, u, v):
    """What is interpolated of nodal values (n, m) at a place, None where the sheet has no patch."""
    p, q = centre[int(u + 0.5), int(v + 0.5)]
    if p < 0:
        return None
    return np.array(weights(u - p)[:3]) @ values[p - 1 : p + 2, q - 1 : q + 2] @ np.array(weights(v - q)[:3])


def test_no_contact_where_the_surface_jumps(make_scene):
    """On both sides of random places where patches change; two plies with darts and slits, one at 45 degrees."""
    scene = make_scene("box-net-shape", *COARSE)
    model, rng = scene.model, np.random.default_rng(1)
    for k in scene.ply_sheets:
        cover, cell, s = sheet_scalars(model, model.cover, k), sheet_scalars(model, model.cell, k), model.sheets[k]
        node, n, m = int(s["node"]), int(s["rows"]), int(s["cols"])
        centre = model.centre[2 * node : 2 * (node + n * m)].reshape(n, m, 2)
        heights = rng.normal(size=(n, m))
        jumps = 0
        for _ in range(8000):
            u, v = rng.uniform(0.6, [n - 1.6, m - 1.6])
            near = [(int(u) + 0.5 + e, v) for e in (-1e-9, 1e-9)]
            if rng.random() < 0.5:
                near = [(u, int(v) + 0.5 + e) for e in (-1e-9, 1e-9)]
            sides = [at_place(heights, centre, *place) for place in near]
            if cell[int(near[0][0]), int(near[0][1])] == 0.0 or None in sides or abs(sides[0] - sides[1]) < 1e-6:
                continue
            jumps += 1
            assert max(at_place(cover, centre, *place) for place in near) <= 1e-12, near
        assert jumps > 40
        assert np.mean(cover[cell > 0.0] >= 1.0) > 0.7  # most of the fabric in full


@pytest.mark.parametrize("hole", [False, True])
def test_contact_fades_over_the_last_cell_along_straight_edges(hole):
    cell = np.ones((20, 16))
    cell[-1], cell[:, -1] = 0.0, 0.0
    if hole:
        cell[8:12, 8:12] = 0.0  # corners of which are none of a rectangle
    cover = ply_cover(cell)
    exists = np.ones((20, 16), bool)
    if hole:
        exists[9:12, 9:12] = False
    centre = patch_centres(exists)
    for u in (0.0, 0.25, 0.5, 0.75, 1.0):
        assert at_place(cover, centre, u, 3.3) == pytest.approx(u, abs=1e-12)
        assert at_place(cover, centre, 19.0 - u, 3.3) == pytest.approx(u, abs=1e-12)
    if hole:
        assert cover[8, 8] == -3.0
    else:
        assert cover.min() == 0.0
