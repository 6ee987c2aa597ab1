"""Flat patterns as drawings: the line to cut, the blank it came from, the fibres, a bar to check the scale."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ddf.export.drawing import Drawing, Label, Line, dxf_text, svg_text
from ddf.export.pattern import FlatPattern, flat_points
from ddf.output.folder import RunFolder

BAR_MM = 100.0


def export_patterns(patterns: list[FlatPattern], folder: str | Path, title: str) -> list[Path]:
    """Write pattern-<ply>.dxf and .svg of every ply; returns their paths."""
    out, written = RunFolder(folder), []
    for pattern in patterns:
        drawing, name = pattern_drawing(pattern, title), pattern.ply.surface.name
        written.append(out.write_text(f"pattern-{name}.dxf", dxf_text(drawing)))
        written.append(out.write_text(f"pattern-{name}.svg", svg_text(drawing)))
    return written


def pattern_drawing(pattern: FlatPattern, title: str) -> Drawing:
    """One ply's pattern, as it lies in the case's frame, seen from above."""
    surface, angle = pattern.ply.surface, pattern.ply.orientation_deg
    drawing = Drawing(f"{surface.name}, {title}")
    drawing.lines += [Line("CUT", loop) for loop in pattern.flat]
    blank = [flat_points(surface, loop) for loop in surface.outline]
    drawing.lines += [Line("BLANK", loop) for loop in blank]
    middle, size = pattern.flat[0].mean(axis=0), float(np.ptp(pattern.flat[0], axis=0).max())
    for layer, turn in (("FIBRE_1", angle), ("FIBRE_2", angle + 90.0)):
        along = 0.15 * size * np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
        drawing.arrow(layer, middle - along, middle + along)
        x, y = middle + 1.08 * along
        drawing.labels.append(Label(layer[-1], (float(x), float(y)), layer=layer))
    x, y = np.concatenate(blank).min(axis=0)
    drawing.lines.append(Line("SCALE", np.array([[x, y - 8.0], [x + BAR_MM, y - 8.0]]), False))
    text = (
        f"{BAR_MM:g} mm, scale 1:1",
        f"{surface.name}: fibre 1 at {angle:g} deg, fibre 2 at {angle + 90.0:g} deg to x",
        title,
    )
    drawing.labels += [Label(line, (float(x), float(y) - 18.0 - 10.0 * k)) for k, line in enumerate(text)]
    return drawing
