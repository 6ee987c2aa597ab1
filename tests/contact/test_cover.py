"""Contact has faded to nothing wherever a ply's smooth surface jumps or ends, and reaches over the edges."""

import numpy as np
import pytest

from ddf.build.rim import RINGS, ply_cover, rim_entries, rim_nodes
from ddf.contact.patch import patch_centres, weights
from ddf.contact.rim import sheet_rim, with_rim
from ddf.mesh.ply import mesh_ply
from ddf.model import sheet_scalars

COARSE = ("plies.0.element_mm=6", "plies.1.element_mm=6", "diaphragms.element_mm=10")


def at_place(values, centre, u, v):
    """What is interpolated of nodal values (n, m) at a place, None where the sheet has no patch."""
    p, q = centre[int(u + 0.5), int(v + 0.5)]
    if p < 0:
        return None
    return np.array(weights(u - p)[:3]) @ values[p - 1 : p + 2, q - 1 : q + 2] @ np.array(weights(v - q)[:3])


def test_no_contact_where_the_surface_jumps_or_ends(make_scene):
    """On both sides of random places where patches change; two plies with darts and slits, one at 45 degrees."""
    scene = make_scene("box-net-shape", *COARSE)
    model, rng = scene.model, np.random.default_rng(1)
    for k in scene.ply_sheets:
        cover, cell, s = sheet_scalars(model, model.cover, k), sheet_scalars(model, model.cell, k), model.sheets[k]
        node, n, m = int(s["node"]), int(s["rows"]), int(s["cols"])
        centre = model.centre[2 * node : 2 * (node + n * m)].reshape(n, m, 2)
        heights = with_rim(rng.normal(size=(3, n, m)), sheet_rim(model, k))[0]
        ends = 0
        for _ in range(8000):
            u, v = rng.uniform(0.6, [n - 1.6, m - 1.6])
            near = [(int(u) + 0.5 + e, v) for e in (-1e-9, 1e-9)]
            if rng.random() < 0.5:
                near = [(u, int(v) + 0.5 + e) for e in (-1e-9, 1e-9)]
            sides = [at_place(heights, centre, *place) for place in near]
            if None not in sides and abs(sides[0] - sides[1]) < 1e-6:
                continue
            ends += 1
            there = [place for place, side in zip(near, sides, strict=True) if side is not None]
            assert all(at_place(cover, centre, *place) <= 1e-12 for place in there), near
        assert ends > 60
        assert np.mean(cover[cell > 0.0] >= 1.0) > 0.7  # most of the fabric in full


@pytest.mark.parametrize("angle", [0.0, 45.0, 20.0])
@pytest.mark.parametrize("hole", [False, True])
def test_contact_fades_around_edges_and_the_surface_goes_on(angle, hole):
    """Half of it is left on the outline, all within and none beyond half a cell; nowhere near does the surface jump."""
    square = np.array([[-40.0, -30.0], [40.0, -30.0], [40.0, 30.0], [-40.0, 30.0]])
    circle = 12.0 * np.array([(np.cos(a), np.sin(a)) for a in np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)])
    ply = mesh_ply(square, [circle] if hole else [], [], angle, 2.0, rings=RINGS)
    cover, rim = ply_cover(ply), rim_entries(ply.active)
    centre = patch_centres(ply.active | rim_nodes(rim, ply.active.shape))
    rng = np.random.default_rng(0)
    heights = with_rim(rng.normal(size=ply.x.shape), rim)[0]
    for loop in ply.outline:
        along = np.roll(loop, -1, axis=0) - loop
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
        middles = loop + 0.5 * along
        on, inside, outside = (
            np.array([at_place(cover, centre, *place) for place in middles + shift * normal])
            for shift in (0.0, -0.75, 0.75)
        )
        assert abs(np.median(on) - 0.5) < 0.05
        assert np.abs(on - 0.5).max() < 0.4  # at corners
        assert np.mean(inside >= 1.0) > 0.9
        assert np.mean(outside <= 0.0) > 0.9
        for u, v in middles:
            for near in (
                [(int(u) + 0.5 + e, v) for e in (-1e-9, 1e-9)],
                [(u, int(v) + 0.5 + e) for e in (-1e-9, 1e-9)],
            ):
                assert abs(np.subtract(*(at_place(heights, centre, *place) for place in near))) < 1e-6


@pytest.mark.parametrize("angle", [0.0, 45.0, 20.0])
def test_a_rim_goes_on_straight(angle):
    square = np.array([[-40.0, -30.0], [40.0, -30.0], [40.0, 30.0], [-40.0, 30.0]])
    ply = mesh_ply(square, [], [], angle, 2.0, rings=RINGS)
    rim = rim_entries(ply.active)
    there = rim_nodes(rim, ply.active.shape)
    assert not (there & ply.active).any()
    flat = np.where(ply.active, ply.x, 1e9)
    assert np.abs(with_rim(flat, rim) - ply.x)[:, there].max() < 1e-6
    total = np.zeros(there.size)
    np.add.at(total, rim["node"], rim["weight"])
    assert np.allclose(total[there.ravel()], 1.0, atol=1e-14)
