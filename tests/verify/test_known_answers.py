"""The known answers by themselves, against numbers computed independently of this package."""

import numpy as np
import pytest

from ddf.verify.bias_extension import grip_force, way
from ddf.verify.elastica import heavy_elastica, peirce_rigidity
from ddf.verify.net import least_energy, make_net
from ddf.verify.picture_frame import ANGLES_DEG
from ddf.verify.problem import Options
from ddf.verify.scenes import entered_law, fabric_of

# Gamma: tip x/L, drop/L, Peirce's rigidity over the true one
ELASTICA = {
    0.5: (0.99778, 0.06231, 1.0004), 1: (0.99125, 0.12347, 1.0016), 2: (0.96689, 0.23851, 1.0061),
    5: (0.84666, 0.49591, 1.0298), 10: (0.65635, 0.70020, 1.0751), 20: (0.44523, 0.82988, 1.1510),
    50: (0.24501, 0.90792, 1.3390), 100: (0.15922, 0.93752, 1.6219),
}  # fmt: skip
# N_s [N/mm] of the shipped fabric's published law at 5, 10 .. 60 deg
PUBLISHED = (
    0.00950, 0.00949, 0.01110, 0.01909, 0.03379, 0.05308, 0.07436, 0.09648, 0.12176, 0.15791, 0.22002, 0.33253,
)  # fmt: skip
# d/D: shear angle in the middle [deg]
ZONES = {0.02: 2.315, 0.05: 5.883, 0.10: 12.122, 0.15: 18.814, 0.20: 26.104, 0.25: 34.229, 0.30: 43.630}


@pytest.mark.parametrize("gamma", ELASTICA)
def test_heavy_elastica(gamma):
    ahead, drop, peirce = ELASTICA[gamma]
    shape = heavy_elastica(gamma)
    assert shape.x[-1] == pytest.approx(ahead, abs=1e-5)
    assert shape.drop[-1] == pytest.approx(drop, abs=1e-5)
    # a strip of length 1 and weight gamma has B = 1
    assert peirce_rigidity(gamma, 1.0, shape.x[-1], shape.drop[-1]) == pytest.approx(peirce, abs=1e-4)


def test_published_shear_law():
    fabric = fabric_of(Options()).model_copy(update={"shear_law": "published"})
    assert np.interp(np.deg2rad(ANGLES_DEG), *entered_law(fabric)) == pytest.approx(PUBLISHED, abs=6e-6)


@pytest.mark.parametrize("share", ZONES)
def test_zones_of_bias_extension(share):
    assert way(np.deg2rad(ZONES[share])) == pytest.approx(share * 120.0, rel=1e-3)


def test_net_of_constant_moment_costs_what_the_zones_do():
    """With the same moment M at any angle every turn of a line costs the same, so zones and net agree on the force."""
    angle = np.linspace(0.0, 1.2, 2001)
    law = (angle, (1.0 + 1e-4 * angle) * np.minimum(angle / 1e-3, 1.0) / np.cos(angle))
    for g in np.deg2rad([10.0, 30.0]):
        _, pull = least_energy(make_net(60.0, 180.0), float(way(g)), law, 0.5 * float(g))
        assert pull == pytest.approx(grip_force(g, law), rel=2e-3)


def test_net_needs_less_energy_than_the_zones():
    law = entered_law(fabric_of(Options()))
    halts = np.linspace(0.02, np.deg2rad(40.0), 60)
    net = make_net(60.0, 180.0)
    pulls = [least_energy(net, float(way(g)), law, 0.5 * float(g))[1] for g in halts]
    works = [np.trapezoid(force, way(halts)) for force in (pulls, grip_force(halts, law))]
    assert 0.9 * works[1] < works[0] < works[1]
