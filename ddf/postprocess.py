"""After the last step: metrics, audit, tables, pictures and report of a run's folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ddf.build import build_scene
from ddf.case import case_from_dict
from ddf.errors import DdfError
from ddf.metrics import PlySurface, WrinkleResult, find_wrinkles, ply_metrics
from ddf.monitors.audit import WALL_TIME, Check, audit, history_checks
from ddf.monitors.energy import Energies, energies
from ddf.net_run import run_net
from ddf.output.checkpoint import load_checkpoint
from ddf.output.folder import RunFolder
from ddf.output.reopen import formed_ply
from ddf.output.results import open_run
from ddf.output.snapshot import ply_surface, take_snapshot
from ddf.output.tables import write_metrics, write_profiles, write_wrinkles
from ddf.scene import Scene


def measure(scene: Scene) -> tuple[list[PlySurface], list[WrinkleResult], list[dict[str, Any]]]:
    """Surfaces, wrinkles and metrics of all plies in the scene's present state, bottom ply first."""
    axis = (0.0, 0.0) if scene.case.tool is None else scene.case.tool.position_mm
    threshold = scene.case.output.wrinkle_threshold_mm
    surfaces = [ply_surface(scene, scene.state, k) for k in scene.ply_sheets]
    wrinkles = [find_wrinkles(surface, axis, threshold) for surface in surfaces]
    tables = [
        ply_metrics(surface, axis, threshold, wrinkles=found) for surface, found in zip(surfaces, wrinkles, strict=True)
    ]
    return surfaces, wrinkles, tables


def finish_folder(
    scene: Scene, out: RunFolder, energy: Energies, time: float, notes: list[str]
) -> tuple[list[Check], list[dict[str, Any]]]:
    """Write profiles, wrinkles.csv, metrics.json and pictures; returns the audit and the plies' metrics.

    Pictures that cannot be drawn (no fonts, no backend) are named in `notes`; the run does not fail for them.
    """
    scene = scene.whole()
    surfaces, wrinkles, tables = measure(scene)
    across = [found.smallest_elements_across for found in wrinkles if found.count]
    history = open_run(out.path).history()
    kinetic = float(history["kinetic_mJ"].max(initial=0.0))
    checks = audit(scene, energy, time, min(across) if across else None, kinetic) + history_checks(history)
    write_profiles(out, surfaces)
    write_wrinkles(out, wrinkles)
    write_metrics(out, tables, audit=checks)
    if scene.case.output.pictures:
        try:
            draw_pictures(scene, out, surfaces, wrinkles)
        except (ImportError, OSError, RuntimeError, ValueError) as error:
            notes.append(f"pictures are missing: {type(error).__name__}: {error}")
    return checks, tables


def draw_pictures(scene: Scene, out: RunFolder, surfaces: list[PlySurface], wrinkles: list[WrinkleResult]) -> None:
    """Draw the pictures of the scene's present state, and the energies from history.csv."""
    from ddf.output.charts import draw_energies, draw_stages
    from ddf.output.figures import save_picture
    from ddf.output.plots import draw_distance, draw_formed, draw_outline, draw_shear

    snapshot = take_snapshot(scene, scene.state)
    by_name = {surface.name: surface for surface in surfaces}
    for sheet in snapshot.sheets:
        if sheet.kind == "ply" or sheet.name == "top-diaphragm":
            picture = draw_formed(sheet, by_name.get(sheet.name))
            save_picture(out, f"formed-{sheet.name}", picture)
    for surface, found in zip(surfaces, wrinkles, strict=True):
        save_picture(out, f"shear-{surface.name}", draw_shear(surface))
        save_picture(out, f"outline-{surface.name}", draw_outline(surface, found, scene.tool_mesh))
        if scene.tool_mesh is not None:
            save_picture(out, f"distance-{surface.name}", draw_distance(surface))
    run, top = open_run(out.path), surfaces[-1].name
    save_picture(out, "energies", draw_energies(run.history(), scene.path))
    if (out / f"{top}.pvd").is_file():
        times = [time for time, _ in run.frames(top)]
        ends = [(min(end, times[-1]), int(np.argmin(np.abs(np.array(times) - end)))) for end in scene.path.time[1:]]
        frames = [(end, formed_ply(run, top, number)) for end, number in ends]
        save_picture(out, "stages", draw_stages(scene.path, frames))


