"""From a TOML file to a `Case`, with all faults of the file in one go, and back to TOML."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from ddf.case.checks import cross_problems, valid_parts
from ddf.case.faults import Problem, closest, problems_of, shown
from ddf.case.locate import Lines, locate
from ddf.case.overrides import Override, apply_overrides, override_of
from ddf.case.rules import key_problems
from ddf.case.schema import Case
from ddf.errors import CaseError, Fault
from ddf.shipped import file_or_shipped, shipped_names

MAX_BYTES = 1_000_000
TOOL_SUFFIXES = (".step", ".stp", ".stl")


@dataclass(frozen=True)
class Source:
    """Where a case comes from, to give its problems their lines: also those that are found later."""

    file: str = "<case>"
    text: str = ""
    changes: tuple[Override, ...] = ()
    given_lines: Lines | None = None

    @cached_property
    def lines(self) -> Lines:
        """Lines of the text's keys."""
        return locate(self.text) if self.given_lines is None else self.given_lines

    def fault(self, problem: Problem) -> Fault:
        """Give a problem its place: the line in the file, or the override that set the value."""
        key = ".".join(str(part) for part in problem.path)
        change = override_of(problem.path, self.changes, made=problem.path not in self.lines.lines)
        place = ("--set", change.number) if change else (self.file, self.lines.at(problem.path))
        return Fault(*place, key, problem.problem, problem.allowed, problem.suggestion)


def load_case(path: str | Path, overrides: Sequence[str] = ()) -> Case:
    """Read a case file, or the shipped case of that name, change it by `overrides` such as "solver.threads=1", check.

    The value of an override is TOML; text may come without quotes. Items of lists go by their place from
    0, as in "plies.0.element_mm=4". Raises CaseError with every fault found.
    """
    return load_source(path, overrides)[0]


def load_source(path: str | Path, overrides: Sequence[str] = ()) -> tuple[Case, Source]:
    """Do as `load_case` does, and return the source too, for what is found wrong with the case later."""
    file = str(file_or_shipped("cases", Path(path), str(path)))
    text = read_text(Path(file), file)
    raw, changes, faults = apply_overrides(parse_toml(text, file), overrides)
    source = Source(file, text, changes)
    return _build(raw, source, faults), source


def case_from_dict(
    d: Mapping[str, Any], file: str = "<memory>", lines: Lines | Mapping[Any, int] | None = None
) -> Case:
    """Check a case given as nested tables, as `tomllib` returns them. Raises CaseError with every fault.

    `file` names the source in messages and is where relative tool files start from; `lines` maps key
    paths such as ("plies", 0, "element_mm") to lines.
    """
    known = lines if isinstance(lines, Lines) else Lines(dict(lines or {}))
    return _build(_without_none(dict(d)), Source(file, given_lines=known), [])


def resolved_toml(case: Case) -> str:
    """Return the case as TOML with every default written out; it loads back to an equal case."""
    data = _without_none(case.model_dump(mode="python"))
    if case.tool is not None:
        used = case.tool.used_keys()
        data["tool"] = {key: value for key, value in data["tool"].items() if key in used}
    return tomli_w.dumps(data)


def _without_none(value: Any) -> Any:
    """Return tables and lists as TOML has them: no None, no tuples."""
    if isinstance(value, dict):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [_without_none(item) for item in value]
    return value


def read_text(path: Path, file: str) -> str:
    """Return the text of a file; raises CaseError where it cannot be a case."""
    try:
        if path.is_dir():
            raise _refusal(file, "is a directory", "a TOML file")
        if not path.exists():
            siblings = [item.name for item in path.parent.glob("*.toml")] if path.parent.is_dir() else []
            shipped = shipped_names("cases")
            near = path.stem if path.stem in shipped else closest(path.name, siblings) or closest(path.stem, shipped)
            raise _refusal(file, "no such file", f"a TOML file, or a shipped case: {', '.join(shipped)}", near)
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise _refusal(file, "the file is too large", f"<= {MAX_BYTES} bytes")
        text = data.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise CaseError([Fault(file, line, "", "the file is not UTF-8 text", "UTF-8")]) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _refusal(file, f"cannot be read: {reason}", "a readable TOML file") from None
    if not text.strip():
        raise _refusal(file, "the file is empty", "a case; 'ddf init' writes one to start from")
    return text


def _refusal(file: str, problem: str, allowed: str, suggestion: str = "") -> CaseError:
    return CaseError([Fault(file, 1, "", problem, allowed, suggestion)])


def parse_toml(text: str, file: str) -> dict[str, Any]:
    """Return the tables of a TOML text; raises CaseError with the line where it is not TOML."""
    try:
        return tomllib.loads(text)
    except ValueError as error:
        found = re.search(r"at line (\d+), column \d+", str(error))
        line = int(found.group(1)) if found else text.count("\n") + 1
        problem = f"not valid TOML: {str(error).splitlines()[0]}"
        raise CaseError([Fault(file, line, "", problem)]) from None
    except RecursionError:
        raise _refusal(file, "not valid TOML: tables or lists are nested too deep", "") from None


def _build(raw: dict[str, Any], source: Source, faults: list[Fault]) -> Case:
    """Validate the tables and return the case, or raise all faults in the order of their lines."""
    raw, problems = _with_tool_path(raw, Path(source.file).parent)
    case = None
    try:
        case = Case.model_validate(raw)
    except ValidationError as error:
        problems += problems_of(error, raw)
    problems += key_problems(raw)
    problems += cross_problems(raw, valid_parts(raw))
    faults = faults + [source.fault(problem) for problem in problems]
    if case is None or faults:
        raise CaseError(sorted(set(faults), key=lambda fault: (fault.file != source.file, fault.line, fault.key)))
    return case


def _with_tool_path(raw: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[Problem]]:
    """Make the tool's file absolute, from the case file's folder, and check that it is there."""
    tool = raw.get("tool")
    name = tool.get("file") if isinstance(tool, dict) else None
    if not isinstance(tool, dict) or not isinstance(name, str):
        return raw, []
    path = ("tool", "file")
    suffixes = ", ".join(TOOL_SUFFIXES)
    try:
        found = file_or_shipped("meshes", (folder / name).resolve(), name)
        exists = found.is_file()
    except (OSError, ValueError, RuntimeError):
        return raw, [Problem(path, f"{shown(name)} cannot be a file", suffixes)]
    resolved = raw | {"tool": tool | {"file": str(found)}}
    if tool.get("shape") != "file":
        return resolved, []  # That the key does not belong here is reported elsewhere.
    if not exists:
        siblings = [item.name for item in found.parent.glob("*")] if found.parent.is_dir() else []
        return resolved, [Problem(path, f"no such file: {found}", suffixes, closest(found.name, siblings))]
    if found.suffix.lower() not in TOOL_SUFFIXES:
        return resolved, [Problem(path, f"{found.suffix or found.name!r} is not a known format", suffixes)]
    return resolved, []
