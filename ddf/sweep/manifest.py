"""The manifest of a sweep's folder: what its cases are, written before any runs; and how each case stands.

Layout: manifest.json, cases/NAME.toml (all defaults written out), runs/NAME (as `ddf run` leaves it), logs/NAME.txt,
outcomes.json, table.csv, pictures/*.png.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ddf.case import resolved_toml
from ddf.errors import UsageError
from ddf.output.checkpoint import CHECKPOINT, case_hash, text_hash
from ddf.output.folder import RunFolder
from ddf.provenance import provenance
from ddf.sweep.plan import Plan

MANIFEST = "manifest.json"
FINISHED, FAILED, INTERRUPTED, MISSING = "finished", "failed", "interrupted", "missing"


@dataclass(frozen=True)
class Entry:
    """One case of the manifest."""

    name: str
    changes: dict[str, Any]
    hash: str  # of the resolved case, title and threads left out


@dataclass(frozen=True)
class Outcome:
    """How a case stands: its state, for what reason, and the wall time of its last run."""

    name: str
    state: str
    reason: str = ""
    wall_s: float = 0.0


class SweepFolder:
    """A sweep's folder."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.out = RunFolder(path)

    def case_file(self, name: str) -> Path:
        """The resolved case."""
        return self.path / "cases" / f"{name}.toml"

    def run_folder(self, name: str) -> Path:
        """Where the case runs."""
        return self.path / "runs" / name

    def log_file(self, name: str) -> Path:
        """What the case's process said."""
        return self.path / "logs" / f"{name}.txt"

    def prepare(self, plan: Plan, resume: bool, force: bool, extend: bool = False) -> list[Entry]:
        """Write the manifest and the cases, or with `resume` check that they are this sweep's.

        `extend`: the folder may hold other cases besides; a run that is there is used if its case is the same.
        Raises UsageError for a folder in use, or one of another sweep.
        """
        cases = {point.name: plan.load(point) for point in plan.points}
        entries = [Entry(p.name, p.changes, case_hash(cases[p.name])) for p in plan.points]
        others: list[Entry] = []
        if self.path.is_dir() and any(self.path.iterdir()) and not (resume or force or extend):
            raise UsageError(f"{self.path} is not empty", "--resume goes on with the sweep in it, --force replaces it")
        if force:
            self._clear()
        elif extend:
            self._same_runs(entries)
            if (self.path / MANIFEST).exists():
                others = [entry for entry in self.entries() if entry.name not in cases]
        elif resume and (self.path / MANIFEST).exists():
            self._same(entries)
        for point in plan.points:
            self.out.write_text(f"cases/{point.name}.toml", resolved_toml(cases[point.name]))
        self.out.write_json(MANIFEST, provenance() | {
            "title": plan.title, "case": str(plan.case), "common": list(plan.common),
            "cases": [asdict(entry) for entry in entries + others],
        })  # fmt: skip
        return entries

    def _same(self, entries: list[Entry]) -> None:
        known = {entry.name: entry.hash for entry in self.entries()}
        now = {entry.name: entry.hash for entry in entries}
        other = sorted(name for name in known.keys() | now.keys() if known.get(name) != now.get(name))
        if other:
            raise UsageError(
                f"{self.path} holds another sweep; cases that differ: {', '.join(other[:10])}",
                "resume with the sweep as it was, replace it with --force, or choose another folder with -o",
            )

    def _same_runs(self, entries: list[Entry]) -> None:
        """Raise UsageError where a run of another case has a case's name."""
        other = []
        for entry in entries:
            file = self.run_folder(entry.name) / "case.resolved.toml"
            if file.is_file() and text_hash(file.read_text(encoding="utf-8")) != entry.hash:
                other.append(entry.name)
        if other:
            raise UsageError(
                f"{self.path} holds runs of other cases: {', '.join(other[:10])}",
                "replace them with --force, or choose another folder with -o",
            )

    def _clear(self) -> None:
        """Remove what the cases of the manifest left."""
        if not (self.path / MANIFEST).exists():
            return
        for entry in self.entries():
            RunFolder(self.run_folder(entry.name)).empty()
            with suppress(OSError):  # files of other programs stay, and their folder with them
                self.run_folder(entry.name).rmdir()
            for file in (self.case_file(entry.name), self.log_file(entry.name)):
                file.unlink(missing_ok=True)

    def entries(self) -> list[Entry]:
        """The manifest's cases. Raises UsageError where it cannot be read."""
        return [Entry(**case) for case in self.manifest()["cases"]]

    def manifest(self) -> dict[str, Any]:
        """The manifest. Raises UsageError where it cannot be read."""
        try:
            return dict(json.loads((self.path / MANIFEST).read_text(encoding="utf-8")))
        except (OSError, ValueError) as error:
            raise UsageError(f"{self.path / MANIFEST} cannot be read: {error}") from error

    def standing(self, entry: Entry) -> Outcome:
        """How a case stands, from its run's own folder: a run that was killed has a checkpoint and no end."""
        folder = self.run_folder(entry.name)
        try:
            info = json.loads((folder / "run.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            state = INTERRUPTED if (folder / CHECKPOINT).exists() else MISSING
            return Outcome(entry.name, state)
        reason = info.get("stop_reason")
        wall = float(sum(info.get("wall_s", {}).values()))
        complete = (folder / "metrics.json").exists() and reason == "finished"
        if complete:
            return Outcome(entry.name, FINISHED, "", wall)
        state = INTERRUPTED if reason == "interrupted" else FAILED
        return Outcome(entry.name, state, info.get("message", ""), wall)

    def write_outcomes(self, outcomes: dict[str, Outcome]) -> None:
        """Write outcomes.json."""
        self.out.write_json("outcomes.json", [asdict(outcome) for outcome in outcomes.values()])
