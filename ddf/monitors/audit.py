"""The audit after a run: which assumptions of the model held, each with its limit and what it means."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypedDict

import numpy as np

from ddf.model import sheet_scalars, sheet_vectors
from ddf.monitors.crossings import layer_crossings, self_crossings
from ddf.monitors.energy import Energies
from ddf.monitors.layers import DEEP, depth_in_layers, depths
from ddf.monitors.stability import fibre_stretch
from ddf.monitors.zigzag import zigzag_share
from ddf.scene import Scene

WALL_TIME = "wall time of the steps"

REMEDIES = {
    "kinetic over internal energy": "a longer last stage, or more mass damping in it (process.stages.mass_damping_1_s)",
    "energy balance error": "a smaller solver.step_safety, longer stages; do not use the results as they are",
    "energy given back by what only takes": "a smaller solver.step_safety; do not use the results as they are",
    "taken by waves of the fibres": "longer stages: fibres are jerked",
    "taken by mass damping": "longer stages with less damping; compare the part with one of twice the durations",
    "deepest penetration of the tool": "smaller diaphragms.element_mm, a larger solver.tool_contact_stiffness_N_mm3",
    "largest fibre strain": "see where (fibre_strain_1, _2 in the frames): a few bars over an apex are harmless",
    "added mass": "only a statement where kinetic energies are low; less solver.mass_scaling costs steps",
    "edges of a sheet through itself": "solver.self_contact = true, smaller plies.element_mm; do not trust that fold",
    "edges of layers through each other": "smaller elements: those at the tool's sharpest place are as wide as it",
    "nodes deep in the next layer": "a larger solver.contact_stiffness_N_mm3, smaller elements",
    "deepest node in the next layer": "a larger solver.contact_stiffness_N_mm3, smaller elements; harmless below 100 %",
    "largest kinetic over final internal energy": "longer stages, or less mass: see whether the part changes",
    "deepest place of a ply in the tool": "smaller elements, a larger fillet; the part is wrong there",
    "deepest self-contact": "smaller plies.element_mm",
    "gap over the tool's apex": "smaller elements; more lift or pressure if it is more than an element",
    "elements across the narrowest wrinkle": "smaller plies.element_mm: sizes of the narrowest wrinkles are coarse",
    "nodes in a zigzag of the grid": "smaller plies.element_mm, longer stages",
    WALL_TIME: "a lower rung (target.seconds), more threads",
}
"""What to do about a check that is missed."""

LEAST_WORK = 100.0
"""Shares of the work are taken of at least this much [mJ]."""

SAMPLES = 5
"""Points along each side of a cell where penetration is measured."""


class Check(TypedDict):
    """One line of the audit."""

    name: str
    value: float
    limit: float
    unit: str
    ok: bool
    meaning: str  # what is so where it is ok
    remedy: str  # what to do where it is not


def deepest_penetration(scene: Scene, time: float) -> float:
    """Deepest point of the tool-side face of the tool's sheet in the tool or platform [mm], dense sample.

    The face is the mid-surface (bilinear in each cell) less half a thickness along the tool's gradient.
    """
    if scene.tool_field is None:
        return 0.0
    x = sheet_vectors(scene.model, scene.state.x, scene.model.tool_sheet)
    deepest = -np.inf
    for p in _samples(x):
        d = scene.obstacle_distance(p, time)
        deepest = max(deepest, float(np.max(scene.model.tool_offset - d)))
    return max(deepest, 0.0)


def ply_inside_tool(scene: Scene, time: float) -> float:
    """Deepest node of any ply's mid-surface inside the tool [mm]: there only if the sheets below let it by."""
    deepest = 0.0
    for k in scene.ply_sheets:
        active = sheet_scalars(scene.model, scene.model.mass, k) > 0
        points = np.ascontiguousarray(sheet_vectors(scene.model, scene.state.x, k)[:, active].T)
        deepest = max(deepest, float(-scene.obstacle_distance(points, time).min()))
    return deepest


