"""What all pictures share: figures without pyplot, scale bar, axes in mm, and saving as a whole."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.output.folder import RunFolder
from ddf.output.raster import Box

DPI = 150
INK = "#26323d"
MUTED = "#6b7681"
TITLE_PT, LABEL_PT, NOTE_PT = 13, 11, 10  # to be read on a page as narrow as a telephone
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#000000")


def new_figure(width_in: float, height_in: float) -> Any:
    """A figure with its own off-screen canvas: nothing global, no window system."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_in, height_in), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def figure_bytes(figure: Any) -> bytes:
    """The figure as PNG."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": "ddf"}, pil_kwargs={"compress_level": 3})
    return stream.getvalue()


def save_picture(folder: RunFolder, name: str, figure: Any) -> None:
    """Write pictures/<name>.png as a whole; raises DdfError."""
    folder.write_bytes(f"pictures/{name}.png", figure_bytes(figure))


def view_box(x: NDArray[np.float64], margin_mm: float = 20.0) -> Box:
    """Square box in plan around points (3, ...) with NaN left out."""
    low, high = np.nanmin(x[:2].reshape(2, -1), axis=1), np.nanmax(x[:2].reshape(2, -1), axis=1)
    middle, half = 0.5 * (low + high), 0.5 * float((high - low).max()) + margin_mm
    return (middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half)


def plan_axes(figure: Any, box: Box, title: str, place: tuple[int, int, int] = (1, 1, 1)) -> Any:
    """Axes in plan with equal scales, in mm."""
    axes = figure.add_subplot(*place)
    axes.set(xlim=box[:2], ylim=box[2:], aspect="equal")
    axes.set_xlabel("x [mm]", fontsize=LABEL_PT)
    axes.set_ylabel("y [mm]", fontsize=LABEL_PT)
    axes.set_title(title, loc="left", color=INK, fontsize=TITLE_PT)
    axes.tick_params(colors=MUTED, labelsize=NOTE_PT)
    for side in axes.spines.values():
        side.set_color("#c3c9cf")
    return axes


def label_logarithmic(axis: Any) -> None:
    """Label an axis with plain numbers at powers of ten and at 2 and 5 between them."""
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else "")


def scale_bar(axes: Any, box: Box, length_mm: float | None = None) -> None:
    """A bar of a round length near the lower right corner, with its length in mm."""
    width = box[1] - box[0]
    if length_mm is None:
        exponent = 10.0 ** np.floor(np.log10(width / 4))
        length_mm = float(max(f for f in (1, 2, 5, 10) if f * exponent <= width / 4) * exponent)
    right, low = box[1] - 0.03 * width, box[2] + 0.012 * width
    axes.plot([right - length_mm, right], [low, low], color=INK, linewidth=3, solid_capstyle="butt")
    axes.text(
        right - length_mm / 2, low + 0.008 * width, f"{length_mm:g} mm", ha="center", va="bottom",
        fontsize=NOTE_PT, color=INK,
    )  # fmt: skip
