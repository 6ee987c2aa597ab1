"""Answers as text, CSV and pictures."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ddf.output import figures
from ddf.verify.problem import Answer, Check, Figure, FloatArray

HEADER = ("quantity", "unit", "expected", "got", "error", "bound", "pass")
WIDTHS = (46, 8, 12, 12, 11, 9, 6)


def check_row(check: Check) -> dict[str, Any]:
    """A check as a row of results: errors relative, or in the quantity's unit where `error_is` says so."""
    return {
        "quantity": check.quantity,
        "unit": check.unit,
        "expected": check.expected,
        "got": check.got,
        "error": check.error,
        "error_is": "relative" if check.relative else "absolute",
        "bound": check.bound,
        "pass": check.passed,
    }


def check_text(check: Check) -> tuple[str, ...]:
    """A check in words, by the columns of `HEADER`; relative errors in percent."""

    def amount(value: float) -> str:
        return f"{100 * value:.3g} %" if check.relative else f"{value:.3g}"

    verdict = "-" if check.bound is None else "pass" if check.passed else "MISS"
    return (
        check.quantity, check.unit, f"{check.expected:.6g}", f"{check.got:.6g}", amount(check.error),
        "-" if check.bound is None else amount(check.bound), verdict,
    )  # fmt: skip


def text_table(checks: Sequence[Check]) -> str:
    """Aligned lines: the columns' names, then a line a check."""
    lines = []
    for row in (HEADER, *(check_text(check) for check in checks)):
        first, *rest = (
            cell.ljust(width) if k < 2 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, WIDTHS, strict=True))
        )
        lines.append(" ".join((first, *rest)).rstrip())
    return "\n".join(lines)


def checks_csv(answers: Iterable[tuple[str, Answer]]) -> str:
    """All checks of all problems, a row each."""
    rows = [{"problem": name} | check_row(check) for name, answer in answers for check in answer.checks]
    stream = io.StringIO()
    writer = csv.DictWriter(stream, rows[0] if rows else ["problem"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def worst_table(answers: Iterable[tuple[str, Answer]]) -> str:
    """Markdown: of all judged checks of a problem that share unit and bound, the one with the largest error."""
    lines = ["| problem | checks | the worst of them | error | bound | |", "|---|---|---|---|---|---|"]
    for name, answer in answers:
        groups: dict[tuple[str, float, bool], list[Check]] = {}
        for check in answer.checks:
            if check.bound is not None:
                groups.setdefault((check.unit, check.bound, check.relative), []).append(check)
        for group in groups.values():
            top = max(group, key=lambda check: check.error if math.isfinite(check.error) else math.inf)
            quantity, unit, _, _, error, bound, verdict = check_text(top)
            unit = "" if top.relative or unit in ("1", "-") else f" {unit}"
            lines.append(f"| {name} | {len(group)} | {quantity} | {error}{unit} | {bound}{unit} | {verdict} |")
    return "\n".join(lines) + "\n"


def columns_csv(table: Mapping[str, FloatArray]) -> str:
    """Columns of equal length as CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table)
    writer.writerows([f"{value:.9g}" for value in row] for row in zip(*table.values(), strict=True))
    return stream.getvalue()


def draw_answer(title: str, content: Figure) -> Any:
    """The picture of a problem: what is known as lines, what the solver said as points."""
    figure = figures.new_figure(7.5, 4.8)
    axes = figure.subplots()
    seen: dict[tuple[str, bool], str] = {}
    for curve in content.curves:
        key = (curve.name, curve.points)
        label = curve.name if key not in seen else None  # curves of one name share a colour and an entry
        before = sum(points == curve.points for _, points in seen)
        colour = seen.setdefault(key, figures.COLOURS[before % len(figures.COLOURS)])
        if curve.points:
            axes.plot(curve.x, curve.y, "o", label=label, color=colour, markersize=4.5, markerfacecolor="none")
        else:
            axes.plot(curve.x, curve.y, label=label, color=colour, linewidth=1.5)
    axes.set(xlabel=content.x_label, ylabel=content.y_label)
    if content.log_y:
        axes.set_yscale("log")
    if content.equal_axes:
        axes.set_aspect("equal", adjustable="datalim")
    axes.set_title(title, loc="left", color=figures.INK, fontsize=11)
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.grid(color="#e5e8eb", linewidth=0.6)
    axes.tick_params(colors=figures.MUTED, labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    return figure
