"""Where compiled kernels are kept between runs.

numba notices that a kernel's own file has changed, but not that a function it calls in another file has. So
the cache folder carries a digest of all sources: a changed package never meets old machine code. The folder
is DDF_CACHE_DIR, else NUMBA_CACHE_DIR, else the user's cache folder, else (not writable) a temporary one.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path


def source_digest(package: Path) -> str:
    """Digest of all Python files below a folder, names and contents."""
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
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
