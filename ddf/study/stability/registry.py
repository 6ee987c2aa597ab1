"""The limits by name, in the order in which they are charted; a module is imported when its limit is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module

from ddf.errors import UsageError
from ddf.study.stability.map import Limit

#: name on the command line -> module of this package and the limit in it
LIMITS: dict[str, tuple[str, str]] = {
    "step": ("step", "LIMIT"),
    "fibre-step": ("fibre_step", "IMPLICIT"),
    "fibre-damping": ("fibre_step", "EXPLICIT"),
    "inertia": ("inertia", "LIMIT"),
    "layer-contact": ("layers", "LIMIT"),
    "shear-bands": ("shear_bands", "PUBLISHED"),
    "shear-bands-monotone": ("shear_bands", "MONOTONE"),
    "wavelength": ("wavelength", "LIMIT"),
    "misaligned-fibres": ("misaligned", "LIMIT"),
    "hourglass": ("hourglass", "LIMIT"),
    "compressed-rubber": ("rubber", "LIMIT"),
    "fold": ("fold", "LIMIT"),
}


def load_limit(name: str) -> Limit:
    """The limit of that name."""
    module, attribute = LIMITS[name]
    limit: Limit = getattr(import_module(f"ddf.study.stability.{module}"), attribute)
    return limit


def choose_limits(names: Sequence[str]) -> list[Limit]:
    """Limits by name in the order asked for, or all. Raises UsageError for unknown names."""
    for name in names:
        if name not in LIMITS:
            near = get_close_matches(name, LIMITS, n=1)
            hint = f"did you mean {near[0]}? " if near else ""
            raise UsageError(f"no limit is called {name!r}", f"{hint}limits: {', '.join(LIMITS)}")
    return [load_limit(name) for name in dict.fromkeys(names or LIMITS)]
