"""The load path: absolute pressures of cavity and box and the tool's lift over process time.

Between breakpoints a quantity goes linearly or smoothly: at 1.25 times the mean rate, reached and left over a
fifth of the time by 3 r^2 - 2 r^3. (A polynomial ramp peaks at 1.5 to 1.9 times the mean rate, for 1.4 to 2.2
times the kinetic energy.) The net pressures on the deformed diaphragms, positive upward:

    top: p_cavity - p_atm,      bottom: p_box - p_cavity
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddf.model import DAMPING, PRESSURE_BOTTOM, PRESSURE_TOP, SCHEDULE, TIME, TOOL_SPEED, TOOL_Z

FloatArray = NDArray[np.float64]
KPA = 1.0e-3  # MPa


EASE = 0.2  # part of a smooth ramp's time in which its rate rises, and in which it falls


def smooth_ramp(s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Share of the way gone, and its rate, at share s in [0, 1] of a ramp's time."""
    top = 1.0 / (1.0 - EASE)
    r = np.clip(np.minimum(s, 1.0 - s) / EASE, 0.0, 1.0)
    rate = top * r * r * (3.0 - 2.0 * r)
    near = np.minimum(s, 1.0 - s)
    gone = np.where(near < EASE, top * EASE * (r**3 - 0.5 * r**4), top * (near - 0.5 * EASE))
    return np.where(s <= 0.5, gone, 1.0 - gone), rate


@dataclass(frozen=True)
class LoadPath:
    """Breakpoints of the process. One array entry a breakpoint; a stage lies between two of them."""

    time: FloatArray  # [s], from 0
    cavity: FloatArray  # absolute pressure [kPa]
    box: FloatArray  # absolute pressure [kPa]
    lift: FloatArray  # [mm]
    smooth: NDArray[np.bool_]  # of each stage
    damping: FloatArray  # mass damping of each stage [1/s]
    names: tuple[str, ...]  # of each stage
    atmosphere: float  # [kPa]

    @property
    def duration(self) -> float:
        """Process time [s]."""
        return float(self.time[-1])

    @property
    def constant_from(self) -> float:
        """Time from which no load changes any more [s]: the start of a last stage that holds, else the end."""
        held = all(values[-1] == values[-2] for values in (self.cavity, self.box, self.lift))
        return float(self.time[-2 if held else -1])

    def stage(self, time: ArrayLike) -> NDArray[np.int64]:
        """Number of the stage at a time."""
        k = np.searchsorted(self.time, np.asarray(time, dtype=float), side="right") - 1
        return np.clip(k, 0, len(self.names) - 1)

    def _values(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        k = self.stage(time)
        span = self.time[k + 1] - self.time[k]
        s = np.clip((time - self.time[k]) / span, 0.0, 1.0)
        eased, rate = smooth_ramp(s)
        share = np.where(self.smooth[k], eased, s)
        inside = (time >= 0.0) & (time <= self.duration)
        rate = np.where(self.smooth[k], rate, 1.0) / span * inside

        def at(values: FloatArray) -> FloatArray:
            return values[k] + share * (values[k + 1] - values[k])

        return at(self.cavity), at(self.box), at(self.lift), rate * (self.lift[k + 1] - self.lift[k])

    def schedule(self, time: FloatArray, base_z: float, dt: float) -> FloatArray:
        """Rows of the solver's schedule (k, SCHEDULE) at times [s]; base_z: the tool's base at zero lift [mm].

        Pressures in MPa, tool base in mm, its speed in mm/s, and the factor exp(-damping dt) of a step.
        """
        cavity, box, lift, speed = self._values(time)
        rows = np.zeros((time.size, SCHEDULE))
        rows[:, TIME] = time
        rows[:, PRESSURE_TOP] = (cavity - self.atmosphere) * KPA
        rows[:, PRESSURE_BOTTOM] = (box - cavity) * KPA
        rows[:, TOOL_Z] = base_z + lift
        rows[:, TOOL_SPEED] = speed
        rows[:, DAMPING] = np.exp(-self.damping[self.stage(time)] * dt)
        return rows

    def at(self, time: float) -> dict[str, float]:
        """Loads at a time: cavity_pressure_kPa, box_pressure_kPa, tool_lift_mm."""
        cavity, box, lift, _ = self._values(np.array([time]))
        return {
            "cavity_pressure_kPa": float(cavity[0]),
            "box_pressure_kPa": float(box[0]),
            "tool_lift_mm": float(lift[0]),
        }
