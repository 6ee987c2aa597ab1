"""Read a finished run back, for notebooks, comparisons and reports."""

from __future__ import annotations

import json
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ddf.errors import UsageError
from ddf.output.tables import HISTORY, read_table
from ddf.output.vtu import read_pvd


class FinishedRun:
    """The results in a run's folder, read when asked for. Raises UsageError for what is not there."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)

    @cached_property
    def case_text(self) -> str:
        """The case file as it was given."""
        return self._text("case.toml")

    @cached_property
    def resolved_text(self) -> str:
        """The case with every default written out."""
        return self._text("case.resolved.toml")

    @cached_property
    def info(self) -> dict[str, Any]:
        """run.json: versions, host, wall times, stop reason, audit."""
        return self._json("run.json")

    @cached_property
    def metrics(self) -> dict[str, Any]:
        """metrics.json: {"plies": [table of each ply], ...}."""
        return self._json("metrics.json")

    def history(self) -> dict[str, NDArray[Any]]:
        """Columns of history.csv: floats, but `step` whole numbers and `stage` text."""
        rows = read_table(self._file(HISTORY))
        return _columns(rows, {"step": np.int64, "stage": np.str_})

    def profile(self, ply: str) -> dict[str, NDArray[Any]]:
        """Columns of profiles/<ply>.csv."""
        return _columns(read_table(self._file(f"profiles/{ply}.csv")), {"loop": np.int64, "point": np.int64})

    def wrinkles(self) -> list[dict[str, Any]]:
        """Rows of wrinkles.csv."""
        rows: list[dict[str, Any]] = []
        for row in read_table(self._file("wrinkles.csv")):
            values: dict[str, Any] = {key: float(v) for key, v in row.items() if key not in ("number", "ply")}
            rows.append({"number": int(row["number"]), "ply": row["ply"]} | values)
        return rows

    def frames(self, sheet: str) -> list[tuple[float, Path]]:
        """Time [s] and file of each frame of a sheet (or of "tool"). Raises UsageError naming what there is."""
        there = sorted(file.stem for file in self.path.glob("*.pvd"))
        if there and sheet not in there:
            raise UsageError(f"{self.path} has no frames of {sheet!r}", f"there are those of {', '.join(there)}")
        return [(time, self.path / file) for time, file in read_pvd(self._file(f"{sheet}.pvd"))]

    def read_frame(self, sheet: str, index: int = -1) -> dict[str, NDArray[Any]]:
        """One frame: points (k, 3) [mm], cells (q, 4 or 3), time_s, and every field by its name."""
        frames = self.frames(sheet)
        if not -len(frames) <= index < len(frames):
            raise UsageError(f"{self.path}: {sheet} has {len(frames)} frames, no frame {index}")
        return read_vtu(frames[index][1])

    def _file(self, name: str) -> Path:
        path = self.path / name
        if not path.is_file():
            raise UsageError(f"{path} does not exist", "has the run finished?")
        return path

    def _text(self, name: str) -> str:
        return self._file(name).read_text(encoding="utf-8")

    def _json(self, name: str) -> dict[str, Any]:
        try:
            return dict(json.loads(self._text(name)))
        except ValueError as error:
            raise UsageError(f"{self.path / name} is not JSON: {error}") from error


def open_run(path: str | Path) -> FinishedRun:
    """Open a run's folder. Raises UsageError if there is no run in it."""
    run = FinishedRun(path)
    if not run.path.is_dir():
        raise UsageError(f"{run.path} is not a folder")
    if not any((run.path / name).is_file() for name in ("run.json", "case.resolved.toml", HISTORY)):
        raise UsageError(f"{run.path} holds no run", "give the folder that `ddf run` wrote")
    return run


def read_vtu(path: Path) -> dict[str, NDArray[Any]]:
    """Arrays of a .vtu of one kind of cell: points (k, 3), cells (q, corners), time_s and the fields."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    if not path.is_file():
        raise UsageError(f"{path} does not exist")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if grid.GetNumberOfCells() == 0:
        raise UsageError(f"{path} holds no cells")
    corners = grid.GetCell(0).GetNumberOfPoints()
    result = {
        "points": vtk_to_numpy(grid.GetPoints().GetData()).copy(),
        "cells": vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, corners).copy(),
    }
    for data in (grid.GetPointData(), grid.GetCellData()):
        for k in range(data.GetNumberOfArrays()):
            result[data.GetArrayName(k)] = vtk_to_numpy(data.GetArray(k)).copy()
    time = grid.GetFieldData().GetArray("TimeValue")
    if time is not None:
        result["time_s"] = vtk_to_numpy(time)[0]
    return result


def _columns(rows: list[dict[str, str]], types: dict[str, type]) -> dict[str, NDArray[Any]]:
    if not rows:
        return {}
    return {key: np.array([row[key] for row in rows]).astype(types.get(key, np.float64)) for key in rows[0]}
