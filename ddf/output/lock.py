"""One run at a time in a folder: a lock that the system lets go of when its process ends, however it ends."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ddf.errors import UsageError


@contextmanager
def folder_lock(path: Path) -> Iterator[None]:
    """Hold the lock of an existing folder. Raises UsageError where another process has it.

    Where the system has no such locks (Windows, some network disks) there is none.
    """
    try:
        import fcntl

        number = os.open(path, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise UsageError(
                f"another run is writing to {path}", "wait for it or end it, or choose another folder with -o"
            ) from None
        except OSError:
            pass
        yield
    finally:
        os.close(number)
