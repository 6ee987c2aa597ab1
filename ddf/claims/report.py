"""Verdicts as text, CSV, JSON, Markdown and a page."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ddf.claims.verdict import REPRODUCED, Finding, Judged
from ddf.output.folder import RunFolder
from ddf.output.tables import write_table
from ddf.provenance import provenance

TEMPLATE = Path(__file__).parent / "page.html.j2"
HEADER = ("quantity", "value", "low to high", "expected", "margin", "")
SOURCE = "Thompson, Belnoue and Hallett, Composites Part B 202 (2020) 108357"

Variants = Mapping[str, Sequence[Judged]]


def finding_cells(finding: Finding) -> tuple[str, ...]:
    """A finding in words, by the columns of `HEADER`."""
    if finding.reason:
        return finding.quantity, "-", "-", "-", "-", f"{finding.state} ({finding.reason})"
    unit = f" {finding.unit}" if finding.unit else ""
    expected = f"{finding.relation} {finding.threshold:.3g}{unit}" if finding.relation else "-"
    margin = f"{finding.margin:+.3g}{unit}" if finding.relation else "-"
    if finding.relation and finding.combinations > 1:
        margin += f", {finding.least_margin:+.3g} to {finding.largest_margin:+.3g}"
    spread = f"{finding.low:.3g} to {finding.high:.3g}" if finding.combinations > 1 else "-"
    return finding.quantity, f"{finding.value:.3g}{unit}", spread, expected, margin, finding.state


def text_lines(judged: Sequence[Judged]) -> list[str]:
    """The claims with their findings as aligned lines."""
    cells = {item.claim.number: [finding_cells(finding) for finding in item.findings] for item in judged}
    every = [HEADER, *(row for rows in cells.values() for row in rows)]
    widths = [max(len(row[k]) for row in every) for k in range(5)]
    lines = []
    for item in judged:
        lines.append(f"claim {item.claim.number}: {item.claim.title}: {item.verdict.upper()}")
        for row in (HEADER, *cells[item.claim.number]):
            padded = [cell.rjust(width) for cell, width in zip(row[1:5], widths[1:], strict=True)]
            lines.append("  " + "  ".join((row[0].ljust(widths[0]), *padded, row[5])).rstrip())
        lines.append("")
    return lines


def verdict_table(variants: Variants) -> list[str]:
    """Markdown: the verdict on each claim (columns) for each variant (rows)."""
    claims = [item.claim for item in next(iter(variants.values()))]
    lines = ["| variant | " + " | ".join(f"{claim.number}: {claim.title}" for claim in claims) + " |"]
    lines.append("|---" * (len(claims) + 1) + "|")
    lines += [f"| {name} | " + " | ".join(item.verdict for item in judged) + " |" for name, judged in variants.items()]
    return lines


def decided_by(variants: Variants) -> list[str]:
    """For each claim: whether what the paper does not give decides on it."""
    lines = []
    for k, first in enumerate(next(iter(variants.values()))):
        verdicts = {name: judged[k].verdict for name, judged in variants.items()}
        kinds = sorted(set(verdicts.values()))
        if len(kinds) == 1:
            lines.append(f"claim {first.claim.number}: {kinds[0]} by all {len(verdicts)} variants")
        else:
            parts = [f"{kind} by {', '.join(n for n, v in verdicts.items() if v == kind)}" for kind in kinds]
            lines.append(f"claim {first.claim.number}: {'; '.join(parts)}")
    return lines


def markdown(title: str, judged: Sequence[Judged], variants: Variants, rows: Sequence[Mapping[str, Any]]) -> str:
    """All verdicts as Markdown."""
    lines = [f"# {title}", "", f"Claims of {SOURCE}.", ""]
    for item in judged:
        claim = item.claim
        lines += [f"## Claim {claim.number}: {claim.title}: {item.verdict}", "",
                  f"{claim.statement} (section {claim.section})", "", "| " + " | ".join(HEADER) + " |",
                  "|---|--:|--:|--:|--:|---|"]  # fmt: skip
        lines += ["| " + " | ".join(finding_cells(finding)) + " |" for finding in item.findings]
        lines += ["", f"![claim {claim.number}](pictures/claim-{claim.number}.png)", ""]
    if variants:
        everything = {"as shipped": judged, **variants}
        lines += ["## What the paper does not give", "", *verdict_table(everything), ""]
        lines += [f"- {line}" for line in decided_by(everything)] + [""]
    lines += ["## Runs", "", "| run | state | computed by | audit misses |", "|---|---|---|---|"]
    lines += [
        f"| {row['run']} | {row['state']} {row['reason']} | "
        f"{row.get('computed_by', '')} | {row.get('audit_misses', '')} |"
        for row in rows
    ]
    return "\n".join(lines) + "\n"


def finding_row(variant: str, item: Judged, finding: Finding) -> dict[str, Any]:
    """A finding as a flat row; None where a number is not known."""
    head = {"variant": variant, "claim": item.claim.number, "verdict": item.verdict, "state": finding.state}
    numbers = asdict(finding)
    return head | {key: None if isinstance(v, float) and not math.isfinite(v) else v for key, v in numbers.items()}


def write_tables(
    out: RunFolder, title: str, judged: Sequence[Judged], variants: Variants, rows: Sequence[Mapping[str, Any]],
    notes: Sequence[str],
) -> None:  # fmt: skip
    """Write claims.csv, claims.json and claims.md."""
    everything = {"as shipped": judged, **variants}
    found = [finding_row(name, item, f) for name, items in everything.items() for item in items for f in item.findings]
    header = list(found[0])
    write_table(out, "claims.csv", header, [["" if row[k] is None else row[k] for k in header] for row in found])
    claims = [{"number": i.claim.number, "title": i.claim.title, "statement": i.claim.statement,
               "section": i.claim.section, "verdict": i.verdict} for i in judged]  # fmt: skip
    out.write_json("claims.json", provenance() | {
        "title": title, "source_of_claims": SOURCE, "claims": claims, "reproduced": all(
            item.verdict == REPRODUCED for item in judged),
        "variants": {name: [item.verdict for item in items] for name, items in variants.items()},
        "findings": found, "runs": [dict(row) for row in rows], "notes": list(notes),
    })  # fmt: skip
    out.write_text("claims.md", markdown(title, judged, variants, rows))


def write_page(
    out: RunFolder, title: str, judged: Sequence[Judged], variants: Variants, rows: Sequence[Mapping[str, Any]],
    notes: Sequence[str],
) -> None:  # fmt: skip
    """Write claims.html, with its pictures beside it in pictures/."""
    from jinja2 import Environment

    everything = {"as shipped": judged, **variants}
    page = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True).from_string(TEMPLATE.read_text("utf-8"))
    out.write_text("claims.html", page.render(
        title=title, source=SOURCE, header=HEADER, judged=judged, cells=finding_cells, reproduced=REPRODUCED,
        variants=everything if variants else {}, decided=decided_by(everything) if variants else [], runs=rows,
        notes=notes, provenance=provenance(),
    ))  # fmt: skip
