"""Problems of diaphragm, contact and tool: tables of known answers, and wrong laws that are caught."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ddf.case import PRESETS, HyperelasticMaterial, OgdenTerm
from ddf.materials.ogden import biot_stress
from ddf.verify import (
    bulge,
    capstan,
    hemisphere,
    incline,
    momentum,
    plate_disc,
    plate_strip,
    rubber_tension,
    sliding,
    tool_distance,
)
from ddf.verify.bench_sheets import rubber_of
from ddf.verify.membrane import bulge as membrane_bulge
from ddf.verify.problem import Options

QUICK = Options(quick=True)
SILICONE = rubber_of(Options()).abaqus_terms


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


def _ogden(bench):
    bench.model.ogden[:, 0] *= 1.03
    return bench


def _rigidity(bench):
    bench.model.sheets["rigidity"] *= 1.02
    return bench


def _friction(bench):
    bench.model.pairs["friction"] *= 1.03
    return replace(bench, model=bench.model._replace(tool_friction=1.03 * bench.model.tool_friction))


def _falling(bench):
    bench.model.gravity[2] = -1.0  # a ten-thousandth of the earth's
    return bench


def _stiff_in_shear(bench):
    bench.model.shear_tables[:, :-1] *= 300.0
    return bench


WRONG = {
    bulge: _ogden, plate_disc: _rigidity, plate_strip: _rigidity, incline: _friction, sliding: _friction,
    capstan: _friction, momentum: _falling, hemisphere: _stiff_in_shear,
}  # fmt: skip


@pytest.mark.parametrize("module", WRONG)
def test_a_scene_of_another_law_misses_a_bound(module, monkeypatch):
    right = module.assemble
    monkeypatch.setattr(module, "assemble", lambda *a, **k: WRONG[module](right(*a, **k)))
    assert not module.solve(QUICK).passed


def test_a_tool_of_other_fillets_misses_a_bound(monkeypatch):
    right = tool_distance.build_tool
    monkeypatch.setattr(tool_distance, "build_tool", lambda shape, **k: right(shape, **(k | {"fillet_mm": 4.0})))
    missed = [check.quantity for check in tool_distance.solve(QUICK).checks if not check.passed]
    assert missed
    assert all("fillets" in quantity for quantity in missed)
