"""A sweep in words."""

from __future__ import annotations

from ddf.sweep.runner import SweepProgress


def progress_line(p: SweepProgress) -> str:
    """How a sweep stands, as one line."""
    running = ", ".join(f"{name} {100 * share:.0f} %" for name, share in p.running.items())
    return (
        f"{p.finished} of {p.cases} finished, {p.failed} failed; running {running or 'none'}; "
        f"elapsed {p.elapsed_s:.0f} s"
    )
