"""From a case to a scene: meshes, masses, contact pairs, steps."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_cdt, distance_transform_edt

from ddf.case import Case, hyperelastic_material, resolve_gap_mm, woven_material
from ddf.case.schema import Tool, WovenMaterial
from ddf.contact.layers import UNKNOWN
from ddf.contact.patch import edge_cover, patch_centres
from ddf.contact.tool import FREE, POINTS
from ddf.dynamics import timestep
from ddf.elements.bending import tangent_weights
from ddf.elements.shell_membrane.history import HISTORY, M_C11, M_C22, S_C11, S_C22
from ddf.elements.shell_membrane.rotations import normals
from ddf.loads.path import LoadPath
from ddf.materials import ogden, shear_law
from ddf.mesh.diaphragm import DiaphragmMesh, mesh_diaphragm
from ddf.mesh.distance import DistanceField, distance_field
from ddf.mesh.ply import PlyMesh, mesh_ply
from ddf.mesh.tool import TriangleMesh, build_tool
from ddf.model import (
    BLOCK,
    DIAPHRAGM,
    LEDGER,
    PAIR,
    PLY,
    PRESSURE_BOTTOM,
    PRESSURE_TOP,
    SHEET,
    SHELL_PLY,
    SPRINGS,
    Model,
    State,
    sheet_shells,
    sheet_vectors,
)
from ddf.scene import Scene, SheetInfo

FloatArray = NDArray[np.float64]

BLOCKS_A_SHEET = 12
LEAST_NODE = 0.25
"""Least share of a cell whose mass a node of a ply carries. A cut leaves slivers, and a sheet that lies on one
pushes its nodes with far more than the sliver's own stiffness: at their own mass they were shot away."""
OWN_STIFFNESS, OWN_DAMPING = 1 / 6, 0.25
"""Stiffness and damping ratio of a diaphragm's contact with itself over those of layers. It comes on top of the layers
that press on the other face; more would shorten the step of every run, and 0.5 N/mm3 give 0.2 mm under vacuum. A face
of a ply that touches itself touches nothing else: there it is the layers' stiffness."""
COVER_MARGIN_MM = 30.0  # nodes nearer than this to the edge of a ply between two sheets are followed
TONNE_PER_GSM_MM2 = 1e-12
TONNE_PER_KG_M3 = 1e-12


class _Stack(NamedTuple):
    """All sheets of a case in order, bottom diaphragm first."""

    plies: list[PlyMesh]
    materials: list[WovenMaterial]
    diaphragm: DiaphragmMesh
    z: list[float]  # mid-surface of each sheet [mm]
    thickness: list[float]  # as clamped [mm]


