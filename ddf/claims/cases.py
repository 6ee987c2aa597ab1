"""What has to be run: the paper's five formings, repeats with other numerics, variants of the unknowns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ddf.case import load_case, resolve_gap_mm
from ddf.sweep.named import loading
from ddf.sweep.plan import Plan, Point

BASE = "tetrahedron-0-90"
SINGLE, TURNED, DOUBLE, NO_FRICTION, VACUUM_FIRST = "0-90", "45", "double", "double-no-friction", "double-vacuum-first"
FORMINGS = (SINGLE, TURNED, DOUBLE, NO_FRICTION, VACUUM_FIRST)

COARSE_PLY_MM, COARSE_DIAPHRAGM_MM = 4.0, 5.0
#: of each repeat: tool's stiffness [N/mm3] and element size of the plies over the case's. Physics knows of neither, so
#: what they change is scatter. The first is the case as it is.
NUMERICS: tuple[tuple[float | None, float], ...] = ((None, 1.0), (60.0, 0.96), (45.0, 1.04))

AS_SHIPPED = "as-shipped"
GAP_FACTOR = 2.0
#: what the paper does not give (tool's form and fillets, friction on it, pre-stretch, gap of a stack): other values
UNKNOWNS: dict[str, dict[str, Any]] = {
    "regular-tetrahedron": {"tool.shape": "regular-tetrahedron"},
    "fillet-3": {"tool.fillet_mm": 3.0},
    "fillet-8": {"tool.fillet_mm": 8.0},
    "tool-friction-0.1": {"friction.diaphragm_tool": 0.1},
    "tool-friction-0.6": {"friction.diaphragm_tool": 0.6},
    "pre-stretch-1.05": {"diaphragms.pre_stretch": 1.05},
    "gap-double": {},  # twice the case's gap, which depends on the number of plies
}


@dataclass(frozen=True)
class Forming:
    """One run: which of the paper's formings, which repeat (from 1), and which variant of the unknowns."""

    forming: str
    repeat: int = 1
    variant: str = AS_SHIPPED

    @property
    def name(self) -> str:
        """Name of its run's folder."""
        parts = [] if self.variant == AS_SHIPPED else [self.variant]
        parts += [self.forming] + ([f"repeat-{self.repeat}"] if self.repeat > 1 else [])
        return "-".join(parts)


def wanted(repeats: int, unknowns: bool) -> list[Forming]:
    """All runs: the formings as shipped with their repeats, then each variant's once."""
    found = [Forming(forming, repeat) for repeat in range(1, repeats + 1) for forming in FORMINGS]
    if unknowns:
        found += [Forming(forming, 1, variant) for variant in UNKNOWNS for forming in FORMINGS]
    return found


def make_plan(formings: list[Forming], coarse: bool, common: tuple[str, ...] = ()) -> Plan:
    """The runs as a sweep over the shipped 0/90 case; `common`: further changes of all cases, as "key=value"."""
    points = tuple(Point(forming.name, _changes(forming, coarse, common)) for forming in formings)
    return Plan("the paper's claims" + (", coarse" if coarse else ""), Path(BASE), points, common)


def _changes(forming: Forming, coarse: bool, common: tuple[str, ...]) -> dict[str, Any]:
    shipped = {SINGLE: BASE, TURNED: "tetrahedron-45"}.get(forming.forming, "tetrahedron-double")
    case = load_case(Path(shipped), common)
    stiffness, factor = NUMERICS[forming.repeat - 1]
    plies = [ply.model_dump(exclude_none=True) for ply in case.plies]
    for ply in plies:
        ply["element_mm"] = round((COARSE_PLY_MM if coarse else ply["element_mm"]) * factor, 6)
    changes: dict[str, Any] = {"plies": plies}
    if forming.repeat > 1 or forming.variant != AS_SHIPPED:
        changes["output.pictures"] = False
    if coarse:
        changes["diaphragms.element_mm"] = COARSE_DIAPHRAGM_MM
    if stiffness is not None:
        changes["solver.tool_contact_stiffness_N_mm3"] = stiffness
    if forming.forming == NO_FRICTION:
        changes["friction.ply_ply"] = 0.0
    if forming.forming == VACUUM_FIRST:
        changes |= next(point.changes for point in loading(case) if point.name == "vacuum-then-lift")
    if forming.variant == "gap-double":
        changes["diaphragms.gap_mm"] = round(GAP_FACTOR * resolve_gap_mm(case), 6)
    elif forming.variant != AS_SHIPPED:
        changes |= UNKNOWNS[forming.variant]
    return changes
