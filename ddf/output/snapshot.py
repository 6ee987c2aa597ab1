"""All fields of a scene at one time, by sheet: what frames and pictures are made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ddf.case import resolve_gap_mm
from ddf.elements.bending import node_curvatures
from ddf.elements.rubber import cell_metric
from ddf.mesh.ply import PlyMesh
from ddf.metrics import PlySurface, fibre_strain, shear_angle
from ddf.model import State, sheet_scalars, sheet_vectors
from ddf.scene import Scene

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

DIRECTIONS = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]


@dataclass(frozen=True)
class SheetSnapshot:
    """One sheet. Fields carry their unit in the name; values where nothing exists have no meaning."""

    name: str
    kind: str  # "ply" or "diaphragm"
    x: Array  # [mm] (3, n, m)
    exists: Mask  # (n-1, m-1) cells
    point_fields: dict[str, Array]  # (n, m) each
    cell_fields: dict[str, Array]  # (n-1, m-1) each


@dataclass(frozen=True)
class Snapshot:
    """A scene at one time."""

    step: int
    time_s: float
    stage: str  # the stage that led here
    loads: dict[str, float]  # cavity_pressure_kPa, box_pressure_kPa, tool_lift_mm
    sheets: tuple[SheetSnapshot, ...]

    def sheet(self, name: str) -> SheetSnapshot:
        """The sheet of that name; KeyError if there is none."""
        for sheet in self.sheets:
            if sheet.name == name:
                return sheet
        raise KeyError(name)


def take_snapshot(scene: Scene, state: State) -> Snapshot:
    """Copy positions and work out all fields of a state."""
    time = float(state.clock[1])
    return Snapshot(
        step=int(state.clock[0]),
        time_s=time,
        stage=stage_name(scene, time),
        loads=scene.path.at(time),
        sheets=tuple(_sheet(scene, state, k) for k in range(len(scene.sheets))),
    )


def stage_name(scene: Scene, time: float) -> str:
    """The stage that the step which ended at `time` [s] was in."""
    return scene.path.names[int(scene.path.stage(max(time - 0.5 * scene.model.dt, 0.0)))]


def middle_offset_mm(scene: Scene, k: int) -> float:
    """Distance [mm] of sheet k's mid-surface from the tool where all conforms: the sheets below and half its own."""
    below = sum(sheet.thickness_mm for sheet in scene.sheets[:k])
    return below + 0.5 * scene.sheets[k].thickness_mm


def initial_z_mm(scene: Scene, k: int) -> float:
    """Height [mm] of sheet k's flat mid-surface at the start; z = 0 is the middle of the plies."""
    plies = [s.thickness_mm for s in scene.sheets if s.kind == "ply"]
    if scene.sheets[k].kind == "ply":
        return sum(plies[: k - 1]) + 0.5 * plies[k - 1] - 0.5 * sum(plies)
    half = 0.5 * (resolve_gap_mm(scene.case) + scene.sheets[k].thickness_mm)
    return -half if k == 0 else half


def ply_surface(scene: Scene, state: State | Array, k: int, time_s: float | None = None) -> PlySurface:
    """Sheet k, a ply, as the metrics take it, with the distance to the tool at its time.

    `state` may be the sheet's positions (3, n, m) [mm] instead; then `time_s` is theirs, or the process' end.
    Nodes outside the ply are extrapolated from it, so that the whole outline follows the fabric.
    """
    mesh = scene.sheets[k].mesh
    if not isinstance(mesh, PlyMesh):
        raise ValueError(f"{scene.sheets[k].name} is not a ply")
    if isinstance(state, State):
        x, time = sheet_vectors(scene.model, state.x, k), float(state.clock[1])
    else:
        x, time = state, scene.path.duration
    start = np.array(mesh.x)
    start[2] = initial_z_mm(scene, k)
    return PlySurface(
        name=scene.sheets[k].name,
        x=extrapolated(np.array(x, dtype=float), mesh.active),
        x0=start,
        spacing=mesh.spacing,
        active=mesh.active,
        cell_fraction=mesh.cell_fraction,
        outline=mesh.outline,
        corners=mesh.corners,
        offset_mm=middle_offset_mm(scene, k),
        distance=partial(scene.obstacle_distance, time=time if time_s is None else time_s),
    )


