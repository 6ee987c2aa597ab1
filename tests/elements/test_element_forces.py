"""Every force is minus the gradient of its energy, also across the seam of two row blocks."""

from dataclasses import replace

import numpy as np
import patches as p
import pytest
from differences import gradient

from ddf.elements.rubber import STRIP

SEAM = 3


@pytest.fixture(params=[1, 2])
def cut_ply(request):
    rng = np.random.default_rng(request.param)
    patch = p.ply_patch(fractions=p.cut_fractions(rng))
    return patch, p.wavy(patch.rest, rng)


@pytest.mark.parametrize("law", ["published", "monotone"])
def test_shear_is_the_gradient_of_its_energy(cut_ply, law):
    patch, x = cut_ply
    x = x.copy()
    x[0] += 0.35 * x[1]  # a mean shear angle of 19 degrees: past the laws' knee
    table = p.table_of(law)
    expected = -gradient(lambda y: p.ply_shear_energy(patch, y, table), x, 1e-5)
    assert p.relative(p.ply_shear(patch, x, table, SEAM), expected) < 1e-6


def test_shear_of_opposite_sign_is_the_gradient_too(cut_ply):
    patch, x = cut_ply
    x = x.copy()
    x[0] -= 0.8 * x[1]
    table = p.table_of("monotone")
    expected = -gradient(lambda y: p.ply_shear_energy(patch, y, table), x, 1e-5)
    assert p.relative(p.ply_shear(patch, x, table, SEAM), expected) < 1e-6


@pytest.mark.parametrize(("rigidity", "in_plane"), [(0.2, 0.0), (0.2, 0.05), (0.2, 0.2)])
def test_bending_is_the_gradient_of_its_energy(cut_ply, rigidity, in_plane):
    patch, x = cut_ply
    patch.sheet["bend1"] = rigidity
    patch.sheet["bend_in_plane"] = in_plane
    expected = -gradient(lambda y: p.ply_bending_energy(patch, y), x)
    assert p.relative(p.ply_bending(patch, x, SEAM), expected) < 1e-8


def test_in_plane_rigidity_adds_to_the_bending_energy(cut_ply):
    patch, x = cut_ply
    without = p.ply_bending_energy(patch, x)
    patch.sheet["bend_in_plane"] = 0.05
    assert p.ply_bending_energy(patch, x) > 1.001 * without


def test_tension_is_the_gradient_of_its_energy(cut_ply):
    patch, _ = cut_ply
    x = patch.rest + np.random.default_rng(5).normal(size=patch.rest.shape) * 0.005
    expected = -gradient(lambda y: p.ply_tension_energy(patch, y), x)
    assert p.relative(p.ply_tension(patch, x), expected) < 1e-7


@pytest.mark.parametrize(("strain", "bound"), [(0.01, 5e-10), (0.1, 4e-4)])
def test_tension_of_one_bar_follows_the_logarithm(strain, bound):
    patch = p.ply_patch(2, 2)
    for sign in (1.0, -1.0):
        stretch = 1.0 + sign * strain
        x = patch.rest * np.array([stretch, 1.0, 1.0])[:, None, None]
        force = p.ply_tension(patch, x)[0, 0].sum()
        expected = 20_000.0 * 1.7 * np.log(stretch) / stretch  # E h, width of the patch
        assert force == pytest.approx(expected, rel=bound)


@pytest.fixture(params=[1, 2])
def diaphragm(request):
    rng = np.random.default_rng(request.param)
    patch = p.rubber_patch(rng)
    x = p.wavy(patch.rest * np.array([1.3, 1.1, 1.0])[:, None, None], rng)
    x[0] += 0.3 * x[1]
    return patch, x


def test_rubber_is_the_gradient_of_its_energy(diaphragm):
    patch, x = diaphragm
    expected = -gradient(lambda y: sum(p.rubber_energies(patch, y)), x)
    assert p.relative(p.rubber(patch, x, seam=SEAM), expected) < 1e-8


@pytest.mark.parametrize(("part", "kept"), [(0, {}), (1, {"hourglass": 3.0}), (2, {"rigidity": 1.085})])
def test_each_part_of_the_rubber_is_the_gradient_of_its_energy(diaphragm, part, kept):
    patch, x = diaphragm
    for key in ("hourglass", "rigidity"):
        patch.sheet[key] = 0.0
    membrane = p.rubber(patch, x, seam=SEAM)
    for key, value in kept.items():
        patch.sheet[key] = value
    force = p.rubber(patch, x, seam=SEAM)
    expected = -gradient(lambda y: p.rubber_energies(patch, y)[part], x)
    assert p.relative(force if part == 0 else force - membrane, expected) < 1e-7


