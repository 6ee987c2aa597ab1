"""Element tables of a formed part: a VTU and a CSV on the tool's surface for each ply."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ddf.export.closest import closest_on_tool
from ddf.export.fibres import element_centres, element_fields
from ddf.export.part import FormedPart, FormedPly
from ddf.mesh.triangles import TriangleMesh
from ddf.metrics.surface import cell_area
from ddf.output.folder import RunFolder
from ddf.output.snapshot import SheetSnapshot
from ddf.output.tables import write_table
from ddf.output.vtu import write_sheet


def export_fibres(part: FormedPart, folder: str | Path) -> list[Path]:
    """Write fibres-<ply>.vtu and fibres-<ply>.csv of every ply into a folder; returns their paths.

    All lengths are in the tool's frame. The CSV has a row an element: lattice place, area of the flat ply it stands
    for, centre, closest point of tool or platform with the normal there, gap (distance of the mid-surface less
    what lies between when it conforms), fibres, shear angle, thickness.
    """
    out, written = RunFolder(folder), []
    for ply in part.plies:
        table = element_table(ply, part.tool)
        name = ply.surface.name
        exists = ply.surface.cell_fraction > 0
        gap = np.full(exists.shape, np.nan)
        gap[exists] = table["gap_mm"]
        fields = element_fields(ply) | {"gap_mm": gap}
        sheet = SheetSnapshot(name, "ply", ply.surface.x, exists, {}, fields)
        write_sheet(out / f"fibres-{name}.vtu", sheet, 0.0)
        rows = [list(row) for row in zip(*(column.tolist() for column in table.values()), strict=True)]
        written += [out / f"fibres-{name}.vtu", write_table(out, f"fibres-{name}.csv", list(table), rows)]
    return written


def element_table(ply: FormedPly, tool: TriangleMesh | None) -> dict[str, np.ndarray]:
    """Columns of the CSV, a value for each element of the ply, row by row of its lattice."""
    exists = ply.surface.cell_fraction > 0
    row, col = np.nonzero(exists)
    centre = element_centres(ply.surface.x)[:, exists].T
    closest = closest_on_tool(tool, centre)
    fields = {key: values[exists] for key, values in element_fields(ply).items()}
    table: dict[str, np.ndarray] = {"row": row, "col": col, "flat_area_mm2": cell_area(ply.surface)[exists]}
    table |= _xyz("{}_mm", centre) | _xyz("tool_{}_mm", closest.point) | _xyz("normal_{}", closest.normal)
    table["surface"] = np.where(closest.on_tool, "tool", "platform")
    table["gap_mm"] = closest.distance - ply.surface.offset_mm
    for family in ("fibre_1", "fibre_2"):
        table |= _xyz(family + "_{}", fields.pop(family))
    return table | fields


def _xyz(name: str, vectors: np.ndarray) -> dict[str, np.ndarray]:
    return {name.format(axis): vectors[:, k] for k, axis in enumerate("xyz")}
