"""Which scenes are their own mirror image, and the half of one: `solver.symmetry`.

A scene is its own image in the plane x = 0 or y = 0 if its tool is, and all its sheets with their cells, bars and fibre
families: at 0/90 families are their own images, at +-45 each is that of the other. Loads and frame always are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ddf.build.blocks import block_edges, row_blocks
from ddf.build.rest import state_at_rest
from ddf.build.rim import rim_lists, rim_nodes
from ddf.contact.patch import patch_centres
from ddf.contact.rim import sheet_rim
from ddf.contact.self_contact import CELLS
from ddf.elements.cells import WEIGHTLESS
from ddf.half import Half
from ddf.mesh.distance import DistanceField
from ddf.model import DIAPHRAGM, PLY, SHELL_PLY, Model, sheet_scalars, sheet_vectors
from ddf.scene import Scene

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

STRIP = 2.2
"""Width of the strip of ghosts, in cells: what a cell, a bending triple or a contact patch at the plane reaches."""

TOOL_TOLERANCE_MM = 0.1
"""Largest difference between the distances from the tool of a point and of its image: its facets make some."""

SAME_MM = 1e-6
"""Nodes nearer than this are one."""

GHOST_CELL = 0.1 * WEIGHTLESS
"""Area of a cell beyond the plane [mm2], for contact to find fabric there that weighs nothing."""


def halve(scene: Scene) -> Scene:
    """The half of a scene that is its own image; else the scene itself, with the reason in `symmetry`."""
    reasons = []
    for axis in (0, 1):
        why = _obstacle(scene, axis)
        if not why:
            return _half(scene, axis)
        reasons.append(f"in {'xy'[axis]} = 0: {why}")
    return replace(scene, symmetry="not its own image " + "; ".join(reasons))


def _obstacle(scene: Scene, axis: int) -> str:
    """Why a scene is not its own image in the plane normal to an axis, or cannot be computed by half; or nothing."""
    model = scene.model
    if model.summits.shape[0]:
        return "the tool has sharp vertices, which half models do not know"
    if scene.tool_field is not None and _tool_off(scene.tool_field, axis) > TOOL_TOLERANCE_MM:
        return f"the tool's image is off by {_tool_off(scene.tool_field, axis):.2g} mm"
    inside_out = sorted(enumerate(scene.sheets), key=lambda sheet: sheet[1].kind, reverse=True)  # plies first
    for k, info in inside_out:
        if model.sheets[k]["kind"] == SHELL_PLY:
            return f"{info.name} is of shell-membrane cells, which half models do not know"
        if not _own_image(model, sheet_vectors(model, scene.state.x, k)[:2], k, axis):
            return f"{info.name} is not its own image"
    return ""


def _tool_off(field: DistanceField, axis: int) -> float:
    """Largest difference of the distances of points near the tool and of their images [mm]."""
    d = field.values[..., 0]
    near = np.argwhere((np.abs(d) < 3.0 * field.spacing) & (np.arange(d.shape[2]) * field.spacing > -field.origin[2]))
    points = field.origin + field.spacing * near
    image = points * np.where(np.arange(3) == axis, -1.0, 1.0)
    return float(np.abs(field.distance(image) - d[tuple(near.T)]).max(initial=0.0))


def _own_image(model: Model, x: FloatArray, k: int, axis: int) -> bool:
    """Whether cells, bars and families of a flat sheet x (2, rows, cols) are their own images."""
    cell, bar1, bar2 = (sheet_scalars(model, pool, k) for pool in (model.cell, model.bar1, model.bar2))
    middle = 0.25 * (x[:, 1:, 1:] + x[:, :-1, 1:] + x[:, 1:, :-1] + x[:, :-1, :-1])
    if not _same(middle, cell[:-1, :-1], middle, cell[:-1, :-1], axis):
        return False
    if model.sheets[k]["kind"] == DIAPHRAGM:
        return True
    sides = ((0.5 * (x[:, 1:] + x[:, :-1]), bar1[:-1]), (0.5 * (x[:, :, 1:] + x[:, :, :-1]), bar2[:, :-1]))
    if all(_same(*side, *side, axis) for side in sides):
        return True
    s = model.sheets[k]
    alike = all(np.isclose(s[f"{name}1"], s[f"{name}2"], rtol=1e-9) for name in ("a", "eh", "bend"))
    return alike and _same(*sides[0], *sides[1], axis) and _same(*sides[1], *sides[0], axis)


def _same(x: FloatArray, values: FloatArray, other: FloatArray, others: FloatArray, axis: int) -> bool:
    """Whether images of points x (2, ...) with values above 0 are points of the other kind, with the same values."""
    points, wanted = x[:, values > 0.0].T, values[values > 0.0]
    there, found = other[:, others > 0.0].T, others[others > 0.0]
    if len(points) != len(there):
        return False
    away, nearest = cKDTree(there).query(points * np.where(np.arange(2) == axis, -1.0, 1.0))
    return bool(away.max(initial=0.0) < SAME_MM and np.allclose(found[nearest], wanted, rtol=1e-6))


def _half(scene: Scene, axis: int) -> Scene:
    """The half of a scene on the positive side of the plane normal to an axis."""
    whole = scene.model
    grids = [_Grid(whole, scene.state.x, k, axis) for k in range(whole.sheets.size)]
    sheets = whole.sheets.copy()
    sheets["rows"], sheets["cols"] = [g.shape[0] for g in grids], [g.shape[1] for g in grids]
    sheets["node"] = np.cumsum([0, *(g.size for g in grids[:-1])])
    blocks = row_blocks(sheets)
    pairs, exposed, places = _pairs(scene, grids, sheets, blocks)
    pools: dict[str, Any] = {name: np.concatenate([g.pool(name) for g in grids]) for name in _Grid.WEIGHED}
    skin = grids[0]
    sizes: dict[str, Any] = {}
    for name, beyond in (("lines", 1.0), ("tool_lines", 0.0)):
        parts = []
        for lines, low, count, side in skin.lines(whole):
            parts.append(np.where(side > 0.0, 1.0, beyond) * lines[low : low + count - 1])
        sizes[name] = np.concatenate(parts)
    model = whole._replace(
        sheets=sheets, blocks=blocks, pairs=pairs, **pools, **sizes, exposed=exposed,
        cover=np.concatenate([g.cut(whole.cover) for g in grids]),
        inverse_area=np.concatenate([g.cut(whole.inverse_area) for g in grids]),
        weight=np.concatenate([g.cut_fours(whole.weight) for g in grids]),
        centre=np.concatenate([patch_centres(g.kept | rim_nodes(g.rim, g.shape)).ravel() for g in grids]),
        **rim_lists([g.rim for g in grids], sheets, blocks),
        line_mass=np.concatenate([g.line_mass() for g in grids]),
        away=np.concatenate([g.away(whole).ravel() for g in grids]), mirror=axis,
        **_mirror_lists(grids, sheets, blocks),
    )  # fmt: skip
    x = np.concatenate([g.x.ravel() for g in grids])
    half = Half(
        axis=axis, whole=whole, start=scene.state,
        source=tuple(g.source for g in grids), flipped=tuple(g.flipped for g in grids),
        corner=tuple((g.rows.start, g.cols.start) for g in grids),
        turn=tuple(g.turn for g in grids),
    )  # fmt: skip
    return replace(scene, model=model, state=state_at_rest(model, x, places), half=half)


class _Grid:
    """One sheet's part in the half: rows and columns of the whole's grid that hold what is kept of it."""

    WEIGHED = ("mass", "inverse_mass", "area", "bar1", "bar2", "cell", "triple1", "triple2")

    def __init__(self, whole: Model, x: FloatArray, k: int, axis: int) -> None:
        self.whole, self.k = whole, k
        sheet, flat = whole.sheets[k], sheet_vectors(whole, x, k)
        exists = sheet_scalars(whole, whole.area, k) > 0.0
        across = flat[axis]
        cells = [float(sheet["a1"]), float(sheet["a2"])]
        if sheet["kind"] == DIAPHRAGM:
            cells = [float(np.diff(np.unique(across[across >= -SAME_MM]))[0])]
        self.swapped = (
            sheet["kind"] == PLY
            and min(abs(flat[axis, 1, 0] - flat[axis, 0, 0]), abs(flat[axis, 0, 1] - flat[axis, 0, 0])) > SAME_MM
        )  # families are each other's images
        self.cell = max(cells)  # at the plane
        kept = exists & ((across >= -STRIP * self.cell) | self.swapped)
        rim = self._rim(kept)
        there = kept | rim_nodes(rim, kept.shape)
        self.rows, self.cols = (_extent(there.any(axis=1 - a)) for a in (0, 1))
        self.shape = (self.rows.stop - self.rows.start, self.cols.stop - self.cols.start)
        self.rim = self._moved(rim, kept.shape[1])
        self.size = self.shape[0] * self.shape[1]
        self.kept = kept[self.rows, self.cols]
        self.x = np.ascontiguousarray(flat[:, self.rows, self.cols])
        self.side = np.where(np.abs(self.x[axis]) < SAME_MM, 0.0, np.sign(self.x[axis]))
        self.x[axis][self.side == 0.0] = 0.0
        self.across, self.axis = self.x[axis], axis
        self.source, self.flipped = self._sources(flat[:2], exists)
        self.turn = self._turn(flat[:2])
        real = np.flatnonzero((self.side > 0.0) & self.kept)
        ghosts = np.flatnonzero((self.side < 0.0) & self.kept)
        self.plane = np.flatnonzero((self.side == 0.0) & self.kept)
        points = self.x[:2].reshape(2, -1).T
        images = points[ghosts] * np.where(np.arange(2) == axis, -1.0, 1.0)
        self.ghosts = np.stack([ghosts, real[cKDTree(points[real]).query(images)[1]]], axis=1)

    def _rim(self, kept: BoolArray) -> np.ndarray:
        """RIM records of the whole's sheet, numbers in it, all of whose parents are kept."""
        rim = sheet_rim(self.whole, self.k)
        lost = np.unique(rim["node"][~kept.ravel()[rim["parent"]]])
        return rim[~np.isin(rim["node"], lost)]

    def _moved(self, rim: np.ndarray, cols: int) -> np.ndarray:
        """RIM records with numbers in the half's sheet, from those in the whole's."""
        moved = rim.copy()
        for name in ("node", "parent"):
            i, j = np.divmod(rim[name], cols)
            moved[name] = (i - self.rows.start) * self.shape[1] + j - self.cols.start
        return moved

    def cut(self, pool: NDArray) -> NDArray:
        """What the half has of a pool of one number a node, flat."""
        return np.ascontiguousarray(sheet_scalars(self.whole, pool, self.k)[self.rows, self.cols]).ravel()

    def cut_fours(self, pool: FloatArray) -> FloatArray:
        """What the half has of a pool of four numbers a node, flat."""
        s = self.whole.sheets[self.k]
        first, count = int(s["node"]), int(s["rows"] * s["cols"])
        values = pool[4 * first : 4 * (first + count)].reshape(4, int(s["rows"]), int(s["cols"]))
        return np.ascontiguousarray(values[:, self.rows, self.cols]).ravel()

    def pool(self, name: str) -> FloatArray:
        """A pool of the half: weighed 1 on this side of the plane, 1/2 on it or across, 0 beyond."""
        share = 0.5 * (1.0 + self._sides(name))
        if name == "inverse_mass":
            share = np.where(share > 0.0, 1.0 / np.where(share > 0.0, share, 1.0), 0.0)
        if self.swapped and name in ("bar1", "bar2"):
            share = np.ones_like(share)
        values = self.cut(getattr(self.whole, name))
        if name == "cell":
            ghost = np.where(values > 0.0, GHOST_CELL, 0.0) * self._whole_cells().ravel()
            return np.where(share.ravel() > 0.0, values * share.ravel(), ghost)
        return values * (share * self.kept).ravel()

    def line_mass(self) -> FloatArray:
        """Inverse masses, those of nodes on the plane with a minus sign where lines end there."""
        if self.swapped:
            return self.cut(self.whole.inverse_mass)
        return np.where(self.side == 0.0, -1.0, 1.0).ravel() * self.pool("inverse_mass")

    def lines(self, whole: Model) -> list[tuple[FloatArray, int, int, FloatArray]]:
        """For rows, then columns of a diaphragm: cell sizes, the half's first and how many lines, sides of cells."""
        s = whole.sheets[self.k]
        a, n, m = int(s["line"]), int(s["rows"]), int(s["cols"])
        every = (whole.lines[a : a + n - 1], whole.lines[a + n - 1 : a + n + m - 2])
        row, col = (0.5 * (y[1:] + y[:-1]) for y in (self.across[:, 0], self.across[0]))
        rows, cols = (row, np.ones(col.size)) if self.axis == 0 else (np.ones(row.size), col)
        return [(every[0], self.rows.start, self.shape[0], rows), (every[1], self.cols.start, self.shape[1], cols)]

    def twins(self, node: int) -> NDArray[np.int64]:
        """`Model.twins` of a ply whose families are each other's images; node: its first in the pools."""
        if not self.swapped:
            return np.zeros((0, 2), np.int64)
        image = np.arange(self.size)
        image[self.ghosts[:, 0]] = self.ghosts[:, 1]
        image, places = image.reshape(self.shape), np.arange(self.size).reshape(self.shape)
        twins = []
        for family, bars in ((1, self.cut(self.whole.bar1)), (2, self.cut(self.whole.bar2))):
            there = np.argwhere((bars.reshape(self.shape) > 0.0) & (self._sides(f"bar{family}") < 0.0))
            i, j = there.T
            other = image[i + 1, j] if family == 1 else image[i, j + 1]
            first = np.minimum(image[i, j], other)  # the image is a bar of the other family, kept at its first node
            twins.append(np.stack([2 * (places[i, j] + node) + family - 1, 2 * (first + node) + 2 - family], axis=1))
        return np.concatenate(twins)

    def away(self, whole: Model) -> BoolArray:
        """Nodes that lie far enough from the plane along the sheet to meet their image, see `contact.self_contact`."""
        own = (whole.pairs["slave"] == self.k) & (whole.pairs["master"] == self.k)
        if not own.any():
            return np.zeros(self.shape, bool)
        least = max(np.pi * float(whole.sheets[self.k]["fold_radius"]), CELLS * self.cell)
        return self.kept & (2.0 * self.across > least)

    def _sides(self, name: str) -> FloatArray:
        """-1, 0 or 1 for each node, or for the bar or the cell that is kept at it (the last ones have none)."""
        s = np.pad(self.across, ((0, 1), (0, 1)), mode="edge")
        place = {
            "bar1": 0.5 * (s[1:, :-1] + s[:-1, :-1]),
            "bar2": 0.5 * (s[:-1, 1:] + s[:-1, :-1]),
            "cell": 0.25 * (s[1:, 1:] + s[:-1, 1:] + s[1:, :-1] + s[:-1, :-1]),
        }.get(name, self.across)
        return np.where(np.abs(place) < SAME_MM, 0.0, np.sign(place))

    def _whole_cells(self) -> FloatArray:
        """1 for cells all of whose corners are kept."""
        p = np.pad(self.kept, ((0, 1), (0, 1)))
        return (p[1:, 1:] & p[:-1, 1:] & p[1:, :-1] & p[:-1, :-1]).astype(np.float64)

    def _sources(self, flat: FloatArray, exists: BoolArray) -> tuple[NDArray[np.int64], BoolArray]:
        """`Half.source` and `Half.flipped`."""
        inside = np.flatnonzero(self.kept & (self.side >= 0.0))
        points = flat.reshape(2, -1).T.copy()
        flipped = points[:, self.axis] < -SAME_MM
        points[flipped, self.axis] *= -1.0
        nearest = cKDTree(self.x[:2].reshape(2, -1).T[inside]).query(points)[1]
        source = np.where(exists.ravel(), inside[nearest], -1).astype(np.int64)
        return source.reshape(exists.shape), (flipped & exists.ravel()).reshape(exists.shape)

    def _turn(self, flat: FloatArray) -> FloatArray:
        """`Half.turn`: of a diaphragm's graded grid by its numbers, of a lattice from its steps."""
        n, m = flat.shape[1:]
        if self.whole.sheets[self.k]["kind"] == DIAPHRAGM:
            signs = (-1.0, 1.0) if self.axis == 0 else (1.0, -1.0)
            ends = (n - 1.0, 0.0) if self.axis == 0 else (0.0, m - 1.0)
            return np.array([[signs[0], 0.0, ends[0]], [0.0, signs[1], ends[1]]])
        origin = flat[:, 0, 0]
        steps = np.stack([flat[:, 1, 0] - origin, flat[:, 0, 1] - origin], axis=1)
        image = np.diag(np.where(np.arange(2) == self.axis, -1.0, 1.0))
        back = np.linalg.inv(steps)
        return np.column_stack([back @ image @ steps, back @ (image @ origin - origin)])


