"""Files that are either whole or absent: written under a temporary name beside their place, then renamed."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ddf.errors import DdfError

TEMPORARY_PREFIX = ".ddf-"

_HINTS = {
    errno.ENOSPC: ("the disk is full", "free some space, or choose another folder"),
    errno.EDQUOT: ("the disk quota is used up", "free some space, or choose another folder"),
    errno.EROFS: ("the file system is read-only", "choose a folder that can be written to"),
    errno.EACCES: ("no permission to write there", "choose a folder that can be written to"),
    errno.EPERM: ("no permission to write there", "choose a folder that can be written to"),
    errno.ENOTDIR: ("a part of its path is a file, not a folder", "choose another folder"),
    errno.EISDIR: ("there is a folder of that name", "choose another folder"),
}


@contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Turn an OSError of the block into a DdfError that names `path` and says what to do."""
    try:
        yield
    except OSError as error:
        reason, hint = _HINTS.get(error.errno or 0, (error.strerror or str(error), ""))
        raise DdfError(f"cannot write {path}: {reason}", hint) from error


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path in the same folder to write to; on success it is flushed to disk and takes the place.

    On any failure the temporary file is removed and what was at `path` stays. Raises DdfError where the disk
    is full or the folder cannot be written to.
    """
    with write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        number, name = tempfile.mkstemp(prefix=TEMPORARY_PREFIX, suffix=path.suffix, dir=path.parent)
        os.close(number)
        temporary = Path(name)
        try:
            yield temporary
            temporary.chmod(0o666 & ~_umask())
            with temporary.open("rb+") as stream:
                os.fsync(stream.fileno())
            os.replace(temporary, path)
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file as a whole; raises DdfError."""
    with replacing(path) as temporary, temporary.open("wb") as stream:
        stream.write(data)
        stream.flush()


def _umask() -> int:
    """The umask of this process: temporary files are private, the files of a run are not."""
    with suppress(OSError, ValueError, IndexError), open("/proc/self/status") as status:
        for line in status:
            if line.startswith("Umask:"):
                return int(line.split()[1], 8)
    return 0o022
