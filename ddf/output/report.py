"""The report of a run: one HTML file that holds its pictures and needs nothing else."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ddf.output.folder import RunFolder

TEMPLATE = Path(__file__).parent / "report.html.j2"

CAPTIONS = {
    "formed-": "from above",
    "shear-": "shear angle",
    "distance-": "gap to the tool",
    "outline-": "outline and wrinkles",
    "stages": "the stages",
    "energies": "energies over process time",
}

WRINKLE_COLUMNS = (
    ("length_mm", "length [mm]"),
    ("amplitude_mm", "amplitude [mm]"),
    ("width_mm", "width [mm]"),
    ("direction_deg", "direction [deg]"),
    ("angle_to_family_1_deg", "to fibre 1 [deg]"),
    ("angle_to_family_2_deg", "to fibre 2 [deg]"),
    ("elements_across", "elements across"),
)

PLY_ROWS = (
    ("wrinkle_count", "wrinkles"),
    ("wrinkle_total_length_mm", "their total length [mm]"),
    ("wrinkle_largest_amplitude_mm", "largest amplitude [mm]"),
    ("wrinkled_area_percent", "wrinkled area [%]"),
    ("elements_per_wrinkle_smallest", "elements across the narrowest wrinkle"),
    ("shear_max_deg", "largest shear angle [deg]"),
    ("shear_p99_deg", "99th percentile of the shear angle [deg]"),
    ("shear_p95_deg", "95th percentile of the shear angle [deg]"),
    ("shear_mean_deg", "mean shear angle [deg]"),
    ("locked_area_percent", "area sheared beyond locking [%]"),
    ("fibre_strain_min", "least fibre strain [-]"),
    ("fibre_strain_max", "largest fibre strain [-]"),
    ("outline_initial_area_mm2", "outline, area before [mm²]"),
    ("outline_area_mm2", "outline, area formed, in plan [mm²]"),
    ("outline_length_mm", "outline, length formed [mm]"),
    ("gap_largest_mm", "largest gap to the tool, wrinkles included [mm]"),
    ("gap_area_percent", "area with a gap of over 0.5 mm, wrinkles included [%]"),
    ("bridging_largest_mm", "largest bridging gap outside wrinkles [mm]"),
    ("bridging_mean_mm", "mean gap to the tool [mm]"),
    ("bridged_area_percent", "bridged area, outside wrinkles [%]"),
)


@dataclass(frozen=True)
class Report:
    """What a report tells. All but the title may be left empty; parts that are empty are not shown."""

    title: str
    summary: str = ""  # what was simulated, in a sentence or two
    key_numbers: Mapping[str, Any] = field(default_factory=dict)  # label with unit: value
    plies: Sequence[Mapping[str, Any]] = ()  # tables of ddf.metrics.ply_metrics
    audit: Sequence[Mapping[str, Any]] = ()  # name, value, limit, unit, ok, meaning, remedy
    energies: Mapping[str, float] = field(default_factory=dict)  # label: value at the end [mJ]
    settings: str = ""  # the resolved case, TOML
    versions: Mapping[str, Any] = field(default_factory=dict)
    notes: Sequence[str] = ()  # what is missing, and why


def write_report(folder: RunFolder, report: Report) -> None:
    """Write report.html with the pictures that are in the folder. Raises DdfError."""
    folder.write_text("report.html", render_report(report, find_pictures(folder)))


def find_pictures(folder: RunFolder) -> dict[str, bytes]:
    """PNG files of the folder's pictures by name, in the order of CAPTIONS."""
    found = {file.stem: file.read_bytes() for file in sorted((folder / "pictures").glob("*.png"))}
    ordered = [name for prefix in CAPTIONS for name in found if name.startswith(prefix)]
    return {name: found[name] for name in dict.fromkeys([*ordered, *found])}


def render_report(report: Report, pictures: Mapping[str, bytes]) -> str:
    """The report as HTML text."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["number"] = shown
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        report=report,
        pictures=[_picture(name, data) for name, data in pictures.items()],
        ply_rows=[row for row in PLY_ROWS if any(row[0] in ply for ply in report.plies)],
        draw_in=[(ply["ply"], _draw_in(ply)) for ply in report.plies if _draw_in(ply)],
        wrinkle_columns=WRINKLE_COLUMNS,
        failed=[check for check in report.audit if not check.get("ok")],
    )


def shown(value: Any) -> str:
    """A value for people: four significant digits, thin spaces between thousands, a dash where not known."""
    if value is None or (isinstance(value, float) and value != value):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        size = abs(value)
        if size >= 1e7 or 0 < size < 1e-4:
            return f"{value:.3g}"
        if isinstance(value, int) or size >= 1000:
            return f"{value:,.0f}".replace(",", "\u202f")
        return f"{value:.4g}"
    return str(value)


def _picture(name: str, data: bytes) -> dict[str, str]:
    """Name, caption and data address of a picture."""
    caption = name
    for prefix, text in CAPTIONS.items():
        if name.startswith(prefix):
            sheet = name.removeprefix(prefix)
            caption = f"{sheet}: {text}" if sheet else text[:1].upper() + text[1:]
            break
    wide = "wide" if name in ("stages", "energies") else ""
    return {"caption": caption, "wide": wide, "data": base64.b64encode(data).decode("ascii")}


def _draw_in(ply: Mapping[str, Any]) -> list[tuple[str, float]]:
    """Draw-in [mm] with where: mid-sides, then corners."""
    rows: list[tuple[str, float]] = []
    for key, text in (("draw_in_mid_side_mm", "mid-side"), ("draw_in_corner_mm", "corner")):
        for place, value in (ply.get(key) or {}).items():
            angle, _, copy = str(place).partition("deg")
            rows.append((f"{text} at {angle}°{copy.replace('_', ' no. ')}", value))
    return rows