def _extent(kept: BoolArray) -> slice:
    """From the first to the last that is kept."""
    there = np.flatnonzero(kept)
    return slice(int(there[0]), int(there[-1]) + 1)


def _pairs(scene: Scene, grids: list[_Grid], sheets: np.ndarray, blocks: np.ndarray):
    """PAIR records, followed nodes and first places of the half: the whole's, cut; ghosts are no slaves."""
    whole = scene.model
    pairs, exposed, places = whole.pairs.copy(), [], []
    first = buffer = span = 0
    for pair in pairs:
        slave, master = grids[int(pair["slave"])], grids[int(pair["master"])]
        old, count = int(pair["first"]), int(np.prod([whole.sheets[pair["slave"]][key] for key in ("rows", "cols")]))
        shape = tuple(int(whole.sheets[pair["slave"]][key]) for key in ("rows", "cols"))
        follow = whole.exposed[old : old + count].reshape(shape)[slave.rows, slave.cols] & (slave.side >= 0.0)
        place = scene.state.place[5 * old : 5 * (old + count)].reshape(5, *shape)[:, slave.rows, slave.cols].copy()
        place[0] -= master.rows.start
        place[1] -= master.cols.start
        exposed.append((follow & slave.kept).ravel())
        places.append(place.ravel())
        several = int((blocks["sheet"] == pair["slave"]).sum())
        pair["first"], pair["buffer"], pair["span"] = first, buffer, span
        first += slave.size
        buffer += 4 * master.size * several
        span += master.shape[0] * several
    none = [np.zeros(0, bool)], [np.zeros(0)]
    return pairs, np.concatenate(exposed or none[0]), np.concatenate(places or none[1])


def _mirror_lists(grids: list[_Grid], sheets: np.ndarray, blocks: np.ndarray) -> dict[str, Any]:
    """Ghosts, images, nodes on the plane and bars beyond it, by blocks."""
    ghosts = np.concatenate([g.ghosts + int(s["node"]) for g, s in zip(grids, sheets, strict=True)])
    plane = np.concatenate([g.plane + int(s["node"]) for g, s in zip(grids, sheets, strict=True)])
    edges = block_edges(sheets, blocks)
    twins = np.concatenate([g.twins(int(s["node"])) for g, s in zip(grids, sheets, strict=True)])
    twins = twins[np.argsort(twins[:, 0])]
    ghosts = ghosts[np.argsort(ghosts[:, 0])]
    images = np.argsort(ghosts[:, 1], kind="stable")
    plane = np.sort(plane)
    return {
        "ghosts": ghosts, "ghost_first": np.searchsorted(ghosts[:, 0], edges),
        "images": images, "image_first": np.searchsorted(ghosts[images, 1], edges),
        "plane": plane, "plane_first": np.searchsorted(plane, edges),
        "twins": twins, "twin_first": np.searchsorted(twins[:, 0] // 2, edges),
    }  # fmt: skip
