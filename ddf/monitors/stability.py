"""Guards: what has gone wrong, where and when, with the likely cause and the key to change."""

from __future__ import annotations

import math

import numpy as np

from ddf.elements.rubber import cell_metric
from ddf.model import DIAPHRAGM, Model, State, sheet_scalars, sheet_vectors
from ddf.monitors.alarm import Alarm, alarm_at

LARGEST_FIBRE_STRAIN = 0.10
"""Beyond this the series of the fibres' law no longer holds (`elements.tension`)."""

FARTHEST_MM = 1.0e8
"""No node is farther from the origin."""

LEAST_STRETCH, LARGEST_STRETCH = 0.25, 4.0
"""Principal stretches of a diaphragm's cell beyond which it is crushed or burst: far outside the rubber's tests, and
far inside the range of the law's series (`elements.rubber`: squares between 0.05 and 20)."""

SQUEEZED = 0.5
"""Where something flies apart, a cell shorter than this is the likely cause."""


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


def fibre_stretch(model: Model, x: np.ndarray, k: int) -> list[np.ndarray]:
    """ln(lambda) of all bars of both families of ply k, x (3, n, m) [mm]; 0 where there is no bar, as across a slit."""
    s, result = model.sheets[k], []
    for axis, pool, a in ((1, model.bar1, float(s["a1"])), (2, model.bar2, float(s["a2"]))):
        d = np.diff(x, axis=axis)
        width = sheet_scalars(model, pool, k)
        there = (width[:-1] if axis == 1 else width[:, :-1]) > 0.0
        square = np.where(there, (d * d).sum(axis=0), a * a)
        result.append(0.5 * np.log(square / a**2))
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
            known = x if np.isfinite(x[:, i, j]).all() else sheet_vectors(model, start, k)
            speed = math.hypot(*v[:, i, j])
            problem = (
                f"speed of {speed:.3g} mm/s (over {limit:.3g}, a quarter of an element a step)"
                if math.isfinite(speed)
                else "numbers that are not finite"
            )
            if model.sheets[k]["kind"] == DIAPHRAGM and math.isfinite(speed):
                crushed = _crushed(model, x, k, name, SQUEEZED)
                if crushed is not None:
                    return crushed
            cause = "a step too long for the contacts, or a fold that collapses"
            key = "solver.step_safety, solver.contact_stiffness_N_mm3 or the element sizes"
            return alarm_at(name, known, bad, problem, cause, key)
        alarm = (_crushed if model.sheets[k]["kind"] == DIAPHRAGM else _torn)(model, x, k, name)
        if alarm is not None:
            return alarm
    return None


def _crushed(model: Model, x: np.ndarray, k: int, name: str, limit: float = LEAST_STRETCH) -> Alarm | None:
    """Cells of diaphragm k that have collapsed, shorter than `limit`, or burst."""
    a, n, m = int(model.sheets[k]["line"]), int(model.sheets[k]["rows"]), int(model.sheets[k]["cols"])
    c11, c22, c12 = cell_metric(x, model.lines[a : a + n - 1], model.lines[a + n - 1 : a + n + m - 2])
    mean, half = 0.5 * (c11 + c22), np.hypot(0.5 * (c11 - c22), c12)
    least, most = np.sqrt(np.maximum(mean - half, 0.0)), np.sqrt(mean + half)
    i, j = np.unravel_index(np.argmax(np.maximum(limit / (least + 1e-9), most / LARGEST_STRETCH)), least.shape)
    if least[i, j] < limit:
        problem = f"a cell crushed to {100 * least[i, j]:.0f} % of its length"
        cause = "a fold tighter than its cells, or cells caught between the frame and the rising platform"
        key = "diaphragms.element_mm or element_max_mm (smaller), or the order and the lift of process.stages"
        return alarm_at(name, x, (int(i), int(j)), problem, cause, key)
    if most[i, j] > LARGEST_STRETCH:
        problem = f"a cell stretched {most[i, j]:.1f} times"
        cause = "a span that the rubber cannot hold at this pressure, or a node caught on an edge of the tool"
        key = "frame, diaphragms.thickness_mm or the pressures and the lift of process.stages"
        return alarm_at(name, x, (int(i), int(j)), problem, cause, key)
    return None


def _torn(model: Model, x: np.ndarray, k: int, name: str) -> Alarm | None:
    for strain in fibre_stretch(model, x, k):
        worst = np.unravel_index(np.argmax(np.abs(strain)), strain.shape)
        if abs(strain[worst]) > LARGEST_FIBRE_STRAIN:
            problem = f"fibre strain of {100 * strain[worst]:.1f} %"
            cause = "a node caught in a fold or on an edge of the tool"
            key = "plies.element_mm, diaphragms.element_mm or tool.fillet_mm"
            return alarm_at(name, x, (int(worst[0]), int(worst[1])), problem, cause, key)
    return None


def _smallest_size(model: Model, k: int) -> float:
    s = model.sheets[k]
    if s["kind"] != DIAPHRAGM:
        return float(min(s["a1"], s["a2"]))
    a, n, m = int(s["line"]), int(s["rows"]), int(s["cols"])
    return float(model.lines[a : a + n + m - 2].min())
