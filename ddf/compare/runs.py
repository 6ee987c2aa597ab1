"""Compare two finished runs, and a measured outline with both: numbers, tables and pictures in a folder."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.compare.fields import ShearDifference, shear_difference
from ddf.compare.outlines import (
    Distances,
    RigidFit,
    fit_points,
    outline_distances,
    point_distances,
    read_points,
)
from ddf.compare.sites import Site, match_wrinkles
from ddf.errors import UsageError
from ddf.metrics import PlySurface
from ddf.output.folder import RunFolder
from ddf.output.reopen import formed_ply, plies_of
from ddf.output.results import FinishedRun, open_run
from ddf.provenance import provenance

Array = NDArray[np.float64]

#: numbers of a ply that are set beside one another, where both runs have them
NUMBERS = (
    "wrinkle_count", "wrinkle_total_length_mm", "wrinkle_largest_amplitude_mm", "wrinkled_area_percent",
    "shear_max_deg", "shear_p95_deg", "shear_mean_deg", "outline_area_mm2", "outline_length_mm",
    "bridging_largest_mm", "bridged_area_percent", "locked_area_percent",
)  # fmt: skip


@dataclass(frozen=True)
class Measured:
    """A measured outline against one run's outline."""

    run: str
    ply: str
    fit: RigidFit | None  # None: taken as given
    distances: Distances


@dataclass(frozen=True)
class PlyComparison:
    """One ply of both runs."""

    ply: str
    numbers: dict[str, tuple[float, float]]  # key with unit: value of either run
    outline: Distances | None  # None where a run has no outline
    sites: list[Site]
    shear: ShearDifference


@dataclass(frozen=True)
class Comparison:
    """Two runs, ply by ply, and what was measured."""

    labels: tuple[str, str]
    paths: tuple[Path, Path]
    plies: list[PlyComparison]
    measured: list[Measured]
    notes: list[str]


def compare_runs(
    first: Path, second: Path, folder: Path, profile: Path | None = None, align: bool = False,
    profile_ply: str | None = None, force: bool = False, pictures: bool = True,
) -> Comparison:  # fmt: skip
    """Compare two run folders and write comparison.json, metrics.csv, wrinkles.csv and pictures into `folder`.

    `profile`: CSV of a measured outline of ply `profile_ply` (left out: the top one), taken in the frame's
    coordinates or with `align` by the best rigid fit to each run. Raises UsageError where nothing can be compared.
    """
    points = None if profile is None else read_points(profile)
    runs = (open_run(first), open_run(second))
    labels = _labels(first, second)
    common, notes = _common_plies(runs, labels)
    if profile_ply is not None and profile_ply not in common:
        raise UsageError(f"no ply is called {profile_ply!r} in both runs", f"plies: {', '.join(common)}")
    out = RunFolder.create(folder, force=force)
    plies, measured = [], []
    for ply in common:
        surfaces = [formed_ply(run, ply) for run in runs]
        outlines = [_outline(run, ply) for run in runs]
        wrinkles = [[row for row in run.wrinkles() if row["ply"] == ply] for run in runs]
        shear = shear_difference(surfaces[0], surfaces[1])
        nets = [label for run, label in zip(runs, labels, strict=True) if not _knows_wrinkles(run, ply)]
        notes += [f"{label} is a net: it knows nothing of wrinkles" for label in nets]
        plies.append(PlyComparison(
            ply, _numbers(runs, ply), outline_distances(outlines[0], outlines[1]) if all(outlines) else None,
            [] if nets else match_wrinkles(ply, wrinkles[0], wrinkles[1]), shear,
        ))  # fmt: skip
        shown = points if ply == (profile_ply or common[-1]) else None
        if shown is not None:
            measured = [_measure(label, ply, shown, loops, align)
                        for label, loops in zip(labels, outlines, strict=True) if loops]  # fmt: skip
        if pictures:
            _draw(out, surfaces, labels, outlines, wrinkles, shear, shown, measured)
    result = Comparison(labels, (first, second), plies, measured, notes)
    _write(out, result)
    return result


def _knows_wrinkles(run: FinishedRun, ply: str) -> bool:
    return any("wrinkle_count" in table for table in run.metrics["plies"] if table["ply"] == ply)


def _labels(first: Path, second: Path) -> tuple[str, str]:
    """Short names of two folders that tell them apart."""
    a, b = first.resolve(), second.resolve()
    return (a.name, b.name) if a.name != b.name else (f"{a.parent.name}/{a.name}", f"{b.parent.name}/{b.name}")


