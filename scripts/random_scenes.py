"""Form random scenes (`tests/scenes/random_scenes.py`) and say of each how it ended.

    python scripts/random_scenes.py [NUMBER ...] [--folder runs/scenes] [--again]

Without numbers: the first 60. One line a scene goes to results.jsonl in the folder as soon as it is done, scenes that
stand there are not run again (but with --again), and results.md is the table of them all. Exit code 1 if fewer than
95 % of the scenes settled.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests/scenes")]

from judge import judged_run  # noqa: E402
from random_scenes import random_case  # noqa: E402

SETTLED_SHARE = 0.95
COLUMNS = {
    "scene": "number", "what": "title", "steps": "steps", "wall s": "wall_s", "end": "end",
    "kinetic/internal %": "kinetic_percent", "balance %": "gross_percent", "of net work %": "balance_percent",
    "fibre strain %": "strain_percent", "in tool mm": "penetration_mm", "ply in tool mm": "ply_in_tool_mm",
}  # fmt: skip


def results(file: Path) -> dict[int, dict[str, Any]]:
    """Rows by number; of two of a scene the later."""
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    return {row["number"]: row for row in sorted(rows, key=lambda row: row["number"])}


def table(rows: dict[int, dict[str, Any]]) -> str:
    """The results as a table in Markdown, reasons below it."""
    heads = [*COLUMNS, "frames with crossings", "crossings at the end"]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for row in rows.values():
        cells = [_text(row.get(key, "")) for key in COLUMNS.values()]
        crossed = row.get("crossings", [])
        last = sum(crossed[-1][1].values()) if crossed and row.get("last_frame") == crossed[-1][0] else 0
        lines.append(f"| {' | '.join(cells)} | {len(crossed)} | {last} |")
    lines += [f"\n{row['number']}: {row['reason']}" for row in rows.values() if "reason" in row]
    return "\n".join(lines) + "\n"


def _text(value: Any) -> str:
    return f"{value:.2g}" if isinstance(value, float) else str(value).removeprefix("random scene ")


def main() -> int:
    """Run what is missing and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("numbers", nargs="*", type=int, default=range(60))
    parser.add_argument("--folder", type=Path, default=ROOT / "runs/scenes")
    parser.add_argument("--again", action="store_true", help="run scenes that stand in the results too")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    file = options.folder / "results.jsonl"
    for number in options.numbers:
        if number in results(file) and not options.again:
            continue
        row = {"number": number} | judged_run(random_case(number), options.folder / f"{number:03d}")
        with file.open("a") as stream:
            stream.write(json.dumps(row) + "\n")
        print(number, row["end"], row["title"], row.get("reason", ""), flush=True)
    rows = {number: row for number, row in results(file).items() if number in options.numbers}
    (options.folder / "results.md").write_text(table(rows))
    settled = sum(row["end"] == "settled" for row in rows.values())
    print(f"{settled} of {len(rows)} settled; see {options.folder / 'results.md'}")
    return int(settled < SETTLED_SHARE * len(rows))


if __name__ == "__main__":
    sys.exit(main())
