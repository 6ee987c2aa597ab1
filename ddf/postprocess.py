"""After the last step: metrics, audit, tables, pictures and report of a run's folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ddf.build import build_scene
from ddf.case import case_from_dict
from ddf.errors import DdfError
from ddf.metrics import PlySurface, WrinkleResult, find_wrinkles, ply_metrics
from ddf.monitors.audit import Check, audit
from ddf.monitors.energy import Energies, energies
from ddf.output.checkpoint import load_checkpoint
from ddf.output.folder import RunFolder
from ddf.output.results import open_run
from ddf.output.snapshot import ply_surface
from ddf.output.tables import write_metrics, write_profiles, write_wrinkles
from ddf.scene import Scene


def measure(scene: Scene) -> tuple[list[PlySurface], list[WrinkleResult], list[dict[str, Any]]]:
    """Surfaces, wrinkles and metrics of all plies in the scene's present state, bottom ply first."""
    axis = (0.0, 0.0) if scene.case.tool is None else scene.case.tool.position_mm
    threshold = scene.case.output.wrinkle_threshold_mm
    surfaces = [ply_surface(scene, scene.state, k) for k in scene.ply_sheets]
    wrinkles = [find_wrinkles(surface, axis, threshold) for surface in surfaces]
    tables = [
        ply_metrics(surface, axis, threshold, wrinkles=found)
        for surface, found in zip(surfaces, wrinkles, strict=True)
    ]
    return surfaces, wrinkles, tables


def finish_folder(
    scene: Scene, out: RunFolder, energy: Energies, time: float, notes: list[str]
) -> tuple[list[Check], list[dict[str, Any]]]:
    """Write profiles, wrinkles.csv, metrics.json and pictures; returns the audit and the plies' metrics.

    Pictures that cannot be drawn (no fonts, no backend) are named in `notes`; the run does not fail for them.
    """
    surfaces, wrinkles, tables = measure(scene)
    across = [found.smallest_elements_across for found in wrinkles if found.count]
    checks = audit(scene, energy, time, min(across) if across else None)
    write_profiles(out, surfaces)
    write_wrinkles(out, wrinkles)
    write_metrics(out, tables, audit=checks)
    if scene.case.output.pictures:
        try:
            from ddf.output.plots import draw_pictures

            draw_pictures(out, scene, surfaces, wrinkles)
        except (ImportError, OSError, RuntimeError, ValueError) as error:
            notes.append(f"pictures are missing: {type(error).__name__}: {error}")
    return checks, tables


def write_report(out: RunFolder) -> Path:
    """Write report.html from what the folder holds and return its path."""
    from ddf.output.report import report_html

    return out.write_text("report.html", report_html(open_run(out.path)))


def rebuild_report(path: Path) -> Path:
    """Measure, draw and report a run again from its last checkpoint; returns the report's path."""
    import tomllib

    run = open_run(path)
    scene = build_scene(case_from_dict(tomllib.loads(run.resolved_text)))
    out = RunFolder(path)
    load_checkpoint(out, scene)
    time = float(scene.state.clock[1])
    if time < scene.path.duration - scene.model.dt:
        raise DdfError(f"{path} holds an unfinished run, at {time:.5f} s", "finish it with ddf run --resume")
    notes: list[str] = []
    finish_folder(scene, out, energies(scene.model, scene.state), time, notes)
    return write_report(out)


