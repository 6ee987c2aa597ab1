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
