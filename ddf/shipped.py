"""The cases and tool geometry that come with ddf, by name: in an installed package as in the source tree.

`cases/` and `meshes/` are folders at the top of the source tree; the wheel carries them as `ddf/shipped_data/`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

Kind = Literal["cases", "meshes"]

SUFFIX: dict[Kind, str] = {"cases": ".toml", "meshes": ".step"}
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9-]{0,63}")  # a bare name: no folder, no suffix


def shipped_folder(kind: Kind) -> Path:
    """Where the files of a kind are: beside the package in the source tree, within it when installed."""
    package = Path(__file__).resolve().parent
    installed = package / "shipped_data" / kind
    return installed if installed.is_dir() else package.parent / kind


def shipped_names(kind: Kind) -> list[str]:
    """Names of all files of a kind, sorted."""
    return sorted(path.stem for path in shipped_folder(kind).glob(f"*{SUFFIX[kind]}"))


def shipped_file(kind: Kind, name: str) -> Path | None:
    """The file of that name; None where `name` is no bare name or nothing of that name is shipped.

    A name with a suffix or a folder is a path of the user's and never meets a shipped file, so that a file that is
    not there is not taken for another of the same name.
    """
    if not NAME.fullmatch(name):
        return None
    path = shipped_folder(kind) / f"{name}{SUFFIX[kind]}"
    return path if path.is_file() else None


def file_or_shipped(kind: Kind, path: Path, name: str) -> Path:
    """The path where it is a file, else that of the shipped file called `name`, else (there is none) the path."""
    try:
        there = path.is_file()
    except (OSError, ValueError):  # too long a name, a zero byte in it
        there = False
    return path if there else shipped_file(kind, name) or path