def _samples(x: np.ndarray) -> Iterator[np.ndarray]:
    """SAMPLES x SAMPLES points of every bilinear cell of x (3, n, m), (k, 3) at a time."""
    share = (np.arange(SAMPLES) + 0.5) / SAMPLES
    for a in share:
        for b in share:
            p = (
                (1 - a) * (1 - b) * x[:, :-1, :-1]
                + a * (1 - b) * x[:, 1:, :-1]
                + (1 - a) * b * x[:, :-1, 1:]
                + a * b * x[:, 1:, 1:]
            )
            yield p.reshape(3, -1).T


def apex_gap(scene: Scene, time: float) -> float:
    """Least distance between the tool's highest point and the tool-side face of its sheet [mm], dense sample."""
    if scene.tool_mesh is None:
        return 0.0
    points = scene.tool_mesh.points
    top = points[np.argmax(points[:, 2])] + [0.0, 0.0, scene.tool_z(time)]
    x = sheet_vectors(scene.model, scene.state.x, scene.model.tool_sheet)
    nearest = min(float(((p - top) ** 2).sum(axis=1).min()) for p in _samples(x))
    return float(np.sqrt(nearest) - scene.model.tool_offset)


def fibre_strain_range(scene: Scene) -> tuple[float, float]:
    """Least and largest fibre strain ln(lambda) of all plies."""
    low, high = 0.0, 0.0
    for k in scene.ply_sheets:
        for strain in fibre_stretch(scene.model, sheet_vectors(scene.model, scene.state.x, k), k):
            low, high = min(low, float(strain.min())), max(high, float(strain.max()))
    return low, high


def self_contact(scene: Scene) -> tuple[int, float]:
    """How many nodes touch their own sheet, and the deepest of them over the distance at which it touches itself."""
    model, count, deepest = scene.model, 0, 0.0
    for pair in model.pairs[model.pairs["slave"] == model.pairs["master"]]:
        sheet = model.sheets[pair["slave"]]
        first, nodes = int(pair["first"]), int(sheet["rows"] * sheet["cols"])
        touches = scene.state.place[5 * first : 5 * (first + nodes)].reshape(5, nodes)[2] < 0.0
        count += int(np.count_nonzero(touches))
        deepest = max(deepest, float(depths(scene, pair, touches).max(initial=0.0)))
    return count, deepest


def audit(
    scene: Scene, energy: Energies, time: float, elements_across: float | None, peak_kinetic: float = 0.0
) -> list[Check]:
    """All checks of a finished run. elements_across: least number of elements across a wrinkle, if any.

    peak_kinetic: largest kinetic energy on the way [N mm].
    """
    low, high = fibre_strain_range(scene)
    added = sum(s.added_mass for s in scene.sheets) / sum(s.true_mass for s in scene.sheets)
    checks = [
        _check("kinetic over internal energy", 100 * energy.kinetic_share(), 2.0, "%", "the sheets have come to rest"),
        _check("energy balance error", abs(100 * energy.error_share), 1.0, "% of work", "no energy came from nowhere"),
        _check("deepest penetration of the tool", deepest_penetration(scene, time), 0.2, "mm", "contact was stiff"),
        _check("largest fibre strain", 100 * max(-low, high), 0.3, "%", "fibres are as good as inextensible"),
        _check("added mass", 100 * added, 50.0, "% of the true mass", "mass scaling is small"),
    ]
    checks.append(crossing_check(sum(self_crossings(scene).values())))
    if scene.model.pairs.size:
        edges = sum(layer_crossings(scene).values())
        checks.append(
            _check("edges of layers through each other", edges, 0.0, "", "cells of layers do not cut each other")
        )
        deep, deepest = depth_in_layers(scene)
        meaning = "contact of layers was stiff"
        checks.append(_check("nodes deep in the next layer", 100.0 * deep, 1.0, "% of a sheet", meaning))
        meaning = "layers lie in their order everywhere; over 100 % a node is through the next layer"
        name = "deepest node in the next layer"
        checks.append(_check(name, 100.0 * deepest, 100.0 * DEEP, "% of their distance", meaning))
    if scene.tool_field is not None:
        peak = 100.0 * peak_kinetic / max(energy.total_strain, 1e-12)
        meaning = "sheets were not thrown on the tool; slower loads may still change the part"
        checks.append(_check("largest kinetic over final internal energy", peak, 30.0, "%", meaning))
        inside = ply_inside_tool(scene, time)
        checks.append(_check("deepest place of a ply in the tool", inside, 0.5, "mm", "no ply is in the tool"))
    touching, depth = self_contact(scene)
    if touching:
        meaning = f"folds that close keep their thickness ({touching} nodes touch their own sheet)"
        checks.append(_check("deepest self-contact", 100 * depth, 50.0, "% of thickness", meaning))
    if scene.tool_mesh is not None:
        checks.append(_check("gap over the tool's apex", apex_gap(scene, time), 1.0, "mm", "the tool is covered"))
    if elements_across is not None:
        checks.append(across_check(elements_across))
    checks.append(zigzag_check(scene))
    return checks


