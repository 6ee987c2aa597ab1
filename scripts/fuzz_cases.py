"""Look for case files that ddf does not refuse properly: tracebacks, hangs, and nonsense that would run.

    python scripts/fuzz_cases.py [--seconds 60] [--seed 0] [--deep]

Mutates the shipped cases, their bytes and their values, loads each and examines what is valid as `ddf check` does
before meshing; with --deep what is small is meshed too. Exit code 1 if anything was found; each find is printed
with what makes it again.
"""

from __future__ import annotations

import argparse
import copy
import math
import random
import sys
import tempfile
import time
import tomllib
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import tomli_w

from ddf.build import load_path
from ddf.case import Case, load_case
from ddf.errors import DdfError
from ddf.fidelity import choose
from ddf.plausible import examine, prepare
from ddf.plausible.cost import node_counts

ROOT = Path(__file__).resolve().parent.parent
SLOW_S = 3.0  # processor time
MESHED_NODES = 20_000  # with --deep: more are not meshed
NUMBERS = (
    0, -0.0, 1, -1, 2, 1e-300, 5e-324, -1e-9, 1e-6, 0.5, 1.0 + 1e-12, 89.999, 1e3, 1e6, 1e7, 1e12, 1e300, math.inf,
    -math.inf, math.nan, 10**30, -(10**30), 2**63,
)  # fmt: skip
TEXTS = (
    "", " ", "tool", "ply-1", "lift", "a/b", "..", "\0", "\n", "ä", "x" * 2000, "file", "box", "cylinder", "hemisphere",
    "regular-tetrahedron", "silicone-ogden", "plain-weave-6k-320", "linear", "monotone", "published", "m", "inch",
)  # fmt: skip
EXTRA: dict[str, Any] = tomllib.loads("""
fidelity = "auto"
seconds = 60
accuracy_mm = 0.2
target = {seconds = 100}
holes_mm = [[[0, 0], [30, 0], [0, 30]]]
slits_mm = [[[0, 0], [50, 50]]]
polygon_mm = [[0, 0], [200, 0], [0, 200]]
size_mm = [300, 200]
offset_mm = [10, 20]
gap_mm = 1.0
step_s = 1e-5
target_step_s = 1e-6
radius_mm = 40
length_mm = 100
width_mm = 80
height_mm = 50
fillet_mm = 3
turn_deg = 30
position_mm = [5, 5]
file = "box.step"
unit = "m"
ramp = "linear"
box_pressure_kPa = 50
cavity_pressure_kPa = 20
tool_lift_mm = 30
base = "silicone-ogden"
breakpoints = {time_s = [0, 0.1, 0.2], tool_lift_mm = [0, 40, 80], cavity_pressure_kPa = [101.325, 0, 0]}
[materials.w]
kind = "woven"
base = "plain-weave-6k-320"
[materials.r]
kind = "hyperelastic"
base = "silicone-ogden"
""")


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Key paths of all values in nested tables and lists."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def holder_of(tables: Any, path: tuple[Any, ...]) -> Any:
    """The table or list that holds the last key of a path."""
    for key in path[:-1]:
        tables = tables[key]
    return tables


def mutated_value(value: Any, chance: random.Random) -> Any:
    """A value like another, or of another kind."""
    kind = chance.random()
    if isinstance(value, int | float) and not isinstance(value, bool) and kind < 0.6:
        return value * 10.0 ** chance.uniform(-4, 4) if kind < 0.45 else -value
    if isinstance(value, list) and value and kind < 0.7:
        pick = chance.randrange(len(value))
        return [*value[:pick], *value[pick + 1 :]] if kind < 0.25 else value * chance.choice((2, 3, 50))
    other = (chance.choice(NUMBERS), chance.choice(TEXTS), chance.random() < 0.5, [], {}, [chance.choice(NUMBERS)] * 3)
    return chance.choice(other)


def mutated_tables(tables: dict[str, Any], chance: random.Random) -> bytes:
    """A case with a few of its values changed, removed, doubled or added, as TOML."""
    tables = copy.deepcopy(tables)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 6))):
        paths = list(places(tables))
        if not paths:
            break
        path = chance.choice(paths)
        holder, key, kind = holder_of(tables, path), path[-1], chance.random()
        if kind < 0.7:
            holder[key] = mutated_value(holder[key], chance)
        elif kind < 0.8:
            del holder[key]
        elif isinstance(holder, list):
            holder.insert(chance.randrange(len(holder) + 1), copy.deepcopy(holder[key]))
        else:
            name = chance.choice(list(EXTRA))
            holder[name] = copy.deepcopy(EXTRA[name])
    return tomli_w.dumps(tables).encode("utf-8", "surrogatepass")


