"""Drawings at 1:1 in mm, as DXF (release 12, ASCII: every CAM system reads it) and as SVG; y is up in both.

DXF R12: Autodesk, DXF Reference, release 12: groups of a code and a value a line each.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Layer:
    """A layer's look: AutoCAD's colour number, and stroke of the SVG."""

    dxf_colour: int
    stroke: str


LAYERS = {
    "CUT": Layer(7, "#000000"),
    "BLANK": Layer(8, "#9aa3ab"),
    "FIBRE_1": Layer(5, "#0072b2"),
    "FIBRE_2": Layer(30, "#d55e00"),
    "SCALE": Layer(3, "#009e73"),
    "TEXT": Layer(7, "#26323d"),
}


@dataclass(frozen=True)
class Line:
    """A polyline (k, 2) [mm] on a layer."""

    layer: str
    points: Array
    closed: bool = True


@dataclass(frozen=True)
class Label:
    """A line of text that begins at a place [mm]."""

    text: str
    at: tuple[float, float]
    height_mm: float = 6.0
    layer: str = "TEXT"


@dataclass
class Drawing:
    """Lines and labels."""

    title: str
    lines: list[Line] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)

    def arrow(self, layer: str, start: Array, end: Array) -> None:
        """Add an arrow with an open head."""
        along = end - start
        across = np.array([-along[1], along[0]])
        head = [end - 0.12 * along + s * 0.05 * across for s in (1.0, -1.0)]
        self.lines += [
            Line(layer, np.array([start, end]), False),
            Line(layer, np.array([head[0], end, head[1]]), False),
        ]


def dxf_text(drawing: Drawing) -> str:
    """The drawing as DXF R12; its unit is the mm (release 12 has no place to say so)."""
    low, high = _bounds(drawing)
    groups: list[tuple[int, object]] = [(999, f"{drawing.title}; unit: mm; written by ddf")]
    groups += [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009")]
    for name, point in (("$EXTMIN", low), ("$EXTMAX", high)):
        groups += [(9, name), (10, f"{point[0]:.4f}"), (20, f"{point[1]:.4f}"), (30, "0.0")]
    groups += [(0, "ENDSEC"), (0, "SECTION"), (2, "TABLES")]
    groups += [(0, "TABLE"), (2, "LTYPE"), (70, 1), (0, "LTYPE"), (2, "CONTINUOUS"), (70, 0), (3, "Solid line")]
    groups += [(72, 65), (73, 0), (40, "0.0"), (0, "ENDTAB"), (0, "TABLE"), (2, "LAYER"), (70, len(LAYERS))]
    for name, layer in LAYERS.items():
        groups += [(0, "LAYER"), (2, name), (70, 0), (62, layer.dxf_colour), (6, "CONTINUOUS")]
    groups += [(0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]
    for line in drawing.lines:
        groups += [(0, "POLYLINE"), (8, line.layer), (66, 1), (70, int(line.closed)), (10, "0.0"), (20, "0.0")]
        groups.append((30, "0.0"))
        for x, y in line.points:
            groups += [(0, "VERTEX"), (8, line.layer), (10, f"{x:.4f}"), (20, f"{y:.4f}"), (30, "0.0")]
        groups += [(0, "SEQEND"), (8, line.layer)]
    for label in drawing.labels:
        groups += [(0, "TEXT"), (8, label.layer), (10, f"{label.at[0]:.4f}"), (20, f"{label.at[1]:.4f}"), (30, "0.0")]
        groups += [(40, f"{label.height_mm:g}"), (1, _ascii(label.text))]
    groups += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code:>3}\n{_ascii(str(value))}\n" for code, value in groups)


def svg_text(drawing: Drawing, margin_mm: float = 10.0) -> str:
    """The drawing as SVG, one user unit a mm, a group a layer."""
    low, high = _bounds(drawing)
    low, size = low - margin_mm, high - low + 2 * margin_mm
    top = low[1] + size[1]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]:.3f}mm" height="{size[1]:.3f}mm" '
        f'viewBox="0 0 {size[0]:.3f} {size[1]:.3f}">',
        f"<title>{escape(drawing.title)}; 1 unit = 1 mm</title>",
    ]
    for name, layer in LAYERS.items():
        parts.append(f'<g id="{name}" fill="none" stroke="{layer.stroke}" stroke-width="0.5">')
        for line in (line for line in drawing.lines if line.layer == name):
            points = " ".join(f"{x - low[0]:.4f},{top - y:.4f}" for x, y in line.points)
            parts.append(f'<{"polygon" if line.closed else "polyline"} points="{points}"/>')
        for label in (label for label in drawing.labels if label.layer == name):
            parts.append(
                f'<text x="{label.at[0] - low[0]:.3f}" y="{top - label.at[1]:.3f}" font-size="{label.height_mm:g}" '
                f'font-family="sans-serif" fill="{layer.stroke}" stroke="none">{escape(label.text)}</text>'
            )
        parts.append("</g>")
    return "\n".join([*parts, "</svg>", ""])


def _bounds(drawing: Drawing) -> tuple[Array, Array]:
    """Box around lines and labels; a letter is taken as 0.62 of its height wide."""
    points = [line.points for line in drawing.lines]
    for label in drawing.labels:
        width, (x, y) = 0.62 * label.height_mm * len(label.text), label.at
        points.append(np.array([[x, y - 0.3 * label.height_mm], [x + width, y + label.height_mm]]))
    everything = np.concatenate(points)
    return everything.min(axis=0), everything.max(axis=0)


def _ascii(text: str) -> str:
    return " ".join(text.split()).encode("ascii", "replace").decode()
