"""Closed triangle surfaces: orientation, the check that they are watertight, reading and writing."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ddf.errors import MeshError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class TriangleMesh:
    """A surface of triangles whose normals (right-hand rule) point outward."""

    points: FloatArray
    """Vertices (k, 3) [mm]."""
    triangles: IntArray
    """Vertex indices (q, 3)."""

    @property
    def top_mm(self) -> float:
        """Greatest height of the surface over the platform z = 0 [mm]."""
        return float(self.points[:, 2].max())

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume, sum a.(b x c)/6 [mm3]; negative if the normals point inward."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def compact(points: FloatArray, triangles: IntArray) -> TriangleMesh:
    """Merge vertices closer than 1e-7 of the surface's size, drop empty triangles and unused vertices."""
    if len(triangles) == 0:
        raise MeshError("the tool has no triangles")
    tolerance = 1e-7 * float(np.ptp(points, axis=0).max())
    keys = np.round((points - points.min(axis=0)) / tolerance).astype(np.int64)
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    triangles = place.reshape(-1)[triangles].astype(np.int64)
    distinct = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    used, place = np.unique(triangles[distinct], return_inverse=True)
    return TriangleMesh(points[first][used], place.reshape(-1, 3).astype(np.int64))


def directed_edges(triangles: IntArray) -> IntArray:
    """The edges (3q, 2) of triangles (q, 3) as their normals turn, edge k of triangle t at 3 t + k."""
    return np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)


def check_watertight(mesh: TriangleMesh, what: str) -> None:
    """MeshError if not every edge is shared by exactly two triangles that run along it oppositely."""
    edges = directed_edges(mesh.triangles)
    key = edges.min(axis=1) * len(mesh.points) + edges.max(axis=1)
    sense = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, place, count = np.unique(key, return_inverse=True, return_counts=True)
    total = np.bincount(place.reshape(-1), weights=sense, minlength=count.size)
    odd, turned = int((count != 2).sum()), int(((count == 2) & (total != 0)).sum())
    if odd:
        opened = int((count == 1).sum())
        raise MeshError(
            f"{what} is not watertight: {opened} open edges, {odd - opened} with over two triangles",
            "close the surface in the program that made it (it must be one closed solid)",
        )
    if turned:
        raise MeshError(
            f"{what} is not watertight: {turned} edges lie between triangles of opposite orientation",
            "make the normals of the surface consistent",
        )


def orient_outward(mesh: TriangleMesh, patch: IntArray | None = None) -> TriangleMesh:
    """The mesh with normals outward. `patch` (q,) numbers parts that are consistent within themselves.

    Neighbouring patches are turned to run along their common edges oppositely; then all triangles are turned
    if the enclosed volume is negative.
    """
    triangles = mesh.triangles
    if patch is not None:
        triangles = np.where(_patch_signs(mesh, patch)[patch][:, None] > 0, triangles, triangles[:, ::-1])
    turned = TriangleMesh(mesh.points, np.ascontiguousarray(triangles))
    if turned.volume_mm3 < 0.0:
        turned = TriangleMesh(mesh.points, np.ascontiguousarray(triangles[:, ::-1]))
    return turned


def _patch_signs(mesh: TriangleMesh, patch: IntArray) -> IntArray:
    """+1 or -1 for each patch such that neighbours agree, found from patch to patch across common edges."""
    edges = directed_edges(mesh.triangles)
    key = edges.min(axis=1) * len(mesh.points) + edges.max(axis=1)
    order = np.argsort(key, kind="stable")
    a, b = order[:-1], order[1:]
    pair = (key[a] == key[b]) & (patch[a // 3] != patch[b // 3])
    a, b = a[pair], b[pair]
    same = np.where((edges[a] == edges[b]).all(axis=1), -1, 1)
    links: dict[int, dict[int, int]] = {}
    for p, q, sign in zip(patch[a // 3].tolist(), patch[b // 3].tolist(), same.tolist(), strict=True):
        links.setdefault(p, {})[q] = sign
        links.setdefault(q, {})[p] = sign
    signs = np.zeros(int(patch.max()) + 1, dtype=np.int64)
    for start in np.unique(patch).tolist():
        if signs[start]:
            continue
        signs[start], queue = 1, deque([start])
        while queue:
            p = queue.popleft()
            for q, sign in links.get(p, {}).items():
                if not signs[q]:
                    signs[q] = sign * signs[p]
                    queue.append(q)
    return signs


def write_tool(mesh: TriangleMesh, path: str | Path) -> None:
    """Write the surface as .stl (binary) or .vtu, by the name's ending."""
    import meshio

    path = Path(path)
    _known_format(path)
    data = meshio.Mesh(mesh.points, [("triangle", mesh.triangles)])
    data.write(path, **({"binary": True} if path.suffix.lower() == ".stl" else {}))


def read_tool(path: str | Path) -> TriangleMesh:
    """Read a surface from .stl or .vtu; vertices merged, normals outward. MeshError if not watertight."""
    import meshio

    path = Path(path)
    _known_format(path)
    if not path.is_file():
        raise MeshError(f"there is no tool file {path}")
    try:
        data = meshio.read(path)
    except (meshio.ReadError, ValueError, OSError, SystemExit) as error:
        raise MeshError(f"{path} cannot be read: {error}") from error
    triangles = [block.data for block in data.cells if block.type == "triangle"]
    if not triangles:
        raise MeshError(f"{path} holds no triangles")
    mesh = compact(data.points.astype(np.float64), np.concatenate(triangles).astype(np.int64))
    check_watertight(mesh, str(path))
    return orient_outward(mesh)


def _known_format(path: Path) -> None:
    if path.suffix.lower() not in {".stl", ".vtu"}:
        raise MeshError(f"{path.name}: a tool surface is a .stl or .vtu file")
