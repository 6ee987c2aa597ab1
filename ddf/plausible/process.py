"""Sense of the loading: that something happens, in an order and at a pace that the process can have."""

from __future__ import annotations

import math

import numpy as np

from ddf.case import Case
from ddf.loads.path import EASE, LoadPath
from ddf.plausible.findings import Findings

STILL_KPA = 1e-6  # pressures closer than this are the same
ATMOSPHERES_KPA = (20.0, 120.0)  # mount Everest, a deep mine
FAST_MM_S, IMPOSSIBLE_MM_S = 1.0e4, 1.0e6
"""Tool speeds: beyond the first inertia decides the shape; the second is ten times that of sound in silicone."""
LEAST_KPA = 1.0  # a difference of pressure that holds or presses something
LEAST_LIFT = 0.7  # of the tool's height: what it is lifted at least where a stack is to be formed over it
LONG_S = 2.0
"""A process longer than this takes hours for nothing: no law depends on rates, only inertia does, and some tenths of a
second keep that out."""
STRETCHED, TORN = 2.5, 8.0
"""Mean stretch of the diaphragm between tool and frame: beyond the range of the rubber's tests; torn."""


def examine_process(case: Case, path: LoadPath, found: Findings) -> None:
    """Look at pressures, lift and speeds of the load path."""
    key = ("process", "stages" if case.process.breakpoints is None else "breakpoints")
    still = max(np.ptp(path.cavity), np.ptp(path.box)) <= STILL_KPA
    if still and path.lift.max() == 0.0:
        problem = "nothing happens: every pressure stays at atmosphere and the tool is not lifted"
        found.fault(key, problem, "a pressure other than atmosphere_kPa, or a lift")
    low, high = ATMOSPHERES_KPA
    if not low <= path.atmosphere <= high:
        problem = f"{path.atmosphere:g} kPa is no atmosphere on earth; is it in kPa?"
        found.warn(("process", "atmosphere_kPa"), problem, f"{low:g} to {high:g}")
    _examine_order(case, path, found)
    _examine_vacuum(case, path, found)
    _examine_lift(case, path, found)
    if path.duration > LONG_S:
        problem = (
            f"{path.duration:g} s in all: durations are those of the model, in which nothing but inertia depends on "
            "rates, not those of the shop floor"
        )
        found.warn(key, problem, "some tenths of a second in all; see the shipped cases")


def _examine_vacuum(case: Case, path: LoadPath, found: Findings) -> None:
    """What clamps the plies and what presses the stack on the tool is there, and in time."""
    if case.tool is None or path.lift.max() == 0.0:
        return
    key = ("process", "stages" if case.process.breakpoints is None else "breakpoints")
    if path.box[-1] > path.atmosphere - LEAST_KPA:
        problem = f"nothing presses the stack on the tool: the box ends at {path.box[-1]:g} kPa, as the air above it"
        found.warn(key, problem, "a stage that lowers box_pressure_kPa")
    if path.cavity.min() > path.atmosphere - LEAST_KPA:
        problem = "nothing clamps the plies between the diaphragms: the cavity stays at atmosphere"
        found.warn(key, problem, "a first stage that lowers cavity_pressure_kPa")
        return
    k = int(np.argmax(path.lift > 0.0))
    if path.cavity[k] > path.atmosphere - LEAST_KPA:
        problem = "the tool is lifted before the cavity is evacuated: the plies are not clamped yet"
        found.warn(_key(case, k, "tool_lift_mm"), problem, "a stage before it that lowers cavity_pressure_kPa")


def _examine_order(case: Case, path: LoadPath, found: Findings) -> None:
    """The cavity is evacuated before the box; pressure in it above either side's blows the diaphragms apart."""
    for name, what, outside in (
        ("box_pressure_kPa", "box", path.box),
        ("cavity_pressure_kPa", "atmosphere", np.full_like(path.box, path.atmosphere)),
    ):
        apart = path.cavity - outside
        k = int(np.argmax(apart))
        if apart[k] > 1.0:
            key = _key(case, k, name)
            problem = (
                f"the cavity is {apart[k]:.4g} kPa above the {what} at {path.time[k]:g} s: the diaphragms are blown "
                "apart, and the stack is not clamped"
            )
            found.warn(key, problem, "evacuate the cavity first, and keep it at or below box and atmosphere")


def _examine_lift(case: Case, path: LoadPath, found: Findings) -> None:
    rise = np.abs(np.diff(path.lift)) / np.diff(path.time)
    speed = np.where(path.smooth, 1.0 / (1.0 - EASE), 1.0) * rise
    k = int(np.argmax(speed))
    problem = f"the tool moves at {speed[k]:.3g} mm/s"
    allowed = f"<= {FAST_MM_S:g} mm/s, so that inertia does not shape the part"
    found.limit(speed[k], FAST_MM_S, IMPOSSIBLE_MM_S, _key(case, k + 1, "tool_lift_mm"), problem, allowed)
    if case.tool is None:
        return
    k = int(np.argmax(path.lift))
    lift, radius = float(path.lift[k]), case.tool.footprint_radius_mm()
    if lift == 0.0:
        found.warn(("tool",), "the tool is never lifted: it only stands below the stack")
    elif case.tool.height_mm is not None and lift > 1.5 * case.tool.height_mm:
        problem = f"{lift:g} lifts the platform far above the frame, past the tool's height of {case.tool.height_mm:g}"
        found.warn(_key(case, k, "tool_lift_mm"), problem, "about the tool's height")
    elif lift < LEAST_LIFT * (case.tool.height_mm or case.tool.radius_mm or 0.0):
        height = case.tool.height_mm or case.tool.radius_mm
        problem = f"{lift:g} leaves most of a tool that is {height:g} mm high below the frame"
        found.warn(_key(case, k, "tool_lift_mm"), problem, "about the tool's height")
    if radius is not None:
        half = 0.5 * min(case.frame.length_mm, case.frame.width_mm)
        room = max(half - radius - max(np.abs(case.tool.position_mm)), 1.0)
        stretch = case.diaphragms.pre_stretch * math.hypot(1.0, lift / room)
        problem = f"{lift:g} mm, with {room:.4g} mm between tool and frame, stretch the diaphragm {stretch:.3g} times"
        allowed = f"a stretch up to {STRETCHED:g}: a larger frame, a smaller tool or a lower lift"
        found.limit(stretch, STRETCHED, TORN, _key(case, k, "tool_lift_mm"), problem, allowed)


def _key(case: Case, breakpoint: int, name: str) -> tuple[str | int, ...]:
    """Key path of a quantity at a breakpoint of the load path; stage k ends at breakpoint k + 1."""
    if case.process.breakpoints is not None:
        return ("process", "breakpoints", name, breakpoint)
    return ("process", "stages", max(breakpoint - 1, 0), name)
