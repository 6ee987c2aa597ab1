"""Guards: what has gone wrong, where and when, with the likely cause and the key to change."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ddf.model import DIAPHRAGM, Model, State, sheet_vectors

LARGEST_FIBRE_STRAIN = 0.10
"""Beyond this the series of the fibres' law no longer holds (`elements.tension`)."""

FARTHEST_MM = 1.0e8
"""No node is farther from the origin."""


@dataclass(frozen=True)
class Alarm:
    """One reason to stop."""

    sheet: str
    node: tuple[int, int]
    place_mm: tuple[float, float, float]
    problem: str
    cause: str
    key: str

    def __str__(self) -> str:
        x, y, z = self.place_mm
        return (
            f"{self.problem} in {self.sheet} at node {self.node}, near x {x:.1f}, y {y:.1f}, z {z:.1f} mm; "
            f"likely cause: {self.cause}; change {self.key}"
        )


def _bad_node(x: np.ndarray, v: np.ndarray, limit: float) -> tuple[int, int] | None:
    """First node whose place or speed is not finite or whose speed exceeds the limit; x and v (3, n, m).

    Not compiled: with the fast mathematics of the kernels a comparison takes no heed of NaN.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        good = ((v * v).sum(axis=0) <= limit * limit) & (np.abs(x).max(axis=0) < FARTHEST_MM)
    if good.all():
        return None
    i, j = np.unravel_index(np.argmin(good), good.shape)
    return int(i), int(j)


def fibre_stretch(x: np.ndarray, active: np.ndarray, spacing: tuple[float, float]) -> list[np.ndarray]:
    """ln(lambda) of all bars of both families; 0 where a bar does not exist. x (3, n, m) [mm]."""
    result = []
    for axis, a in ((1, spacing[0]), (2, spacing[1])):
        d = np.diff(x, axis=axis)
        strain = 0.5 * np.log((d * d).sum(axis=0) / a**2)
        first = active[:-1] & active[1:] if axis == 1 else active[:, :-1] & active[:, 1:]
        result.append(np.where(first, strain, 0.0))
    return result


def check_state(model: Model, state: State, names: list[str], start: np.ndarray) -> Alarm | None:
    """Look for a state that cannot be true: not finite, absurdly fast, or with fibres torn.

    start: positions at the beginning, to say where a node belongs once its own place is lost.
    """
    for k, name in enumerate(names):
        x, v = sheet_vectors(model, state.x, k), sheet_vectors(model, state.v, k)
        limit = 0.25 * _smallest_size(model, k) / model.dt
        bad = _bad_node(x, v, limit)
        if bad is not None:
            i, j = bad
            place = x[:, i, j] if np.isfinite(x[:, i, j]).all() else sheet_vectors(model, start, k)[:, i, j]
            speed = math.hypot(*v[:, i, j])
            problem = (
                f"speed of {speed:.3g} mm/s (over {limit:.3g}, a quarter of an element a step)"
                if math.isfinite(speed)
                else "numbers that are not finite"
            )
            cause = "a step too long for the contacts, or a fold that collapses"
            key = "solver.step_safety, solver.contact_stiffness_N_mm3 or the element sizes"
            return Alarm(name, bad, _triple(place), problem, cause, key)
        if model.sheets[k]["kind"] != DIAPHRAGM:
            alarm = _torn(model, x, k, name)
            if alarm is not None:
                return alarm
    return None


def _torn(model: Model, x: np.ndarray, k: int, name: str) -> Alarm | None:
    s = model.sheets[k]
    n, m = int(s["rows"]), int(s["cols"])
    a = int(s["node"])
    active = model.mass[a : a + n * m].reshape(n, m) > 0
    for strain in fibre_stretch(x, active, (float(s["a1"]), float(s["a2"]))):
        worst = np.unravel_index(np.argmax(np.abs(strain)), strain.shape)
        if abs(strain[worst]) > LARGEST_FIBRE_STRAIN:
            i, j = int(worst[0]), int(worst[1])
            problem = f"fibre strain of {100 * strain[worst]:.1f} %"
            cause = "a node caught in a fold or on an edge of the tool"
            key = "plies.element_mm, diaphragms.element_mm or tool.fillet_mm"
            return Alarm(name, (i, j), _triple(x[:, i, j]), problem, cause, key)
    return None


def _smallest_size(model: Model, k: int) -> float:
    s = model.sheets[k]
    if s["kind"] != DIAPHRAGM:
        return float(min(s["a1"], s["a2"]))
    a, n, m = int(s["line"]), int(s["rows"]), int(s["cols"])
    return float(model.lines[a : a + n + m - 2].min())


def _triple(place: np.ndarray) -> tuple[float, float, float]:
    return float(place[0]), float(place[1]), float(place[2])
