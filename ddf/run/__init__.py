"""Runs of cases: prepare, loop, end."""

from ddf.run.progress import Progress, RunResult
from ddf.run.start import default_threads, run_case

__all__ = ["Progress", "RunResult", "default_threads", "run_case"]