def build_scene(case: Case) -> Scene:
    """Mesh a case and assemble its model and initial state. Raises MeshError or CaseError."""
    stack = _mesh_stack(case)
    tool_mesh, tool_field = (None, None) if case.tool is None else _tool(case.tool)
    rubber = hyperelastic_material(case, case.diaphragms.material)
    terms = rubber.abaqus_terms
    sheets, laws, tables, tangents = _sheets(case, stack, terms)
    scale, masses = _masses(case, stack, rubber.density_kg_m3 * TONNE_PER_KG_M3, tangents)
    _damp_fibres(case, sheets, masses, tangents)
    limit = _step_limit(case, stack, terms, masses, tangents)
    dt = limit if case.solver.step_s is None else case.solver.step_s
    pools = _pools(case, stack, sheets, masses)
    pairs, exposed, places = _pairs(case, stack, masses, sheets)
    blocks = row_blocks(sheets)
    friction, solver = case.friction, case.solver
    values = np.zeros((2, 2, 2, 4), np.float32) if tool_field is None else tool_field.values
    model = Model(
        sheets=sheets, blocks=blocks, pairs=pairs, **pools,
        lines=np.concatenate([np.diff(stack.diaphragm.x_lines), np.diff(stack.diaphragm.y_lines)])
        / case.diaphragms.pre_stretch,
        shear_tables=laws, tangents=tables, ogden=np.array(terms, dtype=float), exposed=exposed, tool=values,
        tool_origin=np.zeros(3) if tool_field is None else np.asarray(tool_field.origin, dtype=float),
        tool_spacing=1.0 if tool_field is None else float(tool_field.spacing),
        tool_sheet=-1 if tool_field is None else 0, tool_offset=0.5 * stack.thickness[0],
        tool_stiffness=solver.tool_contact_stiffness_N_mm3,
        tool_damping=timestep.contact_damping(
            solver.contact_damping, solver.tool_contact_stiffness_N_mm3, masses[0], math.inf
        ),
        tool_mass=masses[0], tool_friction=friction.diaphragm_tool, tool_boxed=True,
        gravity=np.zeros(3), dt=dt,
    )  # fmt: skip
    state = state_at_rest(model, _flat_positions(stack), places)
    height = 0.0 if tool_mesh is None or case.tool is None else _nominal_height(case.tool, tool_mesh)
    face = stack.z[0] - 0.5 * stack.thickness[0]
    return Scene(
        case=case, model=model, state=state, sheets=_infos(case, stack, model, scale), path=load_path(case),
        base_z=face - height, tool_mesh=tool_mesh, tool_field=tool_field,
        step_limit=limit, first_step_s=dt,
    )  # fmt: skip


def load_path(case: Case) -> LoadPath:
    """The case's stages or breakpoints as a load path; values left out are held."""
    process = case.process
    start = (process.atmosphere_kPa, process.atmosphere_kPa, 0.0)
    default = case.solver.mass_damping_1_s
    if process.stages is not None:
        time: list[float] = [0.0]
        rows: list[tuple[float, ...]] = [start]
        for stage in process.stages:
            time.append(time[-1] + stage.duration_s)
            wanted = (stage.cavity_pressure_kPa, stage.box_pressure_kPa, stage.tool_lift_mm)
            rows.append(tuple(old if new is None else new for old, new in zip(rows[-1], wanted, strict=True)))
        smooth = [stage.ramp == "smooth" for stage in process.stages]
        damping = [default if s.mass_damping_1_s is None else s.mass_damping_1_s for s in process.stages]
        names = tuple(stage.name for stage in process.stages)
        values = np.array(rows)
    else:
        points = process.breakpoints
        assert points is not None
        time = list(points.time_s)
        given = (points.cavity_pressure_kPa, points.box_pressure_kPa, points.tool_lift_mm)
        values = np.column_stack(
            [np.full(len(time), s) if g is None else np.array(g) for s, g in zip(start, given, strict=True)]
        )
        smooth, damping = [points.ramp == "smooth"] * (len(time) - 1), [default] * (len(time) - 1)
        names = tuple(f"segment-{k}" for k in range(1, len(time)))
    return LoadPath(
        np.array(time), values[:, 0], values[:, 1], values[:, 2], np.array(smooth), np.array(damping), names,
        process.atmosphere_kPa,
    )  # fmt: skip


def _mesh_stack(case: Case) -> _Stack:
    plies = []
    for ply in case.plies:
        outline, holes, slits = ply.outline_mm(), ply.holes_mm, ply.slits_mm
        shape = np.asarray(outline) - np.asarray(ply.offset_mm)
        plies.append(
            mesh_ply(
                shape, holes, slits, ply.orientation_deg, ply.element_mm, (ply.offset_mm[0], ply.offset_mm[1]), ply.name
            )
        )
    d = case.diaphragms
    corners = np.concatenate([np.asarray(ply.outline_mm(), dtype=float) for ply in case.plies])
    low, high = corners.min(axis=0) - d.margin_mm, corners.max(axis=0) + d.margin_mm
    half = np.array([case.frame.length_mm, case.frame.width_mm]) / 2
    low, high = np.maximum(low, -half), np.minimum(high, half)
    box = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
    mesh = mesh_diaphragm(case.frame.length_mm, case.frame.width_mm, box, d.element_mm, d.element_max_mm, d.growth)
    materials = [woven_material(case, ply.material) for ply in case.plies]
    thick = [m.thickness_mm for m in materials]
    skin = d.thickness_mm / d.pre_stretch**2
    gap = resolve_gap_mm(case)
    ends = np.cumsum([0.0, *thick]) - 0.5 * sum(thick)
    mid = [float(0.5 * (a + b)) for a, b in zip(ends[:-1], ends[1:], strict=True)]
    z = [-0.5 * (gap + skin), *mid, 0.5 * (gap + skin)]
    return _Stack(plies, materials, mesh, z, [skin, *thick, skin])


