"""From a case to a scene: sheets and tool as meshes, model, state at rest."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ddf.build.loads import load_path
from ddf.build.pairs import contact_pairs
from ddf.build.pools import node_pools, row_blocks
from ddf.build.sheets import sheet_records
from ddf.build.stack import Stack, flat_positions, mesh_stack, mesh_tool, nominal_height
from ddf.build.step import TONNE_PER_GSM_MM2, TONNE_PER_KG_M3, areal_masses, damp_fibres, step_limit
from ddf.build.summits import NO_SPOTS, first_spots, summit_records
from ddf.case import Case, hyperelastic_material
from ddf.contact.tool import FREE, POINTS
from ddf.dynamics import timestep
from ddf.elements.shell_membrane.history import HISTORY, M_C11, M_C22, S_C11, S_C22
from ddf.elements.shell_membrane.rotations import normals
from ddf.mesh.diaphragm import DiaphragmMesh
from ddf.mesh.ply import PlyMesh
from ddf.model import DIAPHRAGM, LEDGER, SHELL_PLY, SPRINGS, Model, State, sheet_shells, sheet_vectors
from ddf.scene import Scene, SheetInfo

FloatArray = NDArray[np.float64]


def build_scene(case: Case) -> Scene:
    """Mesh a case and assemble its model and initial state. Raises MeshError or CaseError."""
    stack = mesh_stack(case)
    tool_mesh, tool_field = (None, None) if case.tool is None else mesh_tool(case.tool)
    rubber = hyperelastic_material(case, case.diaphragms.material)
    terms = rubber.abaqus_terms
    sheets, laws, tables, tangents = sheet_records(case, stack, terms)
    scale, masses = areal_masses(case, stack, rubber.density_kg_m3 * TONNE_PER_KG_M3, tangents)
    damp_fibres(case, sheets, masses, tangents)
    limit = step_limit(case, stack, terms, masses, tangents)
    dt = limit if case.solver.step_s is None else case.solver.step_s
    pools = node_pools(stack, sheets, masses)
    pairs, exposed, places = contact_pairs(case, stack, masses, sheets)
    blocks = row_blocks(sheets)
    peaks = summit_records(tool_mesh, case.diaphragms.element_mm, 0.5 * stack.thickness[0])
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
        summits=peaks, gravity=np.zeros(3), dt=dt,
    )  # fmt: skip
    height = 0.0 if tool_mesh is None or case.tool is None else nominal_height(case.tool, tool_mesh)
    face = stack.z[0] - 0.5 * stack.thickness[0]
    spots = first_spots(peaks, stack.diaphragm)
    state = state_at_rest(model, flat_positions(stack), places, spots)
    return Scene(
        case=case, model=model, state=state, sheets=sheet_infos(case, stack, model, scale), path=load_path(case),
        base_z=face - height, tool_mesh=tool_mesh, tool_field=tool_field,
        step_limit=limit, first_step_s=dt,
    )  # fmt: skip


def sheet_infos(case: Case, stack: Stack, model: Model, scales: list[float]) -> tuple[SheetInfo, ...]:
    """What people call the sheets, and their masses with and without scaling."""
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


def state_at_rest(model: Model, x: FloatArray, places: FloatArray, spots: FloatArray = NO_SPOTS) -> State:
    """A fresh state: positions x (3 N,), first places of all pairs, nothing in motion, no tension, no anchor.

    spots: of the tool's summits, from `first_spots`.
    """
    sheet = model.sheets[model.tool_sheet]
    nodes = (int(sheet["rows"]), int(sheet["cols"])) if model.tool_sheet >= 0 else (1, 1)
    anchors = np.zeros((*nodes, POINTS, 3))
    anchors[..., 0] = FREE
    shells = model.sheets["kind"] == SHELL_PLY
    size = int((model.sheets["rows"] * model.sheets["cols"])[shells].sum())
    state = State(
        x=x, v=np.zeros_like(x), f=np.zeros_like(x),
        place=places, slip=np.zeros(2 * model.exposed.size), tool_anchor=anchors, spots=spots,
        press=np.zeros(model.mass.size), tension1=np.zeros(model.mass.size), tension2=np.zeros(model.mass.size),
        director=np.zeros(3 * size), spin=np.zeros(3 * size), pull=np.zeros(3 * size), history=np.zeros(HISTORY * size),
        ledger=np.zeros((model.blocks.size, LEDGER)), springs=np.zeros((model.blocks.size, SPRINGS)),
        clock=np.zeros(4),
    )  # fmt: skip
    for k in np.flatnonzero(shells):
        sheet_shells(model, state.history, int(k), HISTORY)[[M_C11, M_C22, S_C11, S_C22]] = 1.0
        sheet_shells(model, state.director, int(k), 3)[:] = normals(sheet_vectors(model, x, int(k)))
    return state
