"""Checkpoints: the whole state, bit for bit, and what it belongs to."""

from __future__ import annotations

import hashlib
import json
import tomllib
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ddf.case import Case, resolved_toml
from ddf.errors import UsageError
from ddf.output.atomic import replacing
from ddf.output.folder import RunFolder
from ddf.scene import Scene

CHECKPOINT = "checkpoint.npz"
VERSION = 8
FREE_KEYS = ("title", "solver.threads")  # may differ between a run and its resumption


def save_checkpoint(folder: RunFolder, scene: Scene, state: Any, extra: dict[str, Any]) -> None:
    """Write checkpoint.npz as a whole: the state's arrays, the case and `extra` (JSON). Raises DdfError."""
    arrays = {f"state_{name}": array for name, array in state._asdict().items()}
    case = resolved_toml(scene.case)
    with replacing(folder / CHECKPOINT) as temporary, temporary.open("wb") as stream:
        np.savez(
            stream, version=VERSION, case=np.array(case), case_hash=np.array(case_hash(scene.case)),
            sheets=_shapes(scene), dt=scene.model.dt, first_dt=scene.first_step_s, step=state.clock[0],
            time_s=state.clock[1], extra=np.array(json.dumps(extra)), **arrays,
        )  # fmt: skip
        stream.flush()


def load_checkpoint(folder: RunFolder, scene: Scene) -> dict[str, Any]:
    """Fill the scene's state in place from checkpoint.npz and return the `extra` that was saved with it.

    `extra["step_s"]` is the step [s] that the run was at: less than the scene's where it was cut.
    Raises UsageError, and leaves the state as it was, if there is no checkpoint, if it cannot be read, or if it
    is of another case or mesh: the message says what differs.
    """
    saved = _read(folder / CHECKPOINT)
    path = folder / CHECKPOINT
    if int(saved["version"]) != VERSION:
        raise UsageError(f"{path} is of another version of ddf", "start again with --force")
    changes = case_differences(str(saved["case"]), resolved_toml(scene.case))
    if changes:
        raise UsageError(
            f"{path} belongs to another case:\n" + "\n".join(f"  {change}" for change in changes[:20]),
            "resume with the case as it was, or start again with --force",
        )
    if not np.array_equal(saved["sheets"], _shapes(scene)) or float(saved["first_dt"]) != scene.first_step_s:
        raise UsageError(
            f"{path} belongs to another mesh or step: nodes of the sheets {saved['sheets'].tolist()} "
            f"(now {_shapes(scene).tolist()}), step {float(saved['first_dt']):.6g} s (now {scene.first_step_s:.6g} s)",
            "the meshing may have changed with the version; start again with --force",
        )
    arrays = scene.state._asdict()
    for name, array in arrays.items():
        stored = saved.get(f"state_{name}")
        if stored is None or stored.shape != array.shape or stored.dtype != array.dtype:
            found = "missing" if stored is None else f"{stored.dtype} {stored.shape}"
            raise UsageError(
                f"{path}: {name} is {found}, expected {array.dtype} {array.shape}", "start again with --force"
            )
    for name, array in arrays.items():
        array[...] = saved[f"state_{name}"]
    return dict(json.loads(str(saved["extra"]))) | {"step_s": float(saved["dt"])}


def case_hash(case: Case) -> str:
    """SHA-256 of all that decides a run's result: the resolved case but for its title and threads."""
    return text_hash(resolved_toml(case))


def text_hash(resolved: str) -> str:
    """The same of a case's resolved text."""
    return hashlib.sha256(json.dumps(_flat(resolved), sort_keys=True).encode()).hexdigest()


def case_differences(old: str, new: str) -> list[str]:
    """Lines such as "plies.0.element_mm: 4.0 then, 2.0 now" for two resolved cases, free keys left out."""
    then, now = _flat(old), _flat(new)
    keys = [key for key in {**then, **now} if then.get(key) != now.get(key)]
    return [f"{key}: {then.get(key, 'not given')} then, {now.get(key, 'not given')} now" for key in keys]


def _flat(text: str) -> dict[str, Any]:
    """Values of a TOML text by dotted key, free keys left out."""
    flat: dict[str, Any] = {}

    def visit(value: Any, key: str) -> None:
        if isinstance(value, dict):
            for name, item in value.items():
                visit(item, f"{key}.{name}" if key else name)
        elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
            for number, item in enumerate(value):
                visit(item, f"{key}.{number}")
        elif key not in FREE_KEYS:
            flat[key] = value

    visit(tomllib.loads(text), "")
    return flat


def _shapes(scene: Scene) -> np.ndarray:
    """Rows and columns of each sheet, (sheets, 2)."""
    return np.stack([scene.model.sheets["rows"], scene.model.sheets["cols"]], axis=1).astype(np.int64)


def _read(path: Path) -> dict[str, np.ndarray]:
    if not path.exists():
        raise UsageError(f"nothing to resume: {path} does not exist", "start the run without --resume")
    try:
        with np.load(path, allow_pickle=False) as data:
            return {name: data[name] for name in data.files}
    except (OSError, ValueError, EOFError, BadZipFile, KeyError) as error:
        raise UsageError(f"{path} cannot be read: {error}", "start again with --force") from error
