"""Ogden's rubber: closed forms against the independent table, and the kernel against the closed forms."""

import numpy as np
import pytest

from ddf.elements.rubber import SCRATCH, rubber_forces
from ddf.materials.ogden import bending_rigidity, biot_stress, initial_shear_modulus
from ddf.model import SHEET

TERMS = [(0.150904, 3.0918), (0.813392, 0.81451)]
# stretch, then Biot stress [kPa] in uniaxial, planar and equibiaxial tension
TABLE = [
    (1.05, 136.43, 179.38, 261.79),
    (1.10, 258.26, 335.25, 477.61),
    (1.30, 640.66, 797.27, 1054.54),
    (1.50, 916.92, 1104.93, 1387.37),
    (2.00, 1402.66, 1598.86, 1848.87),
]
MODES = ("uniaxial", "planar", "equibiaxial")


def test_closed_forms_give_the_table():
    for row in TABLE:
        for mode, expected in zip(MODES, row[1:], strict=True):
            assert 1e3 * biot_stress(TERMS, row[0], mode) == pytest.approx(expected, abs=0.006)


def test_initial_moduli():
    assert initial_shear_modulus(TERMS) == pytest.approx(0.9643, abs=1e-4)
    assert bending_rigidity(TERMS, 1.5) == pytest.approx(1.085, abs=5e-4)
    slope = biot_stress(TERMS, 1.0 + 1e-6, "uniaxial") / 1e-6
    assert slope == pytest.approx(3.0 * initial_shear_modulus(TERMS), rel=1e-5)


def _edge_stresses(l1, l2):
    """Biot stresses [MPa] along x and y of 3 x 2 cells in homogeneous deformation, from the edges' forces."""
    sheet = np.zeros(1, SHEET)
    sheet["thickness"] = 1.5
    dx, dy = np.array([1.5, 2.5, 2.0]), np.array([2.0, 1.0])
    x = np.zeros((3, 4, 3))
    x[0] = l1 * np.concatenate([[0.0], np.cumsum(dx)])[:, None]
    x[1] = l2 * np.concatenate([[0.0], np.cumsum(dy)])[None, :]
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    f = np.zeros_like(x)
    x = np.ascontiguousarray(np.tensordot(turn, x, 1))
    rubber_forces(x, f, dx, dy, sheet[0], np.array(TERMS), 0.0, 0, 4, np.zeros(SCRATCH))
    f = np.tensordot(turn.T, f, 1)
    return -f[0, -1].sum() / (1.5 * dy.sum()), -f[1, :, -1].sum() / (1.5 * dx.sum())


@pytest.mark.parametrize("stretch", [0.7, 0.9, 1.01, 1.05, 1.1, 1.3, 1.5, 2.0])
def test_kernel_in_homogeneous_deformation(stretch):
    # the kernel keeps the principal stretches apart by 1e-6 of their mean: absolute errors of 1e-5 MPa at most
    along, across = _edge_stresses(stretch, stretch**-0.5)
    assert along == pytest.approx(float(biot_stress(TERMS, stretch, "uniaxial")), rel=1e-6)
    assert abs(across) < 1e-6 * abs(along)
    along, _ = _edge_stresses(stretch, 1.0)
    assert along == pytest.approx(float(biot_stress(TERMS, stretch, "planar")), rel=1e-6)
    along, across = _edge_stresses(stretch, stretch)
    expected = float(biot_stress(TERMS, stretch, "equibiaxial"))
    assert along == pytest.approx(expected, rel=1e-5)
    assert across == pytest.approx(expected, rel=1e-5)


def test_kernel_gives_the_table():
    for stretch, uniaxial, planar, equibiaxial in TABLE:
        assert 1e3 * _edge_stresses(stretch, stretch**-0.5)[0] == pytest.approx(uniaxial, rel=1e-3)
        assert 1e3 * _edge_stresses(stretch, 1.0)[0] == pytest.approx(planar, rel=1e-3)
        assert 1e3 * _edge_stresses(stretch, stretch)[0] == pytest.approx(equibiaxial, rel=1e-3)
