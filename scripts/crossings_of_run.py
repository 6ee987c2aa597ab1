"""Look for sheets of a finished run that cross each other or themselves, in every frame (`tests/crossings.py`).

    python scripts/crossings_of_run.py RUN [--last]

Prints of each frame and pair how many edges pass through triangles (of plies: where there is cloth), and how many of
these lie inside: farther than 4 mm (two cells of 2 mm, where contact fades out) from the edges of the plies, and than
6 mm from the tool's axis. Exit code 1 if there are any of the latter.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests")]

from crossings import crossings_of_frame  # noqa: E402

from ddf.case import case_from_dict  # noqa: E402
from ddf.output.results import FinishedRun, open_run  # noqa: E402

EDGE_MM, AXIS_MM = 4.0, 6.0


def edge_nodes(cells: np.ndarray) -> np.ndarray:
    """Numbers of the nodes on the edge of a mesh of quadrilaterals (q, 4)."""
    sides = np.sort(np.concatenate([cells[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1)
    unique, count = np.unique(sides, axis=0, return_counts=True)
    return np.unique(unique[count == 1])


def inside(places: np.ndarray, run: FinishedRun, plies: list[str], index: int, axis: tuple[float, float]) -> int:
    """How many places lie away from all edges of plies and from the tool's axis."""
    keep = np.hypot(*(places[:, :2] - axis).T) > AXIS_MM
    for ply in plies:
        frame = run.read_frame(ply, index)
        keep &= cKDTree(frame["points"][edge_nodes(frame["cells"])]).query(places)[0] > EDGE_MM
    return int(keep.sum())


def main() -> int:
    """Look through a run; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--last", action="store_true", help="the last frame only")
    args = parser.parse_args()
    run = open_run(args.run)
    sheets = list(run.info["mesh"]["sheets"])
    tool = case_from_dict(tomllib.loads(run.resolved_text)).tool
    axis = (0.0, 0.0) if tool is None else tool.position_mm
    times = [time for time, _ in run.frames(sheets[0])]
    found = 0
    for index in range(len(times))[-1 if args.last else 0 :]:
        crossing = {pair: places for pair, places in crossings_of_frame(run, sheets, index).items() if len(places)}
        texts = []
        for (a, b), places in crossing.items():
            count = inside(places, run, sheets[1:-1], index, axis)
            found += count
            texts.append(f"{a} x {b} {len(places)} ({count} inside)")
        print(f"{times[index]:.4f} s: {', '.join(texts) or 'none'}", flush=True)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