def _tool(tool: Tool) -> tuple[TriangleMesh, DistanceField]:
    """Tool mesh, turned and placed, and its distance field."""
    keys = {key: getattr(tool, key) for key in tool.used_keys() if key in _TOOL_KEYS}
    mesh = build_tool(tool.shape, **{key: value for key, value in keys.items() if value is not None})
    c, s = math.cos(math.radians(tool.turn_deg)), math.sin(math.radians(tool.turn_deg))
    points = mesh.points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    points += [*tool.position_mm, 0.0]
    placed = TriangleMesh(points, mesh.triangles)
    return placed, distance_field(placed)


_TOOL_KEYS = ("height_mm", "radius_mm", "length_mm", "width_mm", "fillet_mm", "file", "unit")


def _nominal_height(tool: Tool, mesh: TriangleMesh) -> float:
    """Height [mm] that touches the stack at zero lift: of the sharp solid, or of the file's highest point."""
    if tool.shape == "hemisphere" and tool.radius_mm is not None:
        return tool.radius_mm
    return float(mesh.top_mm) if tool.height_mm is None else tool.height_mm


def _masses(case: Case, stack: _Stack, density: float, tangents: list[float]) -> tuple[list[float], list[float]]:
    """Mass scaling of each ply and areal mass of each sheet as clamped [tonne/mm2]."""
    solver = case.solver
    scales = []
    for number, (ply, material, shear) in enumerate(zip(stack.plies, stack.materials, tangents, strict=True)):
        areal = material.areal_density_gsm * TONNE_PER_GSM_MM2
        if solver.target_step_s is not None:
            omega2 = _ply_omega2(case, number, ply, material, shear, areal)
            step = solver.step_safety * timestep.damped_limit(math.sqrt(omega2), solver.contact_damping)
            scales.append(max(1.0, (solver.target_step_s / step) ** 2))
        else:
            scales.append(solver.mass_scaling if solver.mass_scaling is not None else 1.0)
    skin = solver.diaphragm_mass_scaling * density * case.diaphragms.thickness_mm / case.diaphragms.pre_stretch**2
    plies = [m.areal_density_gsm * TONNE_PER_GSM_MM2 * s for m, s in zip(stack.materials, scales, strict=True)]
    return scales, [skin, *plies, skin]


def _ply_omega2(case: Case, number: int, ply: PlyMesh, material: WovenMaterial, shear: float, mass: float) -> float:
    """Bound of omega^2 of ply `number` of the case, of whichever formulation."""
    contact = 2.0 * case.solver.contact_stiffness_N_mm3
    if case.plies[number].formulation == "shell-membrane":
        stiff, transverse = stiffest(material), material.transverse_shear_N_mm
        return timestep.shell_membrane_omega2(stiff, shear, transverse, ply.spacing, contact, mass)
    return timestep.ply_omega2(shear, material.bending_rigidity_Nmm, ply.spacing, contact, mass)


def stiffest(material: WovenMaterial) -> float:
    """Tensile stiffness of the stiffer family, membrane and shell together [N/mm]."""
    flexural = 12.0 / material.thickness_mm**2
    both = zip(material.membrane_modulus_N_mm, material.bending_rigidity_Nmm, strict=True)
    return max(eh + flexural * d for eh, d in both)


