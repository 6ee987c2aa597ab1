"""One gmsh session: lazy import, quiet, and finalised whatever happens."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from ddf.errors import MeshError

SYSTEM_PACKAGES = "libglu1-mesa libxrender1 libxcursor1 libxft2 libxinerama1 libgl1 libxi6"


def import_gmsh() -> Any:
    """The gmsh module; MeshError names the Debian packages when a shared library of its is missing."""
    try:
        import gmsh
    except OSError as error:
        raise MeshError(
            f"gmsh cannot be loaded: {error}", f"on Debian or Ubuntu: apt-get install {SYSTEM_PACKAGES}"
        ) from error
    except ImportError as error:
        raise MeshError(f"gmsh cannot be imported: {error}", "pip install gmsh") from error
    return gmsh


@contextmanager
def gmsh_session(name: str = "ddf") -> Iterator[Any]:
    """An initialised gmsh with one fresh model called `name`; single thread, so that meshes repeat exactly.

    Works any number of times, and inside a program that has already initialised gmsh (whose own models and
    options other than the terminal's are left alone). gmsh's plain `Exception` becomes a MeshError.
    """
    gmsh = import_gmsh()
    owned = not gmsh.isInitialized()
    if owned:
        with _signals_kept():
            gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add(name)
        yield gmsh
    except Exception as error:
        if type(error) is Exception:
            raise MeshError(f"gmsh failed on {name}: {error}") from error
        raise
    finally:
        if owned:
            with _signals_kept():
                gmsh.finalize()
        else:
            gmsh.model.remove()


@contextmanager
def _signals_kept() -> Iterator[None]:
    """Keep what the program does on signals: gmsh sets SIGTERM and SIGPIPE back to ending it at once."""
    names = ("SIGINT", "SIGTERM", "SIGPIPE", "SIGHUP")
    kept = {number: signal.getsignal(number) for name in names if (number := getattr(signal, name, None)) is not None}
    try:
        yield
    finally:
        with suppress(ValueError):  # not in the main thread
            for number, handler in kept.items():
                if handler is not None:
                    signal.signal(number, handler)