def history_checks(history: Mapping[str, Sequence[float] | np.ndarray]) -> list[Check]:
    """Checks of what history.csv holds: what was dissipated must not come back, nor be what decides on the part.

    The balance alone cannot see a fault of the implicit steps (fibres, tool): what they take is known only as what is
    missing (`monitors.energy`). That it grows, always, and is little, is what shows that they take it.
    """
    lost = {name: np.asarray(history[name], dtype=float) for name in history if name.startswith("dissipated_")}
    if not lost or not all(column.size for column in lost.values()):
        return []
    work = sum(float(history[name][-1]) for name in history if name.startswith("work_"))
    scale = 100.0 / max(abs(work), LEAST_WORK)
    back = sum(float(-np.minimum(np.diff(column), 0.0).sum()) for column in lost.values())
    checks = [
        _check(
            "energy given back by what only takes",
            scale * back,
            0.1,
            "% of work",
            "friction, damping and waves only take",
        )
    ]
    for name, column, limit in (
        ("taken by waves of the fibres", "dissipated_fibre_waves_mJ", 3.0),
        ("taken by mass damping", "dissipated_mass_damping_mJ", 50.0),
    ):
        if column in lost:
            checks.append(
                _check(name, scale * float(lost[column][-1]), limit, "% of work", "it does not decide on the part")
            )
    return checks


def across_check(elements_across: float) -> Check:
    """Whether there are elements enough across the narrowest wrinkle."""
    check = _check("elements across the narrowest wrinkle", elements_across, 6.0, "", "wrinkles are resolved")
    check["ok"] = elements_across >= check["limit"]
    return check


def time_check(seconds: float, target: float) -> Check:
    """Whether steps took no longer than was asked for."""
    return _check(WALL_TIME, seconds, target, "s", "the rung was as quick as it was taken for")


def crossing_check(edges: int) -> Check:
    """Whether folds do not pass through themselves."""
    return _check("edges of a sheet through itself", edges, 0.0, "", "folds have not passed through themselves")


def zigzag_check(scene: Scene) -> Check:
    """Whether wrinkles are not locked to the grid."""
    share = 100.0 * zigzag_share(scene)
    return _check("nodes in a zigzag of the grid", share, 1.0, "% of a ply", "wrinkles are not locked to the grid")


def _check(name: str, value: float, limit: float, unit: str, meaning: str) -> Check:
    return Check(
        name=name, value=float(value), limit=limit, unit=unit, ok=bool(value <= limit), meaning=meaning,
        remedy=REMEDIES[name],
    )  # fmt: skip