def test_pressure_is_the_gradient_of_the_swept_volume_inside(diaphragm):
    patch, x = diaphragm
    pressure = 0.1
    force = p.rubber(patch, x, pressure, SEAM) - p.rubber(patch, x, seam=SEAM)
    expected = pressure * gradient(p.volume, x)
    inside = np.s_[:, 1:-1, 1:-1]
    assert p.relative(force[inside], expected[inside]) < 1e-9


def test_pressure_on_a_closed_outline_has_the_resultant_of_its_flat_area():
    patch = p.rubber_patch(np.random.default_rng(3))
    x = patch.rest.copy()
    x[2, 1:-1, 1:-1] = np.random.default_rng(4).normal(size=(5, 7))
    force = (p.rubber(patch, x, 0.1) - p.rubber(patch, x)).sum(axis=(1, 2))
    assert force == pytest.approx([0.0, 0.0, 0.1 * patch.dx.sum() * patch.dy.sum()], abs=1e-10)


def test_plate_is_the_gradient_of_its_energy(diaphragm):
    patch, x = diaphragm
    expected = -gradient(lambda y: p.plate_bending_energy(patch, y), x)
    assert p.relative(p.plate(patch, x, SEAM), expected) < 1e-9


@pytest.mark.parametrize("seam", [1, 2, 4, 6])
def test_row_blocks_do_not_change_a_force(seam):
    rng = np.random.default_rng(7)
    ply, skin = p.ply_patch(fractions=p.cut_fractions(rng)), p.rubber_patch(rng)
    x, y, table = p.wavy(ply.rest, rng), p.wavy(skin.rest, rng), p.table_of("monotone")
    assert np.array_equal(p.ply_shear(ply, x, table, seam), p.ply_shear(ply, x, table))
    assert np.array_equal(p.ply_bending(ply, x, seam), p.ply_bending(ply, x))
    assert np.array_equal(p.rubber(skin, y, 0.1, seam), p.rubber(skin, y, 0.1))
    assert np.array_equal(p.plate(skin, y, seam), p.plate(skin, y))


def test_curvature_of_a_cylinder():
    patch = p.ply_patch(9, 5)
    radius = 60.0
    angle = patch.rest[0] / radius
    x = np.array([radius * np.sin(angle), patch.rest[1], radius * (1.0 - np.cos(angle))])
    inner = patch.triple1.sum()
    assert p.ply_bending_energy(patch, x) == pytest.approx(0.5 * 0.34 / radius**2 * inner, rel=1e-3)


def test_plate_energy_of_a_cylinder_and_of_a_twist():
    patch = p.rubber_patch(np.random.default_rng(2), 12, 12)
    x = patch.rest.copy()
    x[2] = 0.5 * 1e-3 * x[0] ** 2
    area = (0.5 * (patch.dx[1:] + patch.dx[:-1])).sum() * patch.dy.sum()
    assert p.plate_bending_energy(patch, x) == pytest.approx(0.5 * 1.085 * 1e-6 * area, rel=1e-9)
    x[2] = 1e-3 * x[0] * x[1]
    twist = p.rubber_energies(patch, x)[2]
    # 1/2 D (1 - nu) 2 w_xy^2 with nu = 1/2
    assert twist == pytest.approx(0.5 * 1.085 * 1e-6 * patch.dx.sum() * patch.dy.sum(), rel=1e-9)


@pytest.mark.parametrize("cols", [STRIP - 1, STRIP, STRIP + 1, 2 * STRIP + 5])
def test_strips_of_a_wide_diaphragm_do_not_change_its_force(cols):
    """Nodes away from the ends have the forces that they have in narrow parts of the sheet, of one strip each."""
    patch = p.rubber_patch(np.random.default_rng(8), 6, cols)
    x = p.wavy(patch.rest, np.random.default_rng(9))
    force = p.rubber(patch, x, 0.1)
    for first in range(0, cols - 8, 5):
        part = replace(patch, dy=patch.dy[first : first + 8])
        narrow = p.rubber(part, np.ascontiguousarray(x[:, :, first : first + 9]), 0.1)
        here = np.s_[1 if first else 0 : 8]
        assert np.abs(force[:, :, first : first + 9][..., here] - narrow[..., here]).max() < 1e-12 * np.abs(force).max()
    last = replace(patch, dy=patch.dy[-8:])
    narrow = p.rubber(last, np.ascontiguousarray(x[:, :, -9:]), 0.1)
    assert np.abs(force[:, :, -8:] - narrow[..., 1:]).max() < 1e-12 * np.abs(force).max()
