"""Where compiled kernels are kept between runs.

numba notices that a kernel's own file has changed, but not that a function it calls in another file has. So
the cache folder carries a digest of every source that holds kernels and of all that these import from the
package: a changed kernel never meets old machine code, and a changed report recompiles nothing. The folder is
below DDF_CACHE_DIR, else NUMBA_CACHE_DIR, else the user's cache folder (XDG_CACHE_HOME); where that cannot be written
to, below the user's own folder among the temporary files, which the next run finds again.

A process that compiles kernels and one that loads them do not compute the same last digits: the first calls the
copies of shared functions that it compiled one by one, the second those that were optimised within each kernel.
So that a run that is resumed is the same to the last bit, all kernels are compiled in a process of their own, and
every run loads them.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ddf.errors import DdfError

IMPORT = re.compile(r"^from (ddf[\w.]*) import (\([^)]*\)|[\w, ]+)", re.MULTILINE)
TEMPORARY = "ddf-kernels-"


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
                *(below / f"{n.strip()}.py" for n in names.strip("()").split(",")),
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


def use_cache() -> Path | None:
    """Point numba at this package's own cache folder and return it; None where no folder can be written to."""
    digest = source_digest(Path(__file__).parent)
    for place in (_wanted_place, _temporary_place):
        with suppress(OSError):
            base = place()
            folder = base if base.name == digest else base / digest  # handed on by a process that has set it
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK):
                os.environ["NUMBA_CACHE_DIR"] = str(folder)
                return folder
    os.environ.pop("NUMBA_CACHE_DIR", None)
    return None


def _wanted_place() -> Path:
    """Where compiled kernels should be kept."""
    given = os.environ.get("DDF_CACHE_DIR") or os.environ.get("NUMBA_CACHE_DIR")
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(given) if given else Path(home) / "ddf"


def _temporary_place() -> Path:
    """The user's own folder among the temporary files, the same one each time. Raises OSError where there is none.

    What is loaded from it runs as this user, so that one to which others can write is not used.
    """
    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir()) / f"{TEMPORARY}{user}"
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if hasattr(os, "getuid") and (found.st_uid != user or not stat.S_ISDIR(found.st_mode) or found.st_mode & 0o022):
        return Path(tempfile.mkdtemp(prefix=TEMPORARY))
    return folder


def cache_note() -> str:
    """Where compiled kernels are, if the usual place cannot be written to: a line for the log, else empty."""
    folder = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
    if not folder.parent.name.startswith(TEMPORARY):
        return ""
    return f"the cache folder cannot be written to: kernels are kept in {folder} (DDF_CACHE_DIR chooses another)"


def warm_kernels(say: Callable[[str], None] | None = None) -> None:
    """Compile all kernels in a process of their own, unless that was done; others that need them wait.

    `say` is told before it begins. Where that process fails, a warning says so, and kernels are compiled where they are
    used. Raises DdfError where there is no place for them.
    """
    import subprocess
    from importlib.metadata import version

    if "NUMBA_CACHE_DIR" not in os.environ:
        raise DdfError("compiled kernels can be kept nowhere", "set DDF_CACHE_DIR to a folder that can be written to")
    package = Path(__file__).resolve().parent
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    mark = f"{package} {sys.version} numba {version('numba')} llvmlite {version('llvmlite')}"
    marker = folder / f"compiled-{hashlib.sha256(mark.encode()).hexdigest()[:16]}"
    if marker.exists():
        return
    path = os.pathsep.join(filter(None, [str(package.parent), os.environ.get("PYTHONPATH")]))
    environment = os.environ | {"DDF_CACHE_DIR": str(folder.parent), "PYTHONPATH": path}
    with _one_at_a_time(folder):
        if marker.exists():
            return
        if say is not None:
            say("compiling the solver for this machine: a minute or two, once")
        command = [sys.executable, "-m", "ddf.compile_kernels"]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            marker.touch()
            return
    last = (done.stderr.strip().splitlines() or ["no message"])[-1]
    warnings.warn(
        f"kernels could not be compiled in a process of their own ({last}); if this run is resumed, it may differ in "
        "the last digits",
        stacklevel=2,
    )


@contextmanager
def _one_at_a_time(folder: Path) -> Iterator[None]:
    """Wait until no other process holds the folder's lock, and hold it; no lock where the system has none."""
    try:
        import fcntl

        with open(folder / "lock", "w") as stream:
            fcntl.flock(stream, fcntl.LOCK_EX)
            yield
    except ImportError:
        yield
