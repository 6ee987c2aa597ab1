"""Guards of contact: sheets that have passed through the tool or the platform, and places that were lost."""

from __future__ import annotations

import numpy as np

from ddf.model import Model, State, sheet_scalars, sheet_vectors
from ddf.monitors.alarm import Alarm, alarm_at
from ddf.scene import Scene

PLY_IN_TOOL_MM = 1.0
"""A ply's mid-surface deeper in the tool than this has gone through the diaphragm (the audit's limit is 0.5)."""

LOST_SHARE = 0.05
"""Share of the nodes of a sheet that are over fabric of another, and pressed, or gone through it, that may be lost at
a time: single ones are, at tips of cuts and in tight folds, and find back."""
FEWEST_LOST = 10


def check_passage(scene: Scene, time: float) -> Alarm | None:
    """Look for sheets where they cannot be: in the tool, or on the other side of their neighbour."""
    return _in_tool(scene, time) or _lost_places(scene)


def _in_tool(scene: Scene, time: float) -> Alarm | None:
    """Mid-surface nodes inside tool or platform: of the sheet that meets them, and of the plies."""
    if scene.tool_field is None:
        return None
    sheets = [(scene.model.tool_sheet, 0.0), *((k, PLY_IN_TOOL_MM) for k in scene.ply_sheets)]
    for k, allowed in sheets:
        there = np.argwhere(sheet_scalars(scene.model, scene.model.mass, k) > 0.0)
        x = sheet_vectors(scene.model, scene.state.x, k)
        depth = -scene.obstacle_distance(np.ascontiguousarray(x[:, there[:, 0], there[:, 1]].T), time)
        worst = int(np.argmax(depth))
        if depth[worst] > allowed:
            problem = f"a mid-surface {depth[worst]:.2g} mm inside the tool or its platform"
            cause = "the tool's edge came through between nodes, or a contact too soft for what presses on it"
            key = "diaphragms.element_mm, tool.fillet_mm or solver.tool_contact_stiffness_N_mm3"
            return alarm_at(scene.sheets[k].name, x, (there[worst, 0], there[worst, 1]), problem, cause, key)
    return None


def lost_nodes(model: Model, state: State, number: int) -> tuple[np.ndarray, int]:
    """Nodes (k, 2) of the slave of a pair that lie over fabric of its master, through its surface, but are not held.

    Second: how many are held. Contact keeps a gap below 0 for nodes that it holds, and 0 for others below the surface:
    they are off the fabric, or too deep to have been pressed there, or their projection has failed.
    """
    pair = model.pairs[number]
    slave, master = (model.sheets[int(pair[key])] for key in ("slave", "master"))
    rows, cols = int(slave["rows"]), int(slave["cols"])
    first = int(pair["first"])
    u, v, gap = state.place[5 * first : 5 * (first + rows * cols)].reshape(5, rows, cols)[:3]
    followed = model.exposed[first : first + rows * cols].reshape(rows, cols)
    held = int(np.count_nonzero(followed & (gap < 0.0)))
    n, m = int(master["rows"]) - 1, int(master["cols"]) - 1
    nodes = np.argwhere(followed & (gap == 0.0) & (u >= 0.0) & (v >= 0.0) & (u < n) & (v < m))
    if not len(nodes):
        return nodes, held
    u, v = u[tuple(nodes.T)], v[tuple(nodes.T)]
    i, j = u.astype(int), v.astype(int)
    cover = sheet_scalars(model, model.cover, int(pair["master"])) >= 1.0
    whole = cover[i, j] & cover[i + 1, j] & cover[i, j + 1] & cover[i + 1, j + 1]
    fabric = sheet_scalars(model, model.cell, int(pair["master"]))[i, j] > 0.0
    surface, normal = _bilinear(sheet_vectors(model, state.x, int(pair["master"])), i, j, u - i, v - j)
    height = ((sheet_vectors(model, state.x, int(pair["slave"]))[:, nodes[:, 0], nodes[:, 1]] - surface) * normal).sum(
        axis=0
    )
    return nodes[whole & fabric & (float(pair["sign"]) * height < 0.0)], held


def _bilinear(
    x: np.ndarray, i: np.ndarray, j: np.ndarray, r: np.ndarray, s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Places and unit normals (3, k) at (r, s) in cells (i, j) of x (3, n, m)."""
    a, b, c, d = x[:, i, j], x[:, i + 1, j], x[:, i, j + 1], x[:, i + 1, j + 1]
    along = (1 - s) * (b - a) + s * (d - c)
    across = (1 - r) * (c - a) + r * (d - b)
    normal = np.cross(along, across, axis=0)
    place = (1 - r) * (1 - s) * a + r * (1 - s) * b + (1 - r) * s * c + r * s * d
    return place, normal / np.maximum(np.linalg.norm(normal, axis=0), 1e-30)


def _lost_places(scene: Scene) -> Alarm | None:
    """Pairs of sheets that have lost one another over more than single nodes."""
    for number, pair in enumerate(scene.model.pairs):
        lost, held = lost_nodes(scene.model, scene.state, number)
        if len(lost) > max(FEWEST_LOST, LOST_SHARE * (held + len(lost))):
            slave, master = (int(pair[key]) for key in ("slave", "master"))
            problem = f"{len(lost)} nodes have gone through {scene.sheets[master].name} or lost their place on it"
            cause = "sheets thrown on each other too fast, a fold tighter than the elements, or a step too long"
            key = "process.stages (slower), solver.contact_stiffness_N_mm3 or the element sizes"
            x = sheet_vectors(scene.model, scene.state.x, slave)
            return alarm_at(scene.sheets[slave].name, x, (lost[0, 0], lost[0, 1]), problem, cause, key)
    return None
