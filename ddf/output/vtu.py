"""Frames for ParaView: a .vtu a sheet and time, listed with their times in one .pvd a sheet."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ddf.errors import DdfError
from ddf.mesh.tool import TriangleMesh
from ddf.output.atomic import replacing
from ddf.output.folder import RunFolder
from ddf.output.snapshot import SheetSnapshot, Snapshot
from ddf.scene import Scene

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

TOOL = "tool"
QUAD, TRIANGLE = 9, 5  # VTK's cell types


class FrameWriter:
    """Writes the frames of a run and keeps the lists of them; goes on from the lists that are there."""

    def __init__(self, folder: RunFolder, scene: Scene) -> None:
        self.folder = folder
        self.scene = scene
        names = [sheet.name for sheet in scene.sheets] + ([TOOL] if scene.tool_mesh is not None else [])
        self._frames = {name: read_pvd(folder / f"{name}.pvd") for name in names}

    @property
    def count(self) -> int:
        """Frames written so far."""
        return len(self._frames[self.scene.sheets[0].name])

    def write(self, snapshot: Snapshot) -> None:
        """Write one frame of all sheets and of the tool. Raises DdfError where it cannot be written."""
        number = self.count
        for sheet in snapshot.sheets:
            path = self._path(sheet.name, number)
            write_sheet(path, sheet, snapshot.time_s)
            self._list(sheet.name, snapshot.time_s, path)
        if TOOL in self._frames and self.scene.tool_mesh is not None:
            path = self._path(TOOL, number)
            write_tool(path, self.scene.tool_mesh, self.scene.tool_z(snapshot.time_s), snapshot.time_s)
            self._list(TOOL, snapshot.time_s, path)

    def prune(self, after_time: float) -> None:
        """Drop the frames later than `after_time` [s], from the lists first."""
        for name, frames in self._frames.items():
            kept = [(time, file) for time, file in frames if time <= after_time * (1 + 1e-12) + 1e-15]
            if len(kept) < len(frames):
                write_pvd(self.folder, name, kept)
            for _, file in frames[len(kept) :]:
                with suppress(OSError):
                    (self.folder / file).unlink(missing_ok=True)
            self._frames[name] = kept

    def _path(self, name: str, number: int) -> Path:
        return self.folder / f"frames/{name}-{number:04d}.vtu"

    def _list(self, name: str, time: float, path: Path) -> None:
        self._frames[name].append((time, f"frames/{path.name}"))
        write_pvd(self.folder, name, self._frames[name])


def write_sheet(path: Path, sheet: SheetSnapshot, time_s: float) -> None:
    """Write the existing cells of a sheet with all fields; `row` and `col` are a point's place on the grid."""
    n, m = sheet.x.shape[1:]
    i, j = np.nonzero(sheet.exists)
    corners = np.stack([i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1], axis=1)
    used, quads = np.unique(corners, return_inverse=True)
    points = np.ascontiguousarray(sheet.x.reshape(3, -1).T[used])
    point_fields: dict[str, NDArray[Any]] = {
        key: np.ascontiguousarray(v.ravel()[used], dtype=np.float32) for key, v in sheet.point_fields.items()
    }
    point_fields |= {"row": (used // m).astype(np.int32), "col": (used % m).astype(np.int32)}
    cell_fields = {key: np.ascontiguousarray(v[sheet.exists], dtype=np.float32) for key, v in sheet.cell_fields.items()}
    write_vtu(path, points, quads.reshape(-1, 4), point_fields, cell_fields, time_s)


def write_tool(path: Path, mesh: TriangleMesh, height_mm: float, time_s: float) -> None:
    """Write the tool's surface with its base at a height [mm]."""
    write_vtu(path, mesh.points + [0.0, 0.0, height_mm], mesh.triangles, {}, {}, time_s)


def write_vtu(
    path: Path,
    points: Array,
    cells: IntArray,
    point_fields: dict[str, NDArray[Any]],
    cell_fields: dict[str, NDArray[Any]],
    time_s: float,
) -> None:
    """Write triangles (q, 3) or quadrilaterals (q, 4) of points (k, 3) [mm], appended binary with zlib."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    grid = vtkUnstructuredGrid()
    nodes = vtkPoints()
    nodes.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=np.float64), deep=True))
    grid.SetPoints(nodes)
    corners = cells.shape[1]
    starts = np.arange(0, cells.size + 1, corners, dtype=np.int64)
    array = vtkCellArray()
    array.SetData(
        numpy_to_vtkIdTypeArray(starts, deep=True),
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells.ravel(), dtype=np.int64), deep=True),
    )
    grid.SetCells(QUAD if corners == 4 else TRIANGLE, array)
    for data, fields in ((grid.GetPointData(), point_fields), (grid.GetCellData(), cell_fields)):
        for name, values in fields.items():
            converted = numpy_to_vtk(values, deep=True)
            converted.SetName(name)
            data.AddArray(converted)
    time = vtkDoubleArray()
    time.SetName("TimeValue")
    time.InsertNextValue(time_s)
    grid.GetFieldData().AddArray(time)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()  # meshio reads no other; at level 1 as quick as LZ4 and smaller
    writer.SetCompressionLevel(1)
    with replacing(path) as temporary:
        writer.SetFileName(str(temporary))
        if writer.Write() != 1 or writer.GetErrorCode() != 0:
            raise DdfError(f"cannot write {path}", "is the disk full?")


def write_pvd(folder: RunFolder, name: str, frames: list[tuple[float, str]]) -> None:
    """Write <name>.pvd, the list of (time [s], file) that ParaView opens."""
    lines = [f'    <DataSet timestep="{time!r}" part="0" file={quoteattr(file)}/>' for time, file in frames]
    text = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">']
    text += ["  <Collection>", *lines, "  </Collection>", "</VTKFile>", ""]
    folder.write_text(f"{name}.pvd", "\n".join(text))


def read_pvd(path: Path) -> list[tuple[float, str]]:
    """The (time [s], file) of a .pvd; empty if it is not there. Raises DdfError if it is not a list."""
    if not path.exists():
        return []
    try:
        sets = ElementTree.parse(path).getroot().iter("DataSet")
        return [(float(item.attrib["timestep"]), item.attrib["file"]) for item in sets]
    except (OSError, ElementTree.ParseError, KeyError, ValueError) as error:
        raise DdfError(f"{path} cannot be read: {error}", "remove it to start a new list of frames") from error
