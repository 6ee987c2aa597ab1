"""How quick this machine is: what the last runs here took, over what was estimated of them.

Estimates are sums of costs a node and step, measured on one core of about 2.5 GHz; other machines are up to three times
as quick. The ratios are kept beside the compiled kernels (`kernel_cache`), in a file that may be deleted at any time.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path
from statistics import median

KEPT = 9
"""Runs that count."""
SHORTEST_S = 5.0  # a run whose steps took less says more of what is done between them


def _file() -> Path:
    return Path(os.environ.get("NUMBA_CACHE_DIR", "")).parent / "past-runs.json"


def _ratios() -> list[float]:
    with suppress(OSError, ValueError):
        found = json.loads(_file().read_text())
        if isinstance(found, list):
            return [float(ratio) for ratio in found if isinstance(ratio, int | float) and 0.0 < ratio < 1e3]
    return []


def learn(estimated_s: float, took_s: float) -> None:
    """Note what a run's steps took [s] that had been estimated to take so long [s]; short runs are passed over."""
    if took_s < SHORTEST_S or estimated_s <= 0.0 or "NUMBA_CACHE_DIR" not in os.environ:
        return
    text = json.dumps([*_ratios(), round(took_s / estimated_s, 3)][-KEPT:])
    with suppress(OSError):
        new = _file().with_suffix(f".{os.getpid()}")
        new.write_text(text)
        new.replace(_file())


def slowness() -> tuple[float, int]:
    """What steps take here over what is estimated, the median of the last runs, and their number; (1, 0): none."""
    ratios = _ratios()
    return (median(ratios), len(ratios)) if ratios else (1.0, 0)