def _damp_fibres(case: Case, sheets: np.ndarray, masses: list[float], tangents: list[float]) -> None:
    """Set the damping time 2 z/omega of shell plies, z of critical at the highest frequency of the ply by itself."""
    for k, s in enumerate(sheets):
        if s["kind"] == SHELL_PLY:
            spacing = (float(s["a1"]), float(s["a2"]))
            stiff = max(float(s[f"eh{f}"]) + 12.0 * float(s[f"bend{f}"]) / float(s["thickness"]) ** 2 for f in (1, 2))
            omega2 = timestep.shell_membrane_omega2(stiff, 0.0, 0.0, spacing, 0.0, masses[k])
            s["viscous"] = 2.0 * case.solver.fibre_damping / math.sqrt(omega2)


def _sheets(case: Case, stack: _Stack, terms):
    """SHEET records, the stacked shear and tangent tables and the largest shear tangent of each ply [N/mm]."""
    count = len(stack.plies) + 2
    sheets = np.zeros(count, SHEET)
    tables, slopes, tangents = [], [], []
    node = shell = 0
    d = case.diaphragms
    for k in range(count):
        s = sheets[k]
        s["node"], s["thickness"] = node, stack.thickness[k]
        s["squeeze"] = stack.thickness[k] if case.solver.in_plane_pressure else 0.0
        s["hourglass"] = 4.0 * ogden.initial_shear_modulus(terms) * d.thickness_mm
        if 0 < k < count - 1:
            ply, material = stack.plies[k - 1], stack.materials[k - 1]
            s["kind"], s["shear"] = PLY, k - 1
            s["rows"], s["cols"] = ply.x.shape[1:]
            s["a1"], s["a2"] = ply.spacing
            s["eh1"], s["eh2"] = material.membrane_modulus_N_mm
            s["bend1"], s["bend2"] = material.bending_rigidity_Nmm
            s["bend_in_plane"] = material.in_plane_bending_Nmm
            s["fold_radius"] = 0.5 * (d.thickness_mm + material.thickness_mm)
            table = material.shear_table
            angle, force = shear_law.shear_samples(
                material.shear_law, material.thickness_mm, material.shear_modulus_floor_MPa,
                material.shear_modulus_polynomial_MPa,
                None if table is None else (table.angle_deg, table.normalised_shear_force_N_mm),
            )  # fmt: skip
            tables.append(shear_law.shear_table(angle, force))
            slopes.append(shear_law.tangent_table(angle, force))
            tangents.append(shear_law.largest_tangent(angle, force))
            if case.plies[k - 1].formulation == "shell-membrane":
                s["kind"], s["shell"] = SHELL_PLY, shell
                s["transverse"], s["glass"] = material.transverse_shear_N_mm, case.solver.hourglass
                s["gyration"] = timestep.shell_gyration(
                    stiffest(material), max(material.bending_rigidity_Nmm), material.transverse_shear_N_mm,
                    material.thickness_mm, ply.spacing,
                )  # fmt: skip
                shell += int(s["rows"] * s["cols"])
        else:
            s["kind"], s["rows"], s["cols"] = DIAPHRAGM, *stack.diaphragm.x.shape[1:]
            s["face"] = PRESSURE_BOTTOM if k == 0 else PRESSURE_TOP
            s["thickness"] = d.thickness_mm
            s["rigidity"] = ogden.bending_rigidity(terms, d.thickness_mm) if d.bending else 0.0
            s["fold_radius"] = d.thickness_mm + sum(m.thickness_mm for m in stack.materials)
        node += int(s["rows"] * s["cols"])
    return sheets, np.array(tables), np.array(slopes), tangents


