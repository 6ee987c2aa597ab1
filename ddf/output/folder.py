"""The folder of a run: made, refused or emptied, and written to file by file as a whole."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from ddf.errors import UsageError
from ddf.output import atomic

#: subfolders and the endings of what is in them
SUBFOLDERS = {
    "frames": ("vtu",),
    "profiles": ("csv",),
    "patterns": ("csv",),
    "pictures": ("png",),
    "export": ("vtu", "csv", "dxf", "svg", "gif", "mp4"),
}
#: temporary files, as patterns from the folder's top
LEFTOVERS = tuple(f"{inner}{atomic.TEMPORARY_PREFIX}*" for inner in ("", *(f"{inner}/" for inner in SUBFOLDERS)))
#: what ddf writes into a folder, as patterns from its top: all that --force removes
KNOWN = (
    "case.toml",
    "case.resolved.toml",
    "run.json",
    "log.txt",
    "history.csv",
    "wrinkles.csv",
    "metrics.json",
    "metrics.csv",
    "comparison.json",
    "checkpoint.npz",
    "report.html",
    "*.pvd",
    *(f"{inner}/*.{ending}" for inner, endings in SUBFOLDERS.items() for ending in endings),
    *LEFTOVERS,
)
#: at least one of these is in any folder that a run was started in
MARKS = ("run.json", "comparison.json", "case.resolved.toml", "history.csv", "checkpoint.npz", "log.txt")


class RunFolder:
    """A folder of results. Names are relative to it; `/` leads to its subfolders."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)

    @classmethod
    def create(cls, path: str | Path, force: bool = False, resume: bool = False) -> RunFolder:
        """Make the folder, or take over one that is there.

        A folder that is not empty is refused unless `resume` (kept as it is) or `force` (what ddf wrote is
        removed, other files stay). Raises UsageError for the refusal, DdfError if it cannot be made.
        """
        folder = cls(path)
        folder.refuse(force, resume)
        with atomic.write_errors(folder.path):
            folder.path.mkdir(parents=True, exist_ok=True)
        if force and not resume:
            folder.empty()
        return folder

    def refuse(self, force: bool = False, resume: bool = False) -> None:
        """Raise UsageError if a run may not use the folder, DdfError if it cannot be looked at; change nothing."""
        with atomic.write_errors(self.path):
            if self.path.exists() and not self.path.is_dir():
                raise UsageError(f"{self.path} is a file, not a folder", "choose another folder with -o")
            filled = self.path.exists() and any(self.path.iterdir())
        if filled and not resume and not force:
            raise UsageError(
                f"{self.path} is not empty",
                "--resume goes on with the run in it, --force replaces it; or choose another folder with -o",
            )

    @property
    def started(self) -> bool:
        """Whether a run was started in the folder."""
        return any((self.path / name).exists() for name in MARKS)

    def sweep(self) -> None:
        """Remove temporary files that a killed run has left."""
        with atomic.write_errors(self.path):
            for pattern in LEFTOVERS:
                for file in self.path.glob(pattern):
                    file.unlink(missing_ok=True)

    def __truediv__(self, name: str) -> Path:
        return self.path / name

    def empty(self) -> None:
        """Remove what ddf wrote, and its subfolders if nothing else is in them; nothing where no run was."""
        if not self.started:
            return
        with atomic.write_errors(self.path):
            for pattern in KNOWN:
                for file in self.path.glob(pattern):
                    if file.is_file() or file.is_symlink():
                        file.unlink()
            for name in SUBFOLDERS:
                inner = self.path / name
                if inner.is_dir() and not inner.is_symlink() and not any(inner.iterdir()):
                    inner.rmdir()

    def write_bytes(self, name: str, data: bytes) -> Path:
        """Write a file as a whole and return its path; raises DdfError (disk full, read-only)."""
        atomic.write_bytes(self.path / name, data)
        return self.path / name

    def write_text(self, name: str, text: str) -> Path:
        """Write UTF-8 text as a whole and return its path; raises DdfError."""
        return self.write_bytes(name, text.encode("utf-8"))

    def write_json(self, name: str, value: Any) -> Path:
        """Write JSON as a whole and return its path; NaN and infinity become null. Raises DdfError."""
        return self.write_text(name, json.dumps(plain(value), indent=2, ensure_ascii=False) + "\n")


def plain(value: Any) -> Any:
    """The value as JSON has it: numpy to Python, tuples to lists, paths to text, not finite to None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else str(value)
