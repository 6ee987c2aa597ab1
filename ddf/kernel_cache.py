"""Where compiled kernels are kept between runs.

numba notices that a kernel's own file has changed, but not that a function it calls in another file has. So
the cache folder carries a digest of every source that holds kernels and of all that these import from the
package: a changed kernel never meets old machine code, and a changed report recompiles nothing. The folder is
below DDF_CACHE_DIR, else NUMBA_CACHE_DIR, else the user's cache folder, else (not writable) a temporary one.
"""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from pathlib import Path

IMPORT = re.compile(r"^from (ddf[\w.]*) import ([\w, ]+)", re.MULTILINE)


def kernel_sources(package: Path) -> list[Path]:
    """Files below a package's folder that use numba, and those they import from the package, sorted."""
    todo = [
        path for path in package.rglob("*.py") if re.search(r"^(from|import) numba", path.read_text(), re.MULTILINE)
    ]
    found: set[Path] = set()
    while todo:
        path = todo.pop()
        if path in found:
            continue
        found.add(path)
        for module, names in IMPORT.findall(path.read_text()):
            below = package.joinpath(*module.split(".")[1:])
            places = [
                below.with_suffix(".py"),
                below / "__init__.py",
                *(below / f"{n.strip()}.py" for n in names.split(",")),
            ]
            todo.extend(place for place in places if place.is_file())
    return sorted(found)


def source_digest(package: Path) -> str:
    """Digest of all sources that kernels are compiled from, names and contents."""
    digest = hashlib.sha256()
    for path in kernel_sources(package):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def use_cache() -> Path:
    """Point numba at this package's own cache folder and return it."""
    given = os.environ.get("DDF_CACHE_DIR") or os.environ.get("NUMBA_CACHE_DIR")
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    base = Path(given) if given else Path(home) / "ddf"
    folder = base / source_digest(Path(__file__).parent)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(folder)
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="ddf-cache-"))
    os.environ["NUMBA_CACHE_DIR"] = str(folder)
    return folder