def extrapolated(x: Array, active: Mask) -> Array:
    """X (3, n, m) with nodes next to the ply at the mean of the lines 2 x1 - x2 through its nearest nodes."""
    known = active.copy()
    n, m = known.shape
    for _ in range(2):
        total, count = np.zeros_like(x), np.zeros((n, m))
        padded, there = np.pad(x, ((0, 0), (2, 2), (2, 2))), np.pad(known, 2)
        for i, j in DIRECTIONS:
            one = (slice(2 + i, 2 + i + n), slice(2 + j, 2 + j + m))
            two = (slice(2 + 2 * i, 2 + 2 * i + n), slice(2 + 2 * j, 2 + 2 * j + m))
            use = there[one] & there[two] & ~known
            total += np.where(use, 2.0 * padded[:, one[0], one[1]] - padded[:, two[0], two[1]], 0.0)
            count += use
        x = np.where(count > 0, total / np.maximum(count, 1.0), x)
        known = known | (count > 0)
    return x


def _sheet(scene: Scene, state: State, k: int) -> SheetSnapshot:
    model, info = scene.model, scene.sheets[k]
    x = sheet_vectors(model, state.x, k).copy()
    v = sheet_vectors(model, state.v, k)
    points = np.ascontiguousarray(x.reshape(3, -1).T)
    gap = scene.obstacle_distance(points, float(state.clock[1])) - middle_offset_mm(scene, k)
    fields = {"gap_to_tool_mm": gap.reshape(x.shape[1:]), "speed_mm_s": np.sqrt((v * v).sum(axis=0))}
    if info.kind == "diaphragm":
        cells = diaphragm_fields(scene, x, k)
        return SheetSnapshot(info.name, info.kind, x, np.ones_like(cells["thickness_mm"], bool), fields, cells)
    surface = ply_surface(scene, state, k)
    bar1, bar2 = sheet_scalars(model, model.bar1, k), sheet_scalars(model, model.bar2, k)
    _, _, k1, k2 = node_curvatures(x, bar1, bar2)
    fields["curvature_1_1_mm"] = k1 / surface.spacing[0] ** 2
    fields["curvature_2_1_mm"] = k2 / surface.spacing[1] ** 2
    cells = ply_fields(surface, model.shear_tables[model.sheets[k]["shear"]])
    return SheetSnapshot(info.name, info.kind, x, surface.cell_fraction > 0, fields, cells)


def ply_fields(surface: PlySurface, shear_table: Array) -> dict[str, Array]:
    """Cell fields of a ply, (n-1, m-1): shear angle, normalised shear force N_s = dW/ds, fibre strains, share of cloth.

    Fibre strains are means of a cell's two edges along the family; the metrics' largest one is that of a single edge.
    """
    angle = shear_angle(surface)
    first, second = fibre_strain(surface)
    outside = surface.cell_fraction <= 0
    strain_1, strain_2 = 0.5 * (first[:, 1:] + first[:, :-1]), 0.5 * (second[1:] + second[:-1])
    return {
        "shear_angle_deg": angle,
        "normalised_shear_force_N_mm": shear_force(np.radians(angle), shear_table),
        "fibre_strain_1": np.where(outside, 0.0, strain_1),
        "fibre_strain_2": np.where(outside, 0.0, strain_2),
        "cloth_share": surface.cell_fraction,
    }


def shear_force(angle: Array, table: Array) -> Array:
    """Normalised shear force N_s(g) = dW/ds [N/mm] of angles g [rad], from a solver's shear table."""
    s = np.sin(angle)
    width = table[-1, 0]
    k = np.minimum((np.abs(s) / width).astype(np.int64), len(table) - 2)
    u = np.abs(s) / width - k
    c = table[k]
    slope = c[..., 0] + u * (c[..., 1] + u * (c[..., 2] + u * c[..., 3]))
    return np.asarray(np.sign(s) * slope)


def diaphragm_fields(scene: Scene, x: Array, k: int) -> dict[str, Array]:
    """Cell fields of a diaphragm, (n-1, m-1): thickness t0/J [mm], J = l1 l2, and principal stretches l1 >= l2."""
    sheet = scene.model.sheets[k]
    a, n, m = int(sheet["line"]), int(sheet["rows"]), int(sheet["cols"])
    lines = scene.model.lines
    c11, c22, c12 = cell_metric(x, lines[a : a + n - 1], lines[a + n - 1 : a + n + m - 2])
    mean, radius = 0.5 * (c11 + c22), np.hypot(0.5 * (c11 - c22), c12)
    first, second = np.sqrt(mean + radius), np.sqrt(np.maximum(mean - radius, 0.0))
    thickness = float(sheet["thickness"]) / np.maximum(first * second, 1e-12)
    return {"thickness_mm": thickness, "stretch_1": first, "stretch_2": second}