def _step_limit(case: Case, stack: _Stack, terms, masses: list[float], tangents: list[float]) -> float:
    """Stable step [s], the least of all sheets, safety included."""
    solver, d = case.solver, case.diaphragms
    stiff = solver.contact_stiffness_N_mm3
    limits = []
    for k, (ply, material) in enumerate(zip(stack.plies, stack.materials, strict=True)):
        omega2 = _ply_omega2(case, k, ply, material, tangents[k], masses[k + 1])
        damping = 2.0 * sum(_pair_damping(case, masses, k + 1, other) for other in (k, k + 2))
        if case.plies[k].formulation == "shell-membrane":
            damping += 2.0 * case.solver.fibre_damping * math.sqrt(omega2) * masses[k + 1]
        limits.append((math.sqrt(omega2), damping / masses[k + 1]))
    mu, bending = ogden.initial_shear_modulus(terms), ogden.bending_rigidity(terms, d.thickness_mm)
    omega2 = timestep.diaphragm_omega2(
        mu, d.thickness_mm, bending if d.bending else 0.0, masses[0], d.element_mm, stiff
    )
    damping = 2.0 * max(_pair_damping(case, masses, 0, other) for other in range(1, len(masses)))
    limits.append((math.sqrt(omega2), damping / masses[0]))
    if solver.self_contact:  # normal to flanks that touch: bending and contacts, but nothing of the membrane
        own, own_damping = _own_contact(case, masses[0])
        omega2 = timestep.diaphragm_omega2(
            0.0, d.thickness_mm, bending if d.bending else 0.0, masses[0], d.element_mm, stiff + own
        )
        limits.append((math.sqrt(omega2), (damping + 2.0 * own_damping) / masses[0]))
    return solver.step_safety * min(timestep.damped_limit(w, c / (2.0 * w)) for w, c in limits)


def _own_contact(case: Case, mass: float) -> tuple[float, float]:
    """Stiffness [N/mm3] and damping [N s/mm3] of a diaphragm's contact with itself, of areal mass `mass`."""
    s = case.solver
    stiffness = OWN_STIFFNESS * s.contact_stiffness_N_mm3
    return stiffness, timestep.contact_damping(OWN_DAMPING * s.contact_damping, stiffness, mass, mass)


def _pair_damping(case: Case, masses: list[float], a: int, b: int) -> float:
    s = case.solver
    return timestep.contact_damping(s.contact_damping, s.contact_stiffness_N_mm3, masses[a], masses[b])


def corner_sum(cells: FloatArray) -> FloatArray:
    """Quarter of the cells around each node, (n, m) from (n-1, m-1)."""
    p = np.pad(cells, 1)
    return 0.25 * (p[1:, 1:] + p[:-1, 1:] + p[1:, :-1] + p[:-1, :-1])


def _pools(case: Case, stack: _Stack, sheets: np.ndarray, masses: list[float]) -> dict[str, np.ndarray]:
    """Node pools of the model: masses, areas, bars, cells, triples, spans."""
    names = ("mass", "inverse_mass", "area", "bar1", "bar2", "cell", "triple1", "triple2", "cover")
    parts: dict[str, list[FloatArray]] = {name: [] for name in names}
    spans, firsts, centres, weights, first = [], [], [], [], 0
    for k, s in enumerate(sheets):
        n, m = int(s["rows"]), int(s["cols"])
        zero = np.zeros((n, m))
        values = dict.fromkeys(names, zero)
        if s["kind"] != DIAPHRAGM:
            ply = stack.plies[k - 1]
            values |= _lattice(ply)
            values["cover"] = ply_cover(values["cell"])
            span = np.asarray(ply.row_span)
            held, exists = np.zeros((n, m), bool), ply.active
        else:
            dx, dy = np.diff(stack.diaphragm.x_lines), np.diff(stack.diaphragm.y_lines)
            cells = dx[:, None] * dy[None, :]
            values["area"], values["cell"] = corner_sum(cells), np.pad(cells, ((0, 1), (0, 1)))
            values["cover"] = np.ones((n, m))
            span = np.tile([0, m], (n, 1))
            held, exists = np.ones((n, m), bool), np.ones((n, m), bool)
            held[1:-1, 1:-1] = False
        area = values["area"]
        if s["kind"] != DIAPHRAGM:
            area = np.where(area > 0.0, np.maximum(area, LEAST_NODE * s["a1"] * s["a2"]), 0.0)
        mass = masses[k] * area
        values["mass"] = np.where(held, 0.0, mass)
        values["inverse_mass"] = np.where(held | (mass <= 0), 0.0, 1.0 / np.where(mass > 0, mass, 1.0))
        for name in names:
            parts[name].append(values[name].ravel())
        spans.append(span)
        centres.append(patch_centres(exists).ravel())
        weights.append(tangent_weights(values["bar1"], values["bar2"]).ravel())
        firsts.append(first)
        first += n
    pools = {name: np.ascontiguousarray(np.concatenate(part)) for name, part in parts.items()}
    pools["row_span"] = np.ascontiguousarray(np.concatenate(spans).astype(np.int64))
    pools["centre"] = np.concatenate(centres)
    pools["weight"] = np.concatenate(weights)
    pools["row_first"] = np.array(firsts, dtype=np.int64)
    return pools


