"""Ready-made sweeps, after the parameter studies of Thompson, Belnoue and Hallett (2020) and what is unknown there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ddf.build import load_path
from ddf.case import Case, Ply
from ddf.case.process import Process, Stage
from ddf.case.tool import TETRAHEDRA
from ddf.errors import UsageError
from ddf.plausible.mesh import ELEMENTS_A_WALL, wall_depth_mm
from ddf.sweep.plan import Point

PLY_FRICTION = (0.0, 0.14, 0.28, 0.42)  # 0.28 measured, 0 compared with it in section 3.4
FILLETS_MM = (2.5, 5.0, 10.0)
MESH_FACTORS = (2.0, 1.5, 1.0, 0.75)
FREE = 2.0
"""Times the duration of the vacuum's first stage where sheets hang free: in the duration of the other orders they came
down so fast that a ply buckled through itself in the mouth of a fold."""


def friction(case: Case) -> list[Point]:
    """Friction between the plies of a double lay-up, 0 to 0.42 (section 3.4: 0.28 against 0).

    A case of one ply gets a second one like it below, turned by 45 deg.
    """
    layup: dict[str, Any] = {}
    if len(case.plies) == 1:
        angle = case.plies[0].orientation_deg
        layup = {"plies": _layup(case.plies[0], (angle + 45.0, angle))}
    return [Point(f"friction-{mu:g}", layup | {"friction.ply_ply": mu}) for mu in PLY_FRICTION]


def loading(case: Case) -> list[Point]:
    """Order of lifting the tool and evacuating the box (section 3.5): lift first, both at once, box first.

    Mass damping of the box's stage, which keeps the snap on the tool slow, goes with the snap: to the stage of
    both, and with the box first to the lift too. Sheets that no tool has lifted yet have farther to come down: then the
    first stage of the vacuum takes FREE times as long. Where the sheets are drawn to the walls of a deep box, cells at
    the frame are small enough to bend into its corners.
    """
    stages = [stage.model_dump(exclude_none=True) for stage in case.process.stages or ()]
    lift = next((k for k, stage in enumerate(stages) if stage.get("tool_lift_mm")), None)
    box = [k for k, stage in enumerate(stages) if "box_pressure_kPa" in stage]
    if lift is None or not box or lift in box or box[-1] - box[0] != len(box) - 1:
        raise UsageError(
            "the sweep 'loading' needs a case whose process has a stage that lifts the tool and, one after the other, "
            "others that evacuate the box",
            "choose another case with --case",
        )
    first, last = min(lift, box[0]), max(lift, box[-1])
    between = [stage for k, stage in enumerate(stages) if first < k < last and k != lift and k not in box]
    vacuum = stages[box[0] : box[-1] + 1]
    damping = {key: vacuum[0][key] for key in ("mass_damping_1_s",) if key in vacuum[0]}
    share = stages[lift]["duration_s"] / sum(stage["duration_s"] for stage in vacuum)
    reached, total, together = 0.0, sum(stage["duration_s"] for stage in vacuum), []
    for stage in vacuum:  # the lift goes on through all stages of the vacuum, which take the longer time of the two
        reached += stage["duration_s"]
        lifted = {"tool_lift_mm": stages[lift]["tool_lift_mm"] * reached / total}
        longer = {"duration_s": stage["duration_s"] * max(1.0, share)}
        together.append(stage | lifted | longer | {"name": f"lift-and-{stage['name']}"})
    slowly = vacuum[0] | {"duration_s": FREE * vacuum[0]["duration_s"]}
    orders = {
        "lift-then-vacuum": [stages[lift], *between, *vacuum],
        "together": [*between, *together],
        "vacuum-then-lift": [slowly, *vacuum[1:], *between, stages[lift] | damping],
    }
    points = []
    for name, order in orders.items():
        changes: dict[str, Any] = {"process.stages": [*stages[:first], *order, *stages[last + 1 :]]}
        process = Process(stages=tuple(Stage(**stage) for stage in changes["process.stages"]))
        changed = case.model_copy(update={"process": process})
        largest = wall_depth_mm(changed, load_path(changed)) / ELEMENTS_A_WALL
        if 0.0 < largest < case.diaphragms.element_max_mm:
            changes["diaphragms.element_max_mm"] = max(largest, case.diaphragms.element_mm)
        points.append(Point(name, changes))
    return points


def layup(case: Case) -> list[Point]:
    """Orientation and number of plies: 0/90, +-45, and both in either order (bottom ply first)."""
    stacks = ((0.0,), (45.0,), (45.0, 0.0), (0.0, 45.0))
    return [
        Point("-".join(f"{angle:g}" for angle in stack), {"plies": _layup(case.plies[0], stack)}) for stack in stacks
    ]


def tool(case: Case) -> list[Point]:
    """The tool's rounding, and for the published tetrahedron, of which only the height is known, its shape."""
    if case.tool is None or "fillet_mm" not in case.tool.used_keys() or case.tool.shape == "hemisphere":
        raise UsageError("the sweep 'tool' needs a tool with fillets", "choose another case with --case")
    if case.tool.shape in TETRAHEDRA:
        chosen = [(TETRAHEDRA[0], fillet) for fillet in FILLETS_MM] + [(TETRAHEDRA[1], FILLETS_MM[1])]
    else:
        chosen = [(case.tool.shape, factor * case.tool.fillet_mm) for factor in (0.5, 1.0, 2.0)]
    return [
        Point(f"{shape}-fillet-{fillet:g}", {"tool.shape": shape, "tool.fillet_mm": fillet}) for shape, fillet in chosen
    ]


def mesh(case: Case) -> list[Point]:
    """Element size of plies and diaphragms, 2 to 0.75 times the case's."""
    points = []
    for factor in MESH_FACTORS:
        changes = {f"plies.{k}.element_mm": factor * ply.element_mm for k, ply in enumerate(case.plies)}
        d = case.diaphragms
        changes |= {
            "diaphragms.element_mm": factor * d.element_mm,
            "diaphragms.element_max_mm": factor * d.element_max_mm,
        }
        points.append(Point(f"element-{factor * case.plies[0].element_mm:g}-mm", changes))
    return points


def _layup(ply: Ply, angles: tuple[float, ...]) -> list[dict[str, Any]]:
    """Plies like the given one, bottom first, at other angles."""
    table = ply.model_dump(exclude_none=True)
    return [table | {"name": f"ply-{number}", "orientation_deg": angle} for number, angle in enumerate(angles, start=1)]


NAMED: dict[str, Callable[[Case], list[Point]]] = {
    "friction": friction, "loading": loading, "layup": layup, "tool": tool, "mesh": mesh,
}  # fmt: skip
