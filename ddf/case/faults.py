"""Problems of a case in human words: what is wrong, what is allowed, what may have been meant."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from ddf.case.materials import merged_with_base
from ddf.case.words import (
    SECTIONS,
    KeyPath,
    item_of,
    length_text,
    properties,
    range_text,
    section_at,
    shortest,
    type_text,
    value_at,
)

KINDS = ("woven", "hyperelastic")
MOST = 1000  # faults beyond this number are not looked into: the file is no case


@dataclass(frozen=True)
class Problem:
    """A fault that has no line yet: the key path, what is wrong, what is allowed."""

    path: KeyPath
    problem: str
    allowed: str = ""
    suggestion: str = ""


def closest(word: str, known: Iterable[str]) -> str:
    """Return the known word most like `word`, or '' where none is near."""
    by_folded = {name.casefold(): name for name in known}
    found = difflib.get_close_matches(word.casefold()[:200], by_folded, n=1, cutoff=0.6)
    return by_folded[found[0]] if found else ""


def problems_of(error: ValidationError, raw: Any) -> list[Problem]:
    """Translate every error of a validation of the whole case `raw`, each problem once."""
    found: dict[Problem, None] = {}
    for detail in error.errors(include_url=False)[:MOST]:
        problem = _translate(detail, raw)
        if problem is not None:
            found[problem] = None
    return list(found)


def key_path(loc: KeyPath, raw: Any) -> KeyPath:
    """Return the key path in the file of pydantic's location: without union tags and items of a scalar."""
    if len(loc) > 2 and loc[0] == "materials" and loc[2] in KINDS:
        loc = (*loc[:2], *loc[3:])
    while loc and isinstance(loc[-1], int) and not _has(raw, loc):
        loc = loc[:-1]
    return loc


def _has(raw: Any, path: KeyPath) -> bool:
    holder, last = value_at(raw, path[:-1]), path[-1]
    if isinstance(holder, dict):
        return last in holder
    return isinstance(holder, list | tuple) and isinstance(last, int) and last < len(holder)


def _translate(detail: Any, raw: Any) -> Problem | None:
    kind, context = detail["type"], detail.get("ctx") or {}
    path = key_path(tuple(detail["loc"]), raw)
    value = value_at(raw, path)
    if kind == "extra_forbidden":
        return _unknown_key(path, raw)
    if kind == "union_tag_not_found":
        return Problem((*path, "kind"), "required key is missing", ", ".join(KINDS))
    if kind == "union_tag_invalid":
        path = (*path, "kind")
        value, context = value_at(raw, path), {"expected": ", ".join(f"'{name}'" for name in KINDS)}
        kind = "literal_error"
    if kind == "literal_error":
        choices = re.findall(r"'([^']*)'", str(context.get("expected", "")))
        hint = closest(value, choices) if isinstance(value, str) else ""
        return Problem(path, f"{shown(value)} is not one of the choices", ", ".join(choices), hint)
    if kind == "missing" and not isinstance(detail["loc"][-1], int):
        if _waits_for_base(path, raw):
            return None
        node = _node(path, raw)
        allowed = (range_text(node) or type_text(node)) if node else ""
        return Problem(path, "required key is missing", allowed)
    return _wrong_value(kind, path, value, raw, detail["msg"])


def _waits_for_base(path: KeyPath, raw: Any) -> bool:
    """Say whether a missing key is one of a material whose base is wrong, which is reported instead."""
    table = value_at(raw, path[:2]) if path[0] == "materials" and len(path) == 3 else None
    return isinstance(table, dict) and isinstance(table.get("base"), str) and merged_with_base(table) is table


def _wrong_value(kind: str, path: KeyPath, value: Any, raw: Any, message: str) -> Problem | None:
    """Say what is wrong with a value that was given."""
    node = _node(path, raw)
    length = length_text(node) if node else ""
    if kind in ("too_short", "too_long", "missing"):
        if kind == "too_short" and node and isinstance(value, list) and len(value) >= shortest(node):
            return None  # Short only because items in it are faulty, and those are reported.
        return Problem(path, f"has {_count(value)}", length)
    if kind.startswith(("greater_than", "less_than")):
        return Problem(path, f"{shown(value)} is out of range", range_text(node) if node else "")
    if kind == "finite_number":
        return Problem(path, f"{shown(value)} is not a finite number", range_text(node) if node else "")
    if kind == "string_pattern_mismatch":
        return Problem(path, f"{shown(value)} is not a name", "letters, digits, '.', '_' and '-'")
    if kind.startswith("string_too"):
        return Problem(path, "is too short" if kind.endswith("short") else "is too long", message)
    if kind.endswith("_type") or kind.endswith("_parsing"):
        wanted = type_text(node) if node else "another type"
        return Problem(path, f"{shown(value)} is not the right type", wanted)
    return Problem(path, message)


def _unknown_key(path: KeyPath, raw: Any) -> Problem:
    section = section_at(path[:-1], raw)
    key = str(path[-1])
    known = list(properties(section)) if section else []
    suggestion = closest(key, known)
    if not suggestion:
        homes = [name for name, other in SECTIONS.items() if key in properties(other)]
        suggestion = f"{homes[0]}.{key}" if len(homes) == 1 else ""
    return Problem(path, "unknown key", ", ".join(known), suggestion)


def _node(path: KeyPath, raw: Any) -> dict[str, Any] | None:
    """Return the JSON schema of the value at a path: of a key, of an item of its list, or of a table."""
    for cut in range(len(path) - 1, -1, -1):
        section = section_at(path[:cut], raw)
        if section is None:
            continue
        node = properties(section).get(str(path[cut]))
        for _ in path[cut + 1 :]:
            node = item_of(node) if node else None
        return node
    return None


def _count(value: Any) -> str:
    count = len(value) if isinstance(value, list | tuple) else 0
    return "1 item" if count == 1 else f"{count} items"


def shown(value: Any) -> str:
    """Return a value as it may stand in a message: as in TOML, and never long."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return "a list"
    if isinstance(value, int) and abs(value) > 10**30:
        return "so large a number"
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
