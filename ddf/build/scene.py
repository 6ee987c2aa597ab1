"""From a case to a scene: sheets and tool as meshes, model, state at rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ddf.build.blocks import row_blocks
from ddf.build.half import halve
from ddf.build.loads import load_path
from ddf.build.pairs import contact_pairs
from ddf.build.pools import node_pools
from ddf.build.rest import state_at_rest
from ddf.build.rim import RINGS, no_rims, rim_entries, rim_lists
from ddf.build.sheets import sheet_records
from ddf.build.stack import Stack, flat_positions, mesh_stack, mesh_tool, nominal_height
from ddf.build.step import TONNE_PER_GSM_MM2, TONNE_PER_KG_M3, areal_masses, damp_fibres, step_limit
from ddf.build.summits import first_spots, summit_records
from ddf.case import Case, hyperelastic_material
from ddf.contact.bed import MASSES
from ddf.contact.tool_point import BACK
from ddf.mesh.diaphragm import DiaphragmMesh
from ddf.mesh.ply import PlyMesh
from ddf.model import Model, without_mirror
from ddf.scene import Scene, SheetInfo

FloatArray = NDArray[np.float64]


def build_scene(case: Case, rings: int = RINGS) -> Scene:
    """Mesh a case and assemble its model and initial state. Raises MeshError or CaseError.

    With `solver.symmetry` "auto" a scene that is its own mirror image becomes a half model, on grids with a line in the
    middle. rings: of grid nodes around plies for their rims (`build.rim`); 0 for problems that hold edges of a ply.
    """
    if case.solver.symmetry == "off":
        return _whole_scene(case, False, rings)
    half = halve(_whole_scene(case, True, rings))
    return half if half.half is not None else replace(_whole_scene(case, False, rings), symmetry=half.symmetry)


def _whole_scene(case: Case, even: bool, rings: int) -> Scene:
    """The whole scene of a case; even: whether all grids get an even number of cells along both directions."""
    stack = mesh_stack(case, even, rings)
    tool_mesh, tool_field = (None, None) if case.tool is None else mesh_tool(case.tool)
    rubber = hyperelastic_material(case, case.diaphragms.material)
    terms = rubber.abaqus_terms
    sheets, laws, tables, tangents = sheet_records(case, stack, terms)
    scale, masses = areal_masses(case, stack, terms, rubber.density_kg_m3 * TONNE_PER_KG_M3, tangents)
    damp_fibres(case, sheets, masses, tangents)
    limit = step_limit(case, stack, terms, masses, tangents)
    dt = limit if case.solver.step_s is None else case.solver.step_s
    sheets["bed_stiffness"] = [min(case.solver.tool_contact_stiffness_N_mm3, MASSES * m / dt**2) for m in masses]
    none = no_rims(1)
    rims = none + [rim_entries(ply.active) for ply in stack.plies] + none
    pools = node_pools(stack, sheets, masses, rims)
    pairs, exposed, places = contact_pairs(case, stack, masses, sheets)
    blocks = row_blocks(sheets)
    peaks = summit_records(tool_mesh, case.diaphragms.element_mm, 0.5 * stack.thickness[0])
    friction, solver = case.friction, case.solver
    values = np.zeros((2, 2, 2, 4), np.float32) if tool_field is None else tool_field.values
    lines = np.concatenate([np.diff(stack.diaphragm.x_lines), np.diff(stack.diaphragm.y_lines)])
    unstretched = lines / case.diaphragms.pre_stretch
    walls = [line[end] for line in (stack.diaphragm.x_lines, stack.diaphragm.y_lines) for end in (0, -1)]
    model = Model(
        sheets=sheets, blocks=blocks, pairs=pairs, **pools, **rim_lists(rims, sheets, blocks),
        **without_mirror(pools["inverse_mass"], len(blocks)), lines=unstretched, tool_lines=lines,
        shear_tables=laws, tangents=tables, ogden=np.array(terms, dtype=float), exposed=exposed, tool=values,
        tool_origin=np.zeros(3) if tool_field is None else np.asarray(tool_field.origin, dtype=float),
        tool_spacing=1.0 if tool_field is None else float(tool_field.spacing),
        tool_sheet=-1 if tool_field is None else 0, tool_offset=0.5 * stack.thickness[0],
        tool_stiffness=solver.tool_contact_stiffness_N_mm3,
        tool_damping=BACK * dt * solver.tool_contact_stiffness_N_mm3,
        tool_mass=masses[0], tool_friction=friction.diaphragm_tool, tool_boxed=True,
        tool_walls=np.array(walls),
        summits=peaks, gravity=np.zeros(3), dt=dt,
    )  # fmt: skip
    height = 0.0 if tool_mesh is None or case.tool is None else nominal_height(case.tool, tool_mesh)
    face = stack.z[0] - 0.5 * stack.thickness[0]
    spots = first_spots(peaks, stack.diaphragm)
    state = state_at_rest(model, flat_positions(stack), places, spots)
    return Scene(
        case=case, model=model, state=state, path=load_path(case),
        sheets=sheet_infos(case, stack, model, scale, masses[0] / solver.diaphragm_mass_scaling),
        base_z=face - height, tool_mesh=tool_mesh, tool_field=tool_field,
        step_limit=limit, first_step_s=dt,
    )  # fmt: skip


def sheet_infos(case: Case, stack: Stack, model: Model, scales: list[float], skin: float) -> tuple[SheetInfo, ...]:
    """What people call the sheets, and their masses with and without scaling; skin: a diaphragm's own [tonne/mm2]."""
    names = ["bottom-diaphragm", *(ply.name for ply in stack.plies), "top-diaphragm"]
    meshes: list[PlyMesh | DiaphragmMesh] = [stack.diaphragm, *stack.plies, stack.diaphragm]
    infos = []
    for k, (name, mesh) in enumerate(zip(names, meshes, strict=True)):
        s = model.sheets[k]
        a, n = int(s["node"]), int(s["rows"] * s["cols"])
        mass = float(model.mass[a : a + n].sum())
        if isinstance(mesh, PlyMesh):
            kind, scale = "ply", scales[k - 1]
            true = stack.materials[k - 1].areal_density_gsm * TONNE_PER_GSM_MM2 * float(model.area[a : a + n].sum())
        else:
            kind, scale = "diaphragm", case.solver.diaphragm_mass_scaling
            between = [float((0.5 * (line[2:] - line[:-2])).sum()) for line in (mesh.x_lines, mesh.y_lines)]
            true = skin * between[0] * between[1]
        infos.append(SheetInfo(name, kind, stack.thickness[k], scale, true, mass - true, mesh))
    return tuple(infos)