def report_of(scene: Scene, out: RunFolder, notes: list[str]) -> Path:
    """Write report.html from what the folder holds (run.json, metrics.json, pictures); returns its path."""
    from ddf.output.report import Report, write_report

    run = open_run(out.path)
    info = run.info
    case = scene.case
    tool = "no tool" if case.tool is None else f"{case.tool.shape}, fillet {case.tool.fillet_mm:g} mm"
    stack = ", ".join(f"{ply.name} at {ply.orientation_deg:g} deg ({ply.element_mm:g} mm)" for ply in case.plies)
    history = run.history()
    last = {name: values[-1] for name, values in history.items() if name.endswith(("_mJ", "_percent"))}
    summary = f"{stack} between two {case.diaphragms.thickness_mm:g} mm diaphragms; {tool}."
    plies = run.metrics["plies"]
    gaps = [ply["bridging_largest_mm"] for ply in plies if ply.get("bridging_largest_mm") is not None]
    meshed = info["mesh"]["sheets"].values()
    added, true = (sum(sheet[name] for sheet in meshed) for name in ("added_mass_g", "mass_g"))
    key_numbers = {
        "wrinkles": sum(ply["wrinkle_count"] for ply in plies),
        "highest wrinkle": f"{max(ply['wrinkle_largest_amplitude_mm'] for ply in plies):.1f} mm",
        "shear angle, 99 % of the area below": f"{max(ply['shear_p99_deg'] for ply in plies):.0f} deg",
        **({"largest gap to the tool outside wrinkles": f"{max(gaps):.1f} mm"} if gaps else {}),
        "process time": f"{info['process_time_s']:.4g} s",
        f"steps of {info['step_s']:.3g} s": info["step"],
        "wall time of the steps": f"{info['wall_s'].get('steps', 0.0):.0f} s on "
        + ("1 thread" if info["threads"] == 1 else f"{info['threads']} threads"),
        "added mass (true mass)": f"{added:.0f} g ({true:.0f} g)",
    }  # fmt: skip
    if "half_model" in info:
        key_numbers["half model"] = f"{info['half_model']} was computed"
    if "fidelity" in info:
        key_numbers["fidelity, chosen"] = f"{info['fidelity']['rung']} ({info['fidelity']['why']})"
    report = Report(
        title=case.title or out.path.name, summary=summary, key_numbers=key_numbers,
        plies=plies, audit=info["audit"], energies=last, settings=run.resolved_text,
        versions={"ddf": info["ddf"], "Python": info["python"], **info["packages"]}, notes=notes,
    )  # fmt: skip
    write_report(out, report)
    return out / "report.html"


def rebuild_report(path: Path) -> Path:
    """Measure, draw and report a run again from its last checkpoint (a net: lay it again); returns the report."""
    import tomllib

    run = open_run(path)
    case = case_from_dict(tomllib.loads(run.resolved_text))
    if case.model == "kinematic":
        run_net(case, path, case_text=run.case_text, replace=True)
        return path / "report.html"
    scene = build_scene(case)
    out = RunFolder(path)
    load_checkpoint(out, scene)
    time = float(scene.state.clock[1])
    if run.info["stop_reason"] != "finished":
        raise DdfError(f"{path} holds an unfinished run, at {time:.5f} s", "finish it with ddf run --resume")
    notes: list[str] = []
    whole = scene.whole()
    checks, _ = finish_folder(whole, out, energies(whole.model, whole.state), time, notes)
    timed = [check for check in run.info.get("audit", []) if check["name"] == WALL_TIME]  # cannot be measured again
    out.write_json("run.json", run.info | {"audit": checks + timed})
    return report_of(scene, out, notes)