def ply_cover(cell: FloatArray) -> FloatArray:
    """Depth of a ply's nodes inside its edges, in cells, less one; cell (n, m) areas.

    Contact takes what is interpolated of it between 0 and 1 (`contact.layers`): none up to a cell from the edge,
    all from two cells on. Nearer to the edge the smooth surface is extended from a patch beside, and along an edge that
    runs across the grid in steps that patch changes, and the surface jumps: contact there gave a stack of four plies
    5 % of its work out of nothing.
    """
    inside = np.pad(edge_cover(cell) > 0.0, 1)
    depth: FloatArray = distance_transform_cdt(inside, metric="chessboard")[1:-1, 1:-1] - 1.0
    return depth


def _lattice(ply: PlyMesh) -> dict[str, FloatArray]:
    """Areas of a ply's nodes and cells, widths of its bars, areas of its bending triples; all (n, m)."""
    a1, a2 = ply.spacing
    share = ply.cell_fraction
    p = np.pad(share, 1)
    bar1 = np.pad(0.5 * a2 * (p[1:-1, 1:] + p[1:-1, :-1]), ((0, 1), (0, 0)))
    bar2 = np.pad(0.5 * a1 * (p[1:, 1:-1] + p[:-1, 1:-1]), ((0, 0), (0, 1)))
    triple1, triple2 = np.zeros_like(bar1), np.zeros_like(bar2)
    triple1[1:] = a1 * np.minimum(bar1[1:], bar1[:-1])
    triple2[:, 1:] = a2 * np.minimum(bar2[:, 1:], bar2[:, :-1])
    return {
        "area": a1 * a2 * corner_sum(share), "cell": a1 * a2 * np.pad(share, ((0, 1), (0, 1))),
        "bar1": bar1, "bar2": bar2, "triple1": triple1, "triple2": triple2,
    }  # fmt: skip


def row_blocks(sheets: np.ndarray) -> np.ndarray:
    """Fixed blocks of rows of every sheet: the unit of parallel work and of all sums."""
    rows = []
    for k, s in enumerate(sheets):
        size = max(4, math.ceil(int(s["rows"]) / BLOCKS_A_SHEET))
        rows += [(k, low, min(low + size, int(s["rows"]))) for low in range(0, int(s["rows"]), size)]
    return np.array(rows, dtype=BLOCK)


def first_places(place: FloatArray) -> FloatArray:
    """A pair's entries in the state's `place` before the first step, from grid coordinates (2, n, m) on the master."""
    unknown, zeros = np.full((1, *place.shape[1:]), UNKNOWN), np.zeros((2, *place.shape[1:]))
    return np.concatenate([place, unknown, zeros]).ravel()


