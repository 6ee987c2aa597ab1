"""Random valid cases of forming on small plies, the same for the same number: what a solver must survive.

Plies of 80 to 150 mm, one to four of them, each of its own outline, fibre angle and cuts, in a frame that leaves the
diaphragms room to stretch; any tool with fillets down to none; friction between 0 and 1; and the loads in any order,
also with the cavity above the box's pressure for a while (`box-cavity-lift`). Vacuum that throws sheets on something
comes in two stages, slowly first, as in the shipped cases.
"""

from __future__ import annotations

import math
import random
from typing import Any

ATMOSPHERE = 101.325
ORDERS = (
    "cavity-lift-box", "cavity-box-lift", "cavity-both", "lift-cavity-box", "lifted-with-cavity-box",
    "cavity-with-box-lift", "box-cavity-lift",
)  # fmt: skip
FILLETS_MM = (0.0, 0.5, 1.0, 2.0, 5.0, 8.0)
GENTLE_KPA = 94.0  # pressure at which sheets have come down, see the shipped cases


def random_case(number: int) -> dict[str, Any]:
    """Case number `number` as a dict that `ddf.case.case_from_dict` takes."""
    rng = random.Random(f"scene-{number}")
    size = rng.uniform(80.0, 150.0)
    tool = _tool(rng, size)
    plies = [_ply(rng, size) for _ in range(rng.choices((1, 2, 3, 4), (30, 35, 20, 15))[0])]
    reach = [max(abs(p[axis]) + abs(ply["offset_mm"][axis]) for ply in plies for p in _outline(ply)) for axis in (0, 1)]
    frame = [2.0 * max(part, 0.5 * size) + rng.uniform(100.0, 150.0) for part in reach]
    names = ("ply_ply", "ply_diaphragm", "diaphragm_diaphragm", "diaphragm_tool")
    order = rng.choice(ORDERS)
    element, largest = round(rng.uniform(5.0, 6.5), 2), round(rng.uniform(8.0, 16.0), 1)
    return {
        "title": f"random scene {number}: {len(plies)} plies, {tool['shape']}, fillet {tool['fillet_mm']:g}, {order}",
        "frame": {"length_mm": round(frame[0], 1), "width_mm": round(frame[1], 1)},
        "diaphragms": {"element_mm": element, "element_max_mm": largest},
        "friction": {name: 0.0 if rng.random() < 0.15 else round(rng.random(), 2) for name in names},
        "plies": plies,
        "tool": tool,
        "process": {"stages": _stages(rng, order, height_mm(tool))},
        "output": {"frames_per_stage": 3, "pictures": False},
    }


def height_mm(tool: dict[str, Any]) -> float:
    """Height [mm] of the sharp solid."""
    return float(tool["radius_mm"] if tool["shape"] == "hemisphere" else tool["height_mm"])


def _tool(rng: random.Random, size: float) -> dict[str, Any]:
    """A tool whose base lies within the ply, and whose fillets leave something of its faces."""
    shape = rng.choice(("cube-corner-tetrahedron", "regular-tetrahedron", "hemisphere", "box", "cylinder"))
    tool: dict[str, Any] = {"shape": shape}
    if shape == "cube-corner-tetrahedron":
        tool["height_mm"] = round(rng.uniform(0.2, 0.3) * size, 1)
        room = 0.2 * tool["height_mm"]
    elif shape == "regular-tetrahedron":
        tool["height_mm"] = round(rng.uniform(0.25, 0.4) * size, 1)
        room = 0.12 * tool["height_mm"]
    elif shape == "hemisphere":
        tool["radius_mm"] = round(rng.uniform(0.2, 0.32) * size, 1)
        room = 0.3 * tool["radius_mm"]
    else:
        tool["height_mm"] = round(rng.uniform(0.1, 0.25) * size, 1)
        if shape == "box":
            tool |= {
                "length_mm": round(rng.uniform(0.3, 0.6) * size, 1),
                "width_mm": round(rng.uniform(0.3, 0.5) * size, 1),
            }
            room = min(0.5 * tool["height_mm"], 0.3 * tool["width_mm"])
        else:
            tool["radius_mm"] = round(rng.uniform(0.2, 0.32) * size, 1)
            room = 0.5 * min(tool["height_mm"], tool["radius_mm"])
    tool["fillet_mm"] = rng.choice([f for f in FILLETS_MM if f <= room])
    tool["turn_deg"] = round(rng.uniform(0.0, 120.0), 1)
    tool["position_mm"] = [round(rng.uniform(-8.0, 8.0), 1), round(rng.uniform(-8.0, 8.0), 1)]
    return tool