def _common_plies(runs: Sequence[FinishedRun], labels: Sequence[str]) -> tuple[list[str], list[str]]:
    names = [plies_of(run) for run in runs]
    common = [ply for ply in names[0] if ply in names[1]]
    if not common:
        raise UsageError(
            f"no ply is in both runs: {labels[0]} has {', '.join(names[0])}; {labels[1]} has {', '.join(names[1])}"
        )
    notes = [f"{ply} is in {label} only" for label, own in zip(labels, names, strict=True)
             for ply in own if ply not in common]  # fmt: skip
    return common, notes


def _outline(run: FinishedRun, ply: str) -> list[Array]:
    """The formed outline's loops in plan, (k, 2) each; none where the run has no profile."""
    try:
        profile = run.profile(ply)
    except UsageError:
        return []
    points = np.stack([profile["x_mm"], profile["y_mm"]], axis=1)
    return [points[profile["loop"] == number] for number in np.unique(profile["loop"])]


def _numbers(runs: Sequence[FinishedRun], ply: str) -> dict[str, tuple[float, float]]:
    """Metrics that both runs know, with the draw-in of each side and corner."""
    a, b = (next(table for table in run.metrics["plies"] if table["ply"] == ply) for run in runs)
    found = {key: (a[key], b[key]) for key in NUMBERS if a.get(key) is not None and b.get(key) is not None}
    for place in ("mid_side", "corner"):
        ours, theirs = a.get(f"draw_in_{place}_mm") or {}, b.get(f"draw_in_{place}_mm") or {}
        found |= {f"draw_in_{place}_{key}_mm": (ours[key], theirs[key]) for key in ours if key in theirs}
    return found


def _measure(label: str, ply: str, points: Array, loops: list[Array], align: bool) -> Measured:
    fit = fit_points(points, loops) if align else None
    return Measured(label, ply, fit, point_distances(points if fit is None else fit.apply(points), loops))


def _draw(
    out: RunFolder, surfaces: list[PlySurface], labels: tuple[str, str], outlines: list[list[Array]],
    wrinkles: list[list[dict[str, Any]]], shear: ShearDifference, points: Array | None, measured: list[Measured],
) -> None:  # fmt: skip
    from ddf.compare.pictures import draw_outlines, draw_shear_maps, draw_side_by_side
    from ddf.output.figures import save_picture

    ply, names = surfaces[0].name, list(labels)
    save_picture(out, f"formed-{ply}", draw_side_by_side(surfaces, names))
    save_picture(out, f"shear-{ply}", draw_shear_maps(surfaces[0], surfaces[1], names, shear))
    if points is not None and measured and measured[0].fit is not None:
        points = measured[0].fit.apply(points)
    if all(outlines):
        title = f"{ply}: outlines and wrinkles"
        save_picture(out, f"outlines-{ply}", draw_outlines(outlines, names, wrinkles, points, title))


def _write(out: RunFolder, result: Comparison) -> None:
    rows = [[ply.ply, key, a, b, b - a] for ply in result.plies for key, (a, b) in ply.numbers.items()]
    for ply in result.plies:
        if ply.outline is not None:
            rows += [[ply.ply, "outline_distance_mean_mm", "", "", ply.outline.mean_mm],
                     [ply.ply, "outline_distance_largest_mm", "", "", ply.outline.largest_mm]]  # fmt: skip
        rows.append([ply.ply, "shear_difference_rms_deg", "", "", ply.shear.rms_deg])
    out.write_text("metrics.csv", _csv([["ply", "quantity", *result.labels, "difference"], *rows]))
    sites = [site.row() for ply in result.plies for site in ply.sites]
    header = list(Site("", None, None, None).row())
    out.write_text("wrinkles.csv", _csv([header, *([row[key] for key in header] for row in sites)]))
    out.write_json("comparison.json", provenance() | {
        "runs": dict(zip(("a", "b"), map(str, result.paths), strict=True)),
        "plies": [{
            "ply": ply.ply,
            "numbers": {key: {"a": a, "b": b} for key, (a, b) in ply.numbers.items()},
            "outline": None if ply.outline is None else asdict(ply.outline),
            "shear": {"rms_deg": ply.shear.rms_deg, "largest_deg": ply.shear.largest_deg,
                      "signed": ply.shear.signed},
            "wrinkle_sites": [site.row() for site in ply.sites],
        } for ply in result.plies],
        "measured": [asdict(item) for item in result.measured],
        "notes": result.notes,
    })  # fmt: skip


def _csv(rows: list[list[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(
        [[f"{value:.6g}" if isinstance(value, float) else value for value in row] for row in rows]
    )
    return text.getvalue()