def state_at_rest(model: Model, x: FloatArray, places: FloatArray) -> State:
    """A fresh state: positions x (3 N,), first places of all pairs, nothing in motion, no tension, no anchor."""
    sheet = model.sheets[model.tool_sheet]
    nodes = (int(sheet["rows"]), int(sheet["cols"])) if model.tool_sheet >= 0 else (1, 1)
    anchors = np.zeros((*nodes, POINTS, 3))
    anchors[..., 0] = FREE
    shells = model.sheets["kind"] == SHELL_PLY
    size = int((model.sheets["rows"] * model.sheets["cols"])[shells].sum())
    state = State(
        x=x, v=np.zeros_like(x), f=np.zeros_like(x),
        place=places, slip=np.zeros(2 * model.exposed.size), tool_anchor=anchors,
        press=np.zeros(model.mass.size), tension1=np.zeros(model.mass.size), tension2=np.zeros(model.mass.size),
        director=np.zeros(3 * size), spin=np.zeros(3 * size), pull=np.zeros(3 * size), history=np.zeros(HISTORY * size),
        ledger=np.zeros((model.blocks.size, LEDGER)), springs=np.zeros((model.blocks.size, SPRINGS)),
        clock=np.zeros(4),
    )  # fmt: skip
    for k in np.flatnonzero(shells):
        sheet_shells(model, state.history, int(k), HISTORY)[[M_C11, M_C22, S_C11, S_C22]] = 1.0
        sheet_shells(model, state.director, int(k), 3)[:] = normals(sheet_vectors(model, x, int(k)))
    return state


def _depth_inside(ply: PlyMesh, points: FloatArray) -> FloatArray:
    """How deep points (2, ...) lie inside a ply's fabric [mm]; 0 outside."""
    inner = distance_transform_edt(np.pad(ply.cell_fraction > 0, 1), sampling=ply.spacing)[1:-1, 1:-1]
    u, v = _lattice_place(ply, points)
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    n, m = inner.shape
    inside = (i >= 0) & (j >= 0) & (i < n) & (j < m)
    return np.where(inside, inner[np.clip(i, 0, n - 1), np.clip(j, 0, m - 1)], 0.0)


