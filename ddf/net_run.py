"""Run a kinematic case: drape each ply as a net and leave frames, tables, pictures and a report in a folder."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from ddf.build.stack import mesh_stack, mesh_tool
from ddf.case import Case, resolved_toml
from ddf.kinematic.drape import Drape, NetError, drape_ply
from ddf.mesh.distance import DistanceField
from ddf.mesh.ply import PlyMesh
from ddf.mesh.tool import TriangleMesh
from ddf.metrics import PlySurface, fibre_strain_range, outline_numbers, shear_angle, shear_statistics
from ddf.metrics.surface import cell_area
from ddf.output.folder import RunFolder
from ddf.output.snapshot import SheetSnapshot, extrapolated
from ddf.output.tables import write_metrics, write_pattern, write_profiles, write_wrinkles
from ddf.output.vtu import TOOL, write_pvd, write_sheet, write_tool
from ddf.provenance import peak_memory_mib, provenance

FLAT_TIME, DRAPED_TIME = 0.0, 1.0  # of the two frames; a net knows no time


@dataclass(frozen=True)
class NetResult:
    """What draping a case gave: wall time by phase, metrics of each ply (bottom first), notes."""

    wall_s: dict[str, float]
    plies: list[dict[str, Any]]
    notes: list[str]


def run_net(
    case: Case,
    folder: str | Path,
    *,
    case_text: str | None = None,
    replace: bool = False,
    notes: Sequence[str] = (),
    more: Mapping[str, Any] = MappingProxyType({}),
) -> NetResult:
    """Drape all plies of a case, each by itself on the tool, and write the results.

    notes: for the report, before its own; more: further entries of run.json.

    Raises NetError where a net cannot close, after the part that was laid has been written.
    """
    began = clock.perf_counter()
    out = RunFolder.create(folder, force=replace)
    out.write_text("case.toml", case_text if case_text is not None else resolved_toml(case))
    out.write_text("case.resolved.toml", resolved_toml(case))
    meshes, tool, field = _meshes(case)
    meshed = clock.perf_counter()
    drapes, failures = _drapes(case, meshes, field)
    wall = {"mesh": meshed - began, "net": clock.perf_counter() - meshed}
    surfaces = [net_surface(drape) for drape in drapes]
    tables = [net_metrics(drape, s, case.kinematic.locking_deg) for drape, s in zip(drapes, surfaces, strict=True)]
    notes = list(notes)
    _write_frames(out, drapes, surfaces, tool)
    write_metrics(out, tables)
    write_wrinkles(out, [])
    complete = [surface for surface in surfaces if surface.outline]
    write_profiles(out, complete)
    for surface in complete:
        write_pattern(out, surface)
    if case.output.pictures:
        try:
            _draw(out, surfaces, tool)
        except (ImportError, OSError, RuntimeError, ValueError) as error:
            notes.append(f"pictures are missing: {type(error).__name__}: {error}")
    wall["output"] = clock.perf_counter() - meshed - wall["net"]
    out.write_json("run.json", _info(case, drapes, wall, failures) | dict(more))
    _report(case, out, tables, wall, [f"FAILED: {failure}" for failure in failures] + notes)
    if failures:
        raise failures[0]
    return NetResult(wall, tables, notes)


def describe_net(case: Case) -> str:
    """What a kinematic case would lay, and whether it can be, as lines of text."""
    meshes, tool, field = _meshes(case)
    drapes, failures = _drapes(case, meshes, field)
    lines = [case.title or "(no title)", "", "model: pin-jointed net, each ply by itself; no forces, no diaphragms"]
    for drape in drapes:
        n, m = drape.state.shape
        x, y, z = drape.start_point
        lines.append(
            f"  {drape.mesh.name}: {n} x {m} nodes of {drape.mesh.spacing[0]:.4g} x {drape.mesh.spacing[1]:.4g} mm, "
            f"laid from ({x:.4g}, {y:.4g}, {z:.4g}) mm: {drape.laid_percent:.1f} % of the ply"
        )
    lines += [f"  {failure}" for failure in failures]
    lines.append("tool: none, flat platform" if case.tool is None or tool is None else f"tool: {case.tool.shape}")
    return "\n".join(lines)


def _meshes(case: Case) -> tuple[list[PlyMesh], TriangleMesh | None, DistanceField | None]:
    tool, field = (None, None) if case.tool is None else mesh_tool(case.tool)
    return mesh_stack(case).plies, tool, field


def _drapes(case: Case, meshes: list[PlyMesh], field: DistanceField | None) -> tuple[list[Drape], list[NetError]]:
    """All plies as far as they go, and the errors of those that do not go all the way."""
    drapes, failures = [], []
    for ply, mesh in zip(case.plies, meshes, strict=True):
        start = case.kinematic.start_mm or ply.offset_mm
        try:
            drapes.append(drape_ply(mesh, field, start, case.kinematic.offset_mm, case.kinematic.foot_radius_mm))
        except NetError as error:
            drapes.append(error.drape)
            failures.append(error)
    return drapes, failures


def net_surface(drape: Drape) -> PlySurface:
    """A draped ply as the metrics take it; without an outline where it is not laid to its edge."""
    mesh, laid = drape.mesh, drape.laid_cells
    padded = np.pad(laid, 1)
    active = padded[1:, 1:] | padded[:-1, 1:] | padded[1:, :-1] | padded[:-1, :-1]
    flat = np.array(mesh.x)
    flat[2] = drape.start_point[2]
    complete = drape.failed is None
    return PlySurface(
        name=mesh.name, x=extrapolated(np.where(active, drape.x, np.nan), active), x0=flat, spacing=mesh.spacing,
        active=active, cell_fraction=np.where(laid, mesh.cell_fraction, 0.0),
        outline=mesh.outline if complete else [], corners=mesh.corners if complete else [],
    )  # fmt: skip


def net_metrics(drape: Drape, surface: PlySurface, locking_deg: float) -> dict[str, Any]:
    """Shear, outline and locking of a draped ply, named as in a forming run."""
    low, high = fibre_strain_range(surface)
    area = cell_area(surface)
    locked = area[np.abs(shear_angle(surface)) > locking_deg].sum()
    x, y, z = (float(value) for value in drape.start_point)
    outline = outline_numbers(surface)
    if drape.failed is not None:  # what is laid has no outline
        outline = {key: None if isinstance(value, float) else value for key, value in outline.items()}
    return {
        "ply": surface.name,
        **outline,
        **shear_statistics(surface),
        "fibre_strain_min": low,
        "fibre_strain_max": high,
        "locking_deg": locking_deg,
        "locked_area_percent": 100.0 * float(locked / max(area.sum(), 1e-300)),
        "laid_percent": drape.laid_percent,
        "start_x_mm": x,
        "start_y_mm": y,
        "start_z_mm": z,
    }


def _write_frames(out: RunFolder, drapes: list[Drape], surfaces: list[PlySurface], tool: TriangleMesh | None) -> None:
    """Two frames of each ply, flat and draped, and the tool."""
    for drape, surface in zip(drapes, surfaces, strict=True):
        name, angle = surface.name, shear_angle(surface)
        whole = drape.mesh.cell_fraction > 0
        stages = (
            (FLAT_TIME, SheetSnapshot(name, "ply", surface.x0, whole, {}, {"shear_angle_deg": 0.0 * angle})),
            (DRAPED_TIME, SheetSnapshot(name, "ply", surface.x, drape.laid_cells, {}, {"shear_angle_deg": angle})),
        )
        files = []
        for number, (time, sheet) in enumerate(stages):
            file = f"frames/{name}-{number:04d}.vtu"
            if sheet.exists.any():
                write_sheet(out / file, sheet, time)
                files.append((time, file))
        write_pvd(out, name, files)
    if tool is not None:
        file = f"frames/{TOOL}-0000.vtu"
        write_tool(out / file, tool, 0.0, FLAT_TIME)
        write_pvd(out, TOOL, [(FLAT_TIME, file)])


def _draw(out: RunFolder, surfaces: list[PlySurface], tool: TriangleMesh | None) -> None:
    from ddf.output.figures import save_picture
    from ddf.output.plots import draw_formed, draw_outline, draw_shear

    for surface in surfaces:
        if not surface.active.any():
            continue
        sheet = SheetSnapshot(surface.name, "ply", surface.x, surface.cell_fraction > 0, {}, {})
        save_picture(out, f"formed-{surface.name}", draw_formed(sheet, surface))
        save_picture(out, f"shear-{surface.name}", draw_shear(surface))
        if surface.outline:
            save_picture(out, f"outline-{surface.name}", draw_outline(surface, None, tool))


def _info(case: Case, drapes: list[Drape], wall: dict[str, float], failures: list[NetError]) -> dict[str, Any]:
    return provenance() | {
        "case": case.title,
        "model": "kinematic",
        "threads": 1,
        "stop_reason": "failed" if failures else "finished",
        "message": "\n".join(str(failure) for failure in failures),
        "wall_s": {key: round(value, 4) for key, value in wall.items()},
        "peak_memory_MiB": peak_memory_mib(),
        "mesh": {"sheets": {d.mesh.name: {"rows": d.state.shape[0], "cols": d.state.shape[1]} for d in drapes}},
        "audit": [],
    }


def _report(case: Case, out: RunFolder, tables: list[dict[str, Any]], wall: dict[str, float], notes: list[str]) -> None:
    from ddf.output.report import Report, write_report

    versions = provenance()
    tool = "no tool" if case.tool is None else case.tool.shape
    write_report(out, Report(
        title=case.title or out.path.name,
        summary=f"Kinematic draping (pin-jointed net) of each ply by itself; {tool}. No forces, no wrinkles.",
        key_numbers={"wall time of the net": f"{1e3 * wall['net']:.0f} ms"}, plies=tables,
        settings=resolved_toml(case),
        versions={"ddf": versions["ddf"], "Python": versions["python"], **versions["packages"]}, notes=notes,
    ))  # fmt: skip
