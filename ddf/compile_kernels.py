"""Compile every kernel by a run of a tiny case: what `ddf.kernel_cache.warm_kernels` starts as a process of its own."""

from __future__ import annotations

import tempfile
from typing import Any

TINY: dict[str, Any] = {
    "title": "compiling",
    "frame": {"length_mm": 200, "width_mm": 200},
    "diaphragms": {"element_mm": 10.0},
    "plies": [{"size_mm": [80, 80], "element_mm": 8.0}, {"size_mm": [80, 80], "element_mm": 8.0}],
    "tool": {"shape": "hemisphere", "radius_mm": 20.0},
    "process": {
        "stages": [
            {"name": "evacuate", "duration_s": 0.001, "cavity_pressure_kPa": 0.0},
            {"name": "lift", "duration_s": 0.002, "tool_lift_mm": 1.0},
        ]
    },
    "solver": {"energy_error_limit_percent": 1000.0},
    "output": {"frames_per_stage": 1},
}


def main() -> None:
    """Run the tiny case in a temporary folder."""
    from ddf.case import case_from_dict
    from ddf.run import run_case

    with tempfile.TemporaryDirectory(prefix="ddf-compile-") as folder:
        run_case(case_from_dict(TINY), f"{folder}/run", threads=1, compiled=True)


if __name__ == "__main__":
    main()