def _ply(rng: random.Random, size: float) -> dict[str, Any]:
    """A rectangle, polygon or rectangle with a dart, up to a third smaller than the largest; with holes and slits."""
    side = size * rng.uniform(0.67, 1.0)
    ply: dict[str, Any] = {
        "orientation_deg": rng.choice((0.0, 45.0, 90.0, -45.0, round(rng.uniform(0.0, 90.0), 1))),
        "element_mm": round(rng.uniform(4.5, 6.0), 2),
        "offset_mm": [round(rng.uniform(-5.0, 5.0), 1), round(rng.uniform(-5.0, 5.0), 1)],
    }
    outline = rng.choice(("rectangle", "rectangle", "polygon", "dart"))
    a, b = 0.5 * side, 0.5 * side * rng.uniform(0.8, 1.0)
    if outline == "rectangle":
        ply["size_mm"] = [round(2 * a, 1), round(2 * b, 1)]
    elif outline == "polygon":
        count = rng.randint(5, 9)
        turns = [2.0 * math.pi * (k + rng.uniform(-0.2, 0.2)) / count for k in range(count)]
        radii = [side * rng.uniform(0.45, 0.6) for _ in turns]
        ply["polygon_mm"] = [
            [round(r * math.cos(t), 1), round(r * math.sin(t), 1)] for r, t in zip(radii, turns, strict=True)
        ]
    else:  # a V-shaped dart from the middle of the long side inwards
        mouth, depth = rng.uniform(0.05, 0.15) * side, rng.uniform(0.3, 0.7) * b
        dart = [[mouth, -b], [0.0, -b + depth], [-mouth, -b]]
        ply["polygon_mm"] = [[round(x, 1), round(y, 1)] for x, y in ([a, -b], [a, b], [-a, b], [-a, -b], *dart[::-1])]
    if rng.random() < 0.3:
        ply["holes_mm"] = [_hole(rng, 0.2 * side, 0.1 * side)]
    if rng.random() < 0.35:
        turn = rng.uniform(0.6, 1.2) * rng.choice((1.0, -1.0)) + (0.0 if rng.random() < 0.5 else math.pi)
        near, far = 0.22 * side, 0.36 * side
        ply["slits_mm"] = [[[round(r * math.sin(turn), 1), round(r * math.cos(turn), 1)] for r in (near, far)]]
    return ply


def _hole(rng: random.Random, away: float, largest: float) -> list[list[float]]:
    """A polygon about a place `away` [mm] from the ply's centre, on the side without a dart."""
    place, radius, corners = rng.uniform(0.2, math.pi - 0.2), largest * rng.uniform(0.4, 1.0), rng.randint(3, 8)
    x, y = away * math.cos(place), away * math.sin(place)
    turns = [2.0 * math.pi * k / corners for k in range(corners)]
    return [[round(x + radius * math.cos(t), 1), round(y + radius * math.sin(t), 1)] for t in turns]


def _outline(ply: dict[str, Any]) -> list[list[float]]:
    if "polygon_mm" in ply:
        return list(ply["polygon_mm"])
    a, b = (0.5 * side for side in ply["size_mm"])
    return [[a, b], [-a, -b]]


def _stages(rng: random.Random, order: str, height: float) -> list[dict[str, Any]]:
    """The stages of an order; a lift goes at 0.8 m/s, a vacuum that throws sheets down begins slowly, with damping."""
    box = rng.choice((0.0, 0.0, 0.0, 30.0, 60.0))
    lift = {"name": "lift", "duration_s": round(max(0.03, height / 800.0), 3), "tool_lift_mm": height}
    cavity = {"name": "cavity", "duration_s": 0.02, "cavity_pressure_kPa": 0.0}
    slow = {"name": "draw-down", "duration_s": 0.06, "mass_damping_1_s": 100.0, "box_pressure_kPa": GENTLE_KPA}
    full = {"name": "box", "duration_s": 0.04, "mass_damping_1_s": 100.0, "box_pressure_kPa": box}
    damped = {"mass_damping_1_s": 100.0}
    stages: list[dict[str, Any]]
    if order == "cavity-lift-box":
        stages = [cavity, lift, slow, full]
    elif order == "cavity-box-lift":
        stages = [cavity, slow, full, lift | damped]
    elif order == "cavity-both":
        stages = [cavity, slow | {"tool_lift_mm": 0.6 * height}, full | {"tool_lift_mm": height}]
    elif order == "lift-cavity-box":
        stages = [lift, cavity | {"duration_s": 0.03}, slow, full]
    elif order == "lifted-with-cavity-box":
        stages = [lift | {"cavity_pressure_kPa": 0.0}, slow, full]
    elif order == "cavity-with-box-lift":  # the box follows the cavity: the sheets are pressed down from above
        both = {"cavity_pressure_kPa": GENTLE_KPA}
        stages = [slow | both, full | {"cavity_pressure_kPa": 0.0}, lift | damped]
    else:  # the lower diaphragm alone comes down; the rest follows with the cavity
        follow = {"name": "follow", "duration_s": 0.06, "mass_damping_1_s": 100.0, "cavity_pressure_kPa": GENTLE_KPA}
        stages = [slow, full, follow, cavity | {"duration_s": 0.04} | damped, lift | damped]
    return [*stages, {"name": "hold", "duration_s": 0.05, "mass_damping_1_s": 300.0}]
