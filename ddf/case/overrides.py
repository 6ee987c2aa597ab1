"""Changes to a case from the command line, such as "solver.threads=1" or "plies.0.element_mm=4"."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ddf.case.words import KeyPath
from ddf.errors import Fault

SOURCE = "--set"


@dataclass(frozen=True)
class Override:
    """One change: its number on the command line (from 1) and the key path it sets."""

    number: int
    path: KeyPath


def apply_overrides(
    raw: dict[str, Any], overrides: Sequence[str]
) -> tuple[dict[str, Any], tuple[Override, ...], list[Fault]]:
    """Return the changed tables, what was changed, and a fault for each override that makes no sense."""
    raw = copy.deepcopy(raw) if overrides else raw
    done: list[Override] = []
    faults: list[Fault] = []
    for number, text in enumerate(overrides, start=1):
        key, equals, value = text.partition("=")
        key = key.strip()
        names = _names(key)
        if not equals or not names:
            faults.append(Fault(SOURCE, number, key, f"{text!r} is not a change", "key=value"))
            continue
        found, problem = _value(value.strip())
        if not problem:
            path, problem = _put(raw, names, found)
            if not problem:
                done.append(Override(number, path))
        if problem:
            faults.append(Fault(SOURCE, number, key, problem))
    return raw, tuple(done), faults


def put(raw: dict[str, Any], key: str, value: Any) -> None:
    """Set the value of a dotted key in nested tables. Raises KeyError where there is no such place."""
    problem = _put(raw, _names(key), value)[1]
    if problem:
        raise KeyError(f"{key}: {problem}")


def override_of(path: KeyPath, changes: Sequence[Override], *, made: bool = False) -> Override | None:
    """Return the last change that set the value at a key path, or a table around it.

    made: or one in the table at that path, which the file does not have: the change has made it.
    """
    for change in reversed(changes):
        if path[: len(change.path)] == change.path or (made and path and change.path[: len(path)] == path):
            return change
    return None


def _names(key: str) -> list[str]:
    """Split a dotted key as TOML does, quoted parts included; empty where it is none."""
    try:
        table: Any = tomllib.loads(f"{key} = 0")
    except (ValueError, RecursionError):
        return []
    names = []
    while isinstance(table, dict) and len(table) == 1:
        name, table = next(iter(table.items()))
        names.append(name)
    return names if table == 0 else []


def _value(text: str) -> tuple[Any, str]:
    """Return the value of a TOML text, or the text itself where it is plainly no TOML; else a problem."""
    try:
        table = tomllib.loads(f"value = {text}")
        if list(table) == ["value"]:
            return table["value"], ""
    except (ValueError, RecursionError):
        pass
    if not text or text[0] in "[{\"'":
        return None, f"the value {text!r} is not valid TOML"
    return text, ""


def _put(raw: dict[str, Any], names: list[str], value: Any) -> tuple[KeyPath, str]:
    """Set the value at a path, making tables on the way; return the path with list places as integers."""
    holder: Any = raw
    path: KeyPath = ()
    for depth, name in enumerate(names):
        last = depth == len(names) - 1
        part: str | int = name
        if isinstance(holder, list):
            if not name.isdecimal() or int(name) >= len(holder):
                there = f"it has {len(holder)}, counted from 0"
                return path, f"{'.'.join(names[:depth])} has no item {name!r}: {there}"
            part = int(name)
        elif not isinstance(holder, dict):
            return path, f"{'.'.join(names[:depth])} is not a table"
        path = (*path, part)
        if last:
            holder[part] = value
        elif isinstance(holder, dict):
            holder = holder.setdefault(name, {})
        else:
            holder = holder[part]
    return path, ""