def _lattice_place(ply: PlyMesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Grid coordinates of points (2, ...) in the flat ply."""
    origin = ply.x[:2, 0, 0]
    a, b = ply.x[:2, 1, 0] - origin, ply.x[:2, 0, 1] - origin
    r = points - origin.reshape(2, *([1] * (points.ndim - 1)))
    return np.tensordot(a, r, 1) / (a @ a), np.tensordot(b, r, 1) / (b @ b)


def _pairs(case: Case, stack: _Stack, masses: list[float], sheets: np.ndarray):
    """PAIR records, which slave nodes each follows, and their first places on the masters."""
    top = len(stack.plies) + 1
    friction = case.friction
    wanted = []
    for k in range(1, top):
        wanted += [(k, 0, 1.0, friction.ply_diaphragm), (k, top, -1.0, friction.ply_diaphragm)]
        wanted += [(k, j, math.copysign(1.0, k - j), friction.ply_ply) for j in range(1, top) if j != k]
    # each diaphragm against the other at half stiffness: one way only, small errors in how a graded grid
    # passes on a pressure push the whole stack to one side
    wanted += [(top, 0, 1.0, friction.diaphragm_diaphragm), (0, top, -1.0, friction.diaphragm_diaphragm)]
    if case.solver.self_contact:
        own = [friction.diaphragm_diaphragm, *[friction.ply_ply] * len(stack.plies), friction.diaphragm_diaphragm]
        wanted += [(k, k, sign, mu) for k, mu in enumerate(own) for sign in (1.0, -1.0)]
    records, exposed, places = [], [], []
    first = buffer = span = 0
    for slave, master, sign, mu in wanted:
        follow, place = _follow(stack, slave, master)
        if slave != master and not follow.any():
            continue
        offset = 0.5 * (stack.thickness[slave] + stack.thickness[master])
        damping = _pair_damping(case, masses, slave, master)
        stiffness = case.solver.contact_stiffness_N_mm3
        if slave == master and slave in (0, top):
            stiffness, damping = _own_contact(case, masses[slave])
        if (slave in (0, top)) == (master in (0, top)):  # each is slave of the other as well
            stiffness, damping = 0.5 * stiffness, 0.5 * damping
        reduced = masses[slave] * masses[master] / (masses[slave] + masses[master])
        records.append((slave, master, first, buffer, span, sign, offset, mu, stiffness, damping, reduced))
        exposed.append(follow.ravel())
        places.append(first_places(place))
        n, m = int(sheets[master]["rows"]), int(sheets[master]["cols"])
        size = max(4, math.ceil(int(sheets[slave]["rows"]) / BLOCKS_A_SHEET))
        blocks = math.ceil(int(sheets[slave]["rows"]) / size)
        first += follow.size
        buffer += 4 * n * m * blocks
        span += n * blocks
    return np.array(records, dtype=PAIR), np.concatenate(exposed), np.concatenate(places)


def _follow(stack: _Stack, slave: int, master: int) -> tuple[NDArray[np.bool_], FloatArray]:
    """Slave nodes that can meet the master, (n, m), and their places (2, n, m) on its grid; of itself, none yet."""
    top = len(stack.plies) + 1
    mesh = stack.diaphragm if slave in (0, top) else stack.plies[slave - 1]
    points = mesh.x[:2]
    if slave == master:
        return np.zeros(points.shape[1:], bool), np.zeros(points.shape)
    follow = np.ones(points.shape[1:], bool) if isinstance(mesh, DiaphragmMesh) else mesh.active.copy()
    for between in range(min(slave, master) + 1, max(slave, master)):
        follow &= _depth_inside(stack.plies[between - 1], points) < COVER_MARGIN_MM
    if master in (0, top):
        lines = (stack.diaphragm.x_lines, stack.diaphragm.y_lines)
        place = np.array([np.interp(p, line, np.arange(line.size)) for p, line in zip(points, lines, strict=True)])
    else:
        place = np.array(_lattice_place(stack.plies[master - 1], points))
    return follow, place


def _flat_positions(stack: _Stack) -> FloatArray:
    """Positions (3 N,) of all sheets, flat at their heights in the stack [mm]."""
    meshes: list[PlyMesh | DiaphragmMesh] = [stack.diaphragm, *stack.plies, stack.diaphragm]
    parts = []
    for mesh, z in zip(meshes, stack.z, strict=True):
        x = np.array(mesh.x, dtype=float)
        x[2] = z
        parts.append(x.ravel())
    return np.concatenate(parts)


def _infos(case: Case, stack: _Stack, model: Model, scales: list[float]) -> tuple[SheetInfo, ...]:
    names = ["bottom-diaphragm", *(ply.name for ply in stack.plies), "top-diaphragm"]
    meshes: list[PlyMesh | DiaphragmMesh] = [stack.diaphragm, *stack.plies, stack.diaphragm]
    infos = []
    for k, (name, mesh) in enumerate(zip(names, meshes, strict=True)):
        s = model.sheets[k]
        a, n = int(s["node"]), int(s["rows"] * s["cols"])
        mass = float(model.mass[a : a + n].sum())
        scale = scales[k - 1] if s["kind"] != DIAPHRAGM else case.solver.diaphragm_mass_scaling
        kind = "diaphragm" if s["kind"] == DIAPHRAGM else "ply"
        true = mass / scale
        if isinstance(mesh, PlyMesh):
            true = stack.materials[k - 1].areal_density_gsm * TONNE_PER_GSM_MM2 * float(model.area[a : a + n].sum())
        infos.append(SheetInfo(name, kind, stack.thickness[k], scale, true, mass - true, mesh))
    return tuple(infos)
