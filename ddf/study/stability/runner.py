"""Chart limits one after the other and leave their maps in a folder."""

from __future__ import annotations

import csv
import io
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from ddf.output.figures import figure_bytes
from ddf.output.folder import RunFolder
from ddf.provenance import provenance
from ddf.study.stability.draw import draw_map
from ddf.study.stability.map import VERDICTS, Limit, Map


@dataclass(frozen=True)
class Charted:
    """A limit and its map."""

    limit: Limit
    map: Map
    wall_s: float

    @property
    def counts(self) -> dict[str, int]:
        """Spots by verdict, those that there are."""
        found = {verdict: sum(spot.verdict == verdict for spot in self.map.spots) for verdict in VERDICTS}
        return {verdict: count for verdict, count in found.items() if count}


def chart_all(
    limits: Sequence[Limit], quick: bool, folder: Path, announce: Callable[[Limit], None] = lambda _: None
) -> Iterator[Charted]:
    """Chart each limit, write NAME.csv and NAME.png, and after the last stability.json and stability.md."""
    out, charted = RunFolder(folder), []
    for limit in limits:
        announce(limit)
        start = clock.perf_counter()
        done = Charted(limit, limit.chart(quick), clock.perf_counter() - start)
        out.write_text(f"{limit.name}.csv", _csv(done.map))
        out.write_bytes(f"{limit.name}.png", figure_bytes(draw_map(limit, done.map)))
        charted.append(done)
        yield done
    out.write_json("stability.json", provenance() | {"quick": quick, "limits": [
        {"limit": c.limit.name, "title": c.limit.title, "rule": c.limit.rule, "wall_s": round(c.wall_s, 2),
         "x": c.map.x_label, "y": c.map.y_label, "measure": c.map.measure, "notes": c.map.notes,
         "failures": c.map.failures, "spots": [asdict(spot) for spot in c.map.spots]} for c in charted
    ]})  # fmt: skip
    out.write_text("stability.md", _markdown(charted))


def _csv(chart: Map) -> str:
    text = io.StringIO()
    rows = [asdict(spot) for spot in chart.spots]
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})
    return text.getvalue()


def _markdown(charted: Sequence[Charted]) -> str:
    lines = ["| limit | the rule | safe side | beyond it | wrong and not caught |", "|---|---|---|---|---|"]
    for c in charted:
        sides = []
        for safe in (True, False):
            spots = [spot.verdict for spot in c.map.spots if spot.safe == safe]
            found = {verdict: spots.count(verdict) for verdict in VERDICTS if verdict in spots}
            sides.append(", ".join(f"{count} {verdict}" for verdict, count in found.items()) or "-")
        lines.append(f"| {c.limit.title} | {c.limit.rule} | {sides[0]} | {sides[1]} | {len(c.map.failures)} |")
    return "\n".join(lines) + "\n"
