"""The case that `ddf init` writes, and the reference of all keys, generated from the models."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from ddf.case import schema
from ddf.case.base import Section
from ddf.case.preset_data import PRESET_SOURCES
from ddf.case.words import length_text, properties, range_text, type_text

TEMPLATE: str = (files("ddf.case") / "template.toml").read_text(encoding="utf-8")

_TABLES: tuple[tuple[str, type[Section]], ...] = (
    ("(top of the file)", schema.Case),
    ("[target]", schema.Target),
    ("[frame]", schema.Frame),
    ("[diaphragms]", schema.Diaphragms),
    ('[materials.NAME], kind = "woven"', schema.WovenMaterial),
    ("[materials.NAME.shear_table]", schema.ShearTable),
    ('[materials.NAME], kind = "hyperelastic"', schema.HyperelasticMaterial),
    ("[[materials.NAME.ogden]]", schema.OgdenTerm),
    ("[[plies]]", schema.Ply),
    ("[friction]", schema.Friction),
    ("[tool]", schema.Tool),
    ("[process]", schema.Process),
    ("[[process.stages]]", schema.Stage),
    ("[process.breakpoints]", schema.Breakpoints),
    ("[solver]", schema.Solver),
    ("[kinematic]", schema.Kinematic),
    ("[output]", schema.Output),
)
_HEADING = "| key | type | default | range | meaning |\n|---|---|---|---|---|"


def schema_text() -> str:
    """Return the reference of all keys of a case file as Markdown, a table for each section."""
    parts = [
        "# Keys of a case file",
        "A case is a TOML file. Units are in the keys: mm, deg, s, absolute kPa. A default of - means that "
        "the key may be left out, with the effect its meaning says. "
        "'Inferred' marks defaults that are not in a publication.",
    ]
    for heading, section in _TABLES:
        purpose = (section.__doc__ or "").strip().splitlines()[0]
        parts += [f"## `{heading}`", purpose, keys_table(section)]
    parts += ["## Material presets"]
    parts += ["\n".join(f"- `{name}`: {source}" for name, source in PRESET_SOURCES.items())]
    return "\n\n".join(parts) + "\n"


def keys_table(section: type[Section]) -> str:
    """Return the keys of one table as a Markdown table."""
    return "\n".join([_HEADING, *(_row(key, node, section) for key, node in properties(section).items())])


def schema_json() -> str:
    """Return the JSON schema of a case file as text, for editors that check TOML against one."""
    return json.dumps(schema.Case.model_json_schema(), indent=2) + "\n"


def _row(key: str, node: dict[str, Any], section: type[Section]) -> str:
    bounds = "; ".join(text for text in (range_text(node), length_text(node)) if text)
    cells = [f"`{key}`", type_text(node), _default(key, section), bounds, node.get("description", "")]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _default(key: str, section: type[Section]) -> str:
    field = section.model_fields[key]
    if section is schema.Ply and key == "name":
        return "ply-N"
    if field.is_required():
        return "required"
    if field.default_factory is not None or isinstance(field.default, Section):
        return "its defaults"
    return "-" if field.default is None else f"`{json.dumps(field.default)}`"
