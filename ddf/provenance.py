"""Where a result came from: versions, host, state of the source."""

from __future__ import annotations

import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ddf import __version__

PACKAGES = ("numpy", "numba", "llvmlite", "scipy", "gmsh", "meshio", "vtk", "pydantic", "matplotlib")


def package_versions() -> dict[str, str]:
    """Versions of the packages that the result depends on."""
    found = {}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def source_state() -> str:
    """Commit of the source tree, with `-dirty` if it was changed; empty outside a git checkout."""
    folder = Path(__file__).resolve().parent.parent
    if not (folder / ".git").exists():
        return ""
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), "describe", "--always", "--dirty"],
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip()


def peak_memory_mib() -> float | None:
    """Largest memory that this process has held so far [MiB]; None where the system does not tell.

    Linux: VmHWM of the process by itself (getrusage's figure begins with what its parent held).
    """
    try:
        status = Path("/proc/self/status").read_text(encoding="utf-8")
        return round(float(status.partition("VmHWM:")[2].split()[0]) / 1024, 1)
    except (OSError, IndexError, ValueError):
        pass
    try:
        import resource
    except ImportError:
        return None
    unit = 2**20 if platform.system() == "Darwin" else 1024
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit, 1)


def provenance() -> dict[str, Any]:
    """Version, source, packages, Python, host and time of writing."""
    return {
        "ddf": __version__,
        "source": source_state(),
        "packages": package_versions(),
        "python": platform.python_version(),
        "host": f"{platform.system()} {platform.machine()}, {platform.processor() or 'unknown processor'}",
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
    }
