"""The load path: ramps, speeds and the signs of the net pressures."""

import numpy as np
import pytest

from ddf.loads.path import LoadPath
from ddf.model import DAMPING, PRESSURE_BOTTOM, PRESSURE_TOP, TIME, TOOL_SPEED, TOOL_Z

ATMOSPHERE = 101.325


def _path(smooth=(True, True, False, True)):
    return LoadPath(
        time=np.array([0.0, 0.02, 0.12, 0.22, 0.25]),
        cavity=np.array([ATMOSPHERE, 0.0, 0.0, 0.0, 0.0]),
        box=np.array([ATMOSPHERE, ATMOSPHERE, ATMOSPHERE, 0.0, 0.0]),
        lift=np.array([0.0, 0.0, 82.0, 82.0, 82.0]),
        smooth=np.array(smooth),
        damping=np.array([30.0, 10.0, 30.0, 0.0]),
        names=("cavity", "lift", "box", "hold"),
        atmosphere=ATMOSPHERE,
    )


def _rows(path, time):
    return path.schedule(np.atleast_1d(np.asarray(time, dtype=float)), -80.0, 1e-5)


def test_values_at_breakpoints_and_half_way():
    path = _path()
    assert path.duration == 0.25
    assert path.at(0.0) == pytest.approx(
        {"cavity_pressure_kPa": ATMOSPHERE, "box_pressure_kPa": ATMOSPHERE, "tool_lift_mm": 0.0}
    )
    assert path.at(0.07)["tool_lift_mm"] == pytest.approx(41.0)
    assert path.at(0.01)["cavity_pressure_kPa"] == pytest.approx(0.5 * ATMOSPHERE)
    # the smooth ramp at a tenth and a quarter of its time: 1.25 (2 r^3 - r^4) / 10 at r = 1/2, 1.25 (1/4 - 1/10)
    assert path.at(0.030)["tool_lift_mm"] == pytest.approx(82.0 * 0.0234375)
    assert path.at(0.045)["tool_lift_mm"] == pytest.approx(82.0 * 0.1875)
    assert path.at(0.110)["tool_lift_mm"] == pytest.approx(82.0 * (1.0 - 0.0234375))
    assert path.at(0.145)["box_pressure_kPa"] == pytest.approx(0.75 * ATMOSPHERE)
    assert path.at(1.0) == pytest.approx({"cavity_pressure_kPa": 0.0, "box_pressure_kPa": 0.0, "tool_lift_mm": 82.0})


def test_stages():
    path = _path()
    assert path.stage([0.0, 0.019, 0.021, 0.13, 0.24, 0.25, 9.0]).tolist() == [0, 0, 1, 2, 3, 3, 3]


def test_loads_are_continuous():
    time = np.linspace(0.0, 0.25, 100_001)
    rows = _rows(_path(), time)
    for column, change in ((PRESSURE_TOP, 0.1), (PRESSURE_BOTTOM, 0.1), (TOOL_Z, 82.0)):
        jump = np.abs(np.diff(rows[:, column])).max()
        assert jump < 1.3 * change / 0.02 * 2.5e-6  # steepest slope 1.25 times the mean one


@pytest.mark.parametrize("smooth", [(True,) * 4, (True, False, True, True)])
def test_speed_is_the_derivative_of_the_lift(smooth):
    path = _path(smooth)
    time = np.linspace(0.0, 0.25, 2001)[1:-1]
    time = time[np.abs(time[:, None] - path.time).min(axis=1) > 1e-5]
    h = 1e-6
    slope = (_rows(path, time + h)[:, TOOL_Z] - _rows(path, time - h)[:, TOOL_Z]) / (2.0 * h)
    speed = _rows(path, time)[:, TOOL_SPEED]
    assert speed == pytest.approx(slope, abs=1e-6 * 820.0)
    assert speed.max() == pytest.approx(820.0 * (1.25 if smooth[1] else 1.0), rel=1e-3)


def test_smooth_ramps_start_and_end_at_rest():
    path = _path((True,) * 4)
    h = 1e-7
    for at in (0.02, 0.12):
        speeds = _rows(path, [at - h, at, at + h])[:, TOOL_SPEED]
        assert np.abs(speeds).max() < 1e-3
    assert _rows(path, [-1.0, 0.3])[:, TOOL_SPEED].tolist() == [0.0, 0.0]


def test_net_pressures_push_the_diaphragms_together():
    path = _path()
    begin, clamped, formed = _rows(path, [0.0, 0.03, 0.25])
    assert begin[[PRESSURE_TOP, PRESSURE_BOTTOM]] == pytest.approx([0.0, 0.0])
    assert clamped[[PRESSURE_TOP, PRESSURE_BOTTOM]] == pytest.approx([-0.101325, 0.101325])  # MPa, up is positive
    assert formed[[PRESSURE_TOP, PRESSURE_BOTTOM]] == pytest.approx([-0.101325, 0.0])


def test_schedule_rows():
    row = _rows(_path(), 0.07)[0]
    assert row[TIME] == 0.07
    assert row[TOOL_Z] == pytest.approx(-80.0 + 41.0)
    assert row[DAMPING] == pytest.approx(np.exp(-10.0 * 1e-5), rel=1e-14)
    assert _rows(_path(), 0.24)[0, DAMPING] == 1.0
