"""Problems of diaphragm, contact and tool: tables of known answers, quick forms, wrong laws caught."""

import math

import numpy as np
import pytest

from ddf.case import PRESETS, HyperelasticMaterial, OgdenTerm, WovenMaterial
from ddf.materials.ogden import biot_stress
from ddf.verify import bulge, capstan, hemisphere, incline, momentum, plate_strip, rubber_tension, sliding
from ddf.verify.membrane import bulge as membrane_bulge
from ddf.verify.problem import Options
from ddf.verify.registry import load_problem

QUICK = Options(quick=True)
SILICONE = PRESETS["silicone-ogden"].abaqus_terms
NAMES = (
    "diaphragm-tension", "diaphragm-bulge", "plate-disc", "plate-strip", "tool-distance", "incline", "sliding",
    "capstan", "momentum", "hemisphere",
)  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_solver_gives_the_known_answer(name):
    answer = load_problem(name).solve(QUICK)
    assert [check.quantity for check in answer.checks if not check.passed] == []
    assert all(check.bound is not None for check in answer.checks)
    assert len({column.size for column in answer.table.values()}) == 1


@pytest.mark.parametrize(
    ("stretch", "uniaxial", "planar", "equibiaxial"),
    [(1.05, 136.43, 179.38, 261.79), (1.3, 640.66, 797.27, 1054.54), (2.0, 1402.66, 1598.86, 1848.87)],
)
def test_rubber_stresses_are_those_of_the_table(stretch, uniaxial, planar, equibiaxial):
    table = {"uniaxial": uniaxial, "planar": planar, "equibiaxial": equibiaxial}
    for mode, stress in table.items():
        assert 1e3 * biot_stress(SILICONE, stretch, mode) == pytest.approx(stress, abs=0.006)


@pytest.mark.parametrize(
    ("terms", "radius", "thickness", "stretch", "pressure", "height", "edge"),
    [
        (SILICONE, 100.0, 1.5, 1.05, 3.4855e-3, 27.559, 1.05819),
        (SILICONE, 100.0, 1.5, 1.3, 20.3760e-3, 65.150, 1.25421),
        (SILICONE, 100.0, 1.5, 1.5, 25.3036e-3, 81.218, 1.32705),
        ([(1.0, 2.0)], 1.0, 1.0, 1.1, 0.52778, 0.38347, None),  # neo-Hookean: p a/(mu t), w/a
        ([(1.0, 2.0)], 1.0, 1.0, 1.5, 1.64358, 0.79879, None),
    ],
)
def test_blown_up_membrane_is_that_of_the_table(terms, radius, thickness, stretch, pressure, height, edge):
    state = membrane_bulge(terms, radius, thickness, stretch)
    assert state.pressure == pytest.approx(pressure, rel=2e-5)
    assert state.height == pytest.approx(height, rel=2e-5)
    if edge is not None:
        assert state.edge_stretch == pytest.approx(edge, rel=1e-5)


def test_net_on_a_sphere_is_that_of_the_table():
    z = np.array([0.1, 0.5, 0.8, 1.0, 1.2])
    degrees = np.rad2deg(hemisphere.net_shear(z))
    assert degrees == pytest.approx([5.7264, 28.2568, 44.2762, 54.3183, 63.7495], abs=1e-4)
    assert np.rad2deg(hemisphere.net_shear(-z)) == pytest.approx(-degrees)
    g = hemisphere.net_shear(np.linspace(0.0, 1.0, 2001))
    u = np.sqrt(np.linspace(0.0, 1.0, 2001))
    # along u = v the way is |t1 + t2| du, t1 and t2 unit vectors at 90 deg - g
    way = np.concatenate([[0.0], np.cumsum(np.sqrt(2.0 + 2.0 * np.sin(0.5 * (g[1:] + g[:-1]))) * np.diff(u))])
    assert np.rad2deg(np.interp(np.deg2rad([45.0, 75.0]), way, g)) == pytest.approx([16.113, 39.270], abs=0.01)


def test_the_bulge_converges_with_second_order():
    known = membrane_bulge(SILICONE, 100.0, 1.5, 1.3)
    off = [abs(bulge.inflate(QUICK, size, [known.pressure]).height[0] / known.height - 1.0) for size in (14.0, 7.0)]
    assert math.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.5)


def test_other_materials_are_taken():
    soft = HyperelasticMaterial(kind="hyperelastic", ogden=(OgdenTerm(mu_MPa=0.3, alpha=2.0),))
    answer = rubber_tension.solve(Options(quick=True, rubber=soft))
    assert answer.passed
    assert answer.checks[0].expected < 200.0  # kPa; the silicone has 262


def test_a_rubber_of_the_wrong_form_is_caught(monkeypatch):
    shipped = PRESETS["silicone-ogden"]
    wrong = shipped.model_copy(update={"ogden_form": "classical"})
    monkeypatch.setattr(rubber_tension, "rubber_of", lambda options: wrong)  # what is expected, not what runs
    assert not any(check.passed for check in rubber_tension.solve(QUICK).checks)


def test_a_wrong_friction_is_caught(monkeypatch):
    for module in (capstan, incline, sliding):
        name = {capstan: "make_strip", incline: "make_block", sliding: "pull"}[module]
        right = getattr(module, name)
        place = {capstan: 3, incline: 2, sliding: 2}[module]

        def wrong(*values, right=right, place=place):
            return right(*values[:place], 1.03 * values[place], *values[place + 1 :])

        monkeypatch.setattr(module, name, wrong)
        assert not any(check.passed for check in module.solve(QUICK).checks), module


def test_a_plate_of_another_rigidity_is_caught(monkeypatch):
    right = plate_strip.assemble

    def stiffer(*values):
        bench = right(*values)
        bench.model.sheets["rigidity"] *= 1.03
        return bench

    monkeypatch.setattr(plate_strip, "assemble", stiffer)
    assert [check.passed for check in plate_strip.solve(QUICK).checks] == [False, False, True, True]


def test_a_load_from_outside_is_caught(monkeypatch):
    right = momentum.two_sheets

    def heavy(*values):
        bench = right(*values)
        bench.model.gravity[2] = -1.0  # a ten-thousandth of the earth's
        return bench

    monkeypatch.setattr(momentum, "two_sheets", heavy)
    linear = [check for check in momentum.solve(QUICK).checks if check.quantity.startswith("linear")]
    assert [check.passed for check in linear] == [False, False, False, True]  # the tool's sheet is left alone


def test_a_fabric_that_is_stiff_in_shear_is_no_net():
    table = {"angle_deg": (0.0, 60.0), "normalised_shear_force_N_mm": (0.0, 20.0)}
    stiff = WovenMaterial(kind="woven", base="plain-weave-6k-320", shear_table=table)
    assert not hemisphere.solve(Options(quick=True, fabric=stiff)).passed