def mutated_bytes(data: bytes, chance: random.Random) -> bytes:
    """A case file with some bytes changed, lost, doubled or put elsewhere."""
    out = bytearray(data)
    for _ in range(chance.choice((1, 2, 5, 20))):
        a, size = chance.randrange(len(out) + 1), chance.choice((1, 1, 3, 20, 200))
        kind = chance.randrange(4)
        if kind == 0:
            out[a : a + size] = chance.randbytes(size)
        elif kind == 1:
            del out[a : a + size]
        elif kind == 2:
            out[a:a] = out[a : a + size] * chance.choice((1, 2, 100))
        else:
            out[a:a] = chance.choice(
                (b"nan", b"inf", b"[", b"]", b"{", b'"""', b"\xef\xbb\xbf", b"\0", b"= ", b"\r", b"-", b"e9")
            )
    return bytes(out)


def nonsense(case: Case) -> str:
    """What is impossible in a case that was let through; '' if nothing is."""
    path = load_path(case)
    finite = all(
        math.isfinite(float(value)) for array in (path.time, path.cavity, path.box, path.lift) for value in array
    )
    if not finite or path.duration <= 0 or any(b <= a for a, b in zip(path.time[:-1], path.time[1:], strict=True)):
        return "a load path that does not go forward"
    if sum(node_counts(case).values()) > 1e9:
        return "more than a billion nodes"
    rows = path.schedule(path.time, 0.0, 1e-5)
    return "" if all(math.isfinite(float(value)) for value in rows.ravel()) else "loads that are not finite"


def judged(data: bytes, folder: Path, deep: bool) -> tuple[str, str]:
    """What becomes of a case file: ("refused" | "accepted" | "found", why)."""
    file = folder / "case.toml"
    file.write_bytes(data)
    began = time.process_time()
    try:
        case = load_case(file)
        if case.fidelity == "auto":
            case = choose(case, 2).case
        found = examine(case)
        if found.faults:
            return _timed("refused", began)
        why = nonsense(case)
        if why:
            return "found", why
        if deep and sum(node_counts(case).values()) < MESHED_NODES:
            began = math.inf  # meshing takes its time
            prepare(case, folder=folder)
    except DdfError as error:
        return _timed("refused", began) if error.exit_code == 2 else ("found", f"exit code {error.exit_code}: {error}")
    except Exception:
        return "found", traceback.format_exc()
    return _timed("accepted", began)


def _timed(what: str, began: float) -> tuple[str, str]:
    seconds = time.process_time() - began
    return ("found", f"{what} after {seconds:.1f} s") if seconds > SLOW_S else (what, "")


def fuzz(seconds: float, seed: int, deep: bool) -> tuple[dict[str, int], list[str]]:
    """Try cases for a time; returns how many were refused and accepted, and every find."""
    seeds = [file.read_bytes() for file in sorted((ROOT / "cases").glob("*.toml"))]
    tables = [tomllib.loads(data.decode()) for data in seeds]
    counts, finds = {"refused": 0, "accepted": 0, "found": 0}, []
    end, number = time.monotonic() + seconds, seed * 10_000_000
    with tempfile.TemporaryDirectory(prefix="ddf-fuzz-") as name:
        folder = Path(name)
        for shape in ("box", "cylinder"):
            (folder / f"{shape}.step").write_bytes((ROOT / f"meshes/{shape}.step").read_bytes())
        while time.monotonic() < end:
            number += 1
            chance = random.Random(number)
            pick = chance.randrange(len(seeds))
            data = mutated_bytes(seeds[pick], chance) if chance.random() < 0.3 else mutated_tables(tables[pick], chance)
            what, why = judged(data, folder, deep)
            counts[what] += 1
            if what == "found":
                finds.append(f"case {number}: {why}\n{data[:4000].decode(errors='replace')}")
    return counts, finds


def main() -> int:
    """Try cases and print what was found; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--deep", action="store_true", help="Mesh small cases too.")
    args = parser.parse_args()
    counts, finds = fuzz(args.seconds, args.seed, args.deep)
    for find in finds:
        print(find)
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    return 1 if finds else 0


if __name__ == "__main__":
    sys.exit(main())
