"""Types and ranges of keys in words, read from the models' JSON schema."""

from __future__ import annotations

from functools import cache
from typing import Any

from ddf.case import schema
from ddf.case.base import Section

KeyPath = tuple[str | int, ...]

_TYPES = {"number": "number", "integer": "integer", "string": "text", "boolean": "true or false"}
_LOW = {"minimum": ">=", "exclusiveMinimum": ">"}
_HIGH = {"maximum": "<=", "exclusiveMaximum": "<"}


def section_at(path: KeyPath, raw: Any) -> type[Section] | None:
    """Return the model of the table at a key path, or None where the path leads to no table."""
    match path:
        case ():
            return schema.Case
        case ("plies", int()):
            return schema.Ply
        case ("process", "stages", int()):
            return schema.Stage
        case ("process", "breakpoints"):
            return schema.Breakpoints
        case ("materials", str(), "ogden", int()):
            return schema.OgdenTerm
        case ("materials", str(), "shear_table"):
            return schema.ShearTable
        case ("materials", str()):
            kind = value_at(raw, (*path, "kind"))
            return schema.HyperelasticMaterial if kind == "hyperelastic" else schema.WovenMaterial
        case (str(name),):
            return SECTIONS.get(name)
    return None


SECTIONS: dict[str, type[Section]] = {
    "frame": schema.Frame,
    "diaphragms": schema.Diaphragms,
    "friction": schema.Friction,
    "tool": schema.Tool,
    "process": schema.Process,
    "solver": schema.Solver,
    "kinematic": schema.Kinematic,
    "output": schema.Output,
}


def value_at(raw: Any, path: KeyPath) -> Any:
    """Return the value at a key path of nested tables and lists; None where there is none."""
    for part in path:
        if isinstance(raw, dict) and isinstance(part, str):
            raw = raw.get(part)
        elif isinstance(raw, list | tuple) and isinstance(part, int) and part < len(raw):
            raw = raw[part]
        else:
            return None
    return raw


@cache
def properties(section: type[Section]) -> dict[str, Any]:
    """Return the JSON schema of each key of a section."""
    found: dict[str, Any] = section.model_json_schema()["properties"]
    return found


def _choices(node: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the alternatives of a JSON schema, without 'nothing', which TOML cannot say."""
    return [choice for choice in node.get("anyOf", [node]) if choice.get("type") != "null"]


def _list_of(node: dict[str, Any]) -> dict[str, Any] | None:
    """Return the alternative that is a list, if there is one."""
    return next((choice for choice in _choices(node) if choice.get("type") == "array"), None)


def item_of(node: dict[str, Any]) -> dict[str, Any] | None:
    """Return the JSON schema of a list's items, if it is one."""
    node = _list_of(node) or {}
    return node.get("items") or next(iter(node.get("prefixItems", ())), None)


def shortest(node: dict[str, Any]) -> int:
    """Return the smallest length of a list; 0 for anything else."""
    return int((_list_of(node) or {}).get("minItems", 0))


def type_text(node: dict[str, Any]) -> str:
    """Return what kind of value a JSON schema asks for, such as 'list of 2 numbers'."""
    return " or ".join(_one_type(choice) for choice in _choices(node))


def _one_type(node: dict[str, Any]) -> str:
    if "enum" in node:
        return "one of " + ", ".join(node["enum"])
    if "const" in node:
        return f"the text {node['const']}"
    if node.get("type") == "array":
        if "prefixItems" in node:
            return f"list of {len(node['prefixItems'])} {type_text(node['prefixItems'][0])}s"
        inner = type_text(node["items"])
        return "list of " + (inner.replace("list", "lists", 1) if inner.startswith("list") else inner + "s")
    return _TYPES.get(str(node.get("type")), "table")


def range_text(node: dict[str, Any]) -> str:
    """Return the range of a number, or of a list's numbers, such as '> 0, <= 50'; '' if there is none."""
    node = _choices(node)[0]
    item = item_of(node)
    if item is not None:
        return range_text(item)
    bounds = [f"{sign} {node[key]:g}" for key, sign in (_LOW | _HIGH).items() if key in node]
    return ", ".join(bounds)


def length_text(node: dict[str, Any]) -> str:
    """Return how many items a list may have, such as '1 to 20 items'; '' for anything but a list."""
    listed = _list_of(node)
    if listed is None:
        return ""
    low, high = listed.get("minItems", 0), listed.get("maxItems")
    if high is None:
        return f"at least {low} items"
    return f"{low} items" if low == high else f"{low} to {high} items"
