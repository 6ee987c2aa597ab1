"""A disc on a rectangular grid: nodes beyond its edge are driven so that the edge stays where it is clamped.

Holding the nodes outside a circle clamps a staircase: first order in the element size. Instead the nodes that the
edge's cells need beyond it are driven each few steps to the displacement that continues the sheet's own past the edge.
For a node at s beyond the edge, with u1 and u2 the displacements at depths d and 2d below the edge on the same radius
(bilinear in their cells):

    hinged (u = 0 on the edge):              u = -s (s + 2d)/d^2 u1 + s (s + d)/(2 d^2) u2         the parabola
    clamped (w = dw/dn = 0 on the edge):     w = (2 q^2 + q^3) w1 - (q^2 + q^3) w2/4,  q = s/d     the cubic

Inner nodes closer to the edge than CLOSE of a cell are continued too (s < 0).
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from ddf.errors import MeshError
from ddf.verify.bench_sheets import BoolArray, FloatArray

CLOSE = 0.25  # of a cell


def disc_lines(radius: float, element: float, margin: int) -> FloatArray:
    """Grid line places [mm], symmetric, with cells of `element` and `margin` of them beyond the radius."""
    half = int(np.ceil(radius / element)) + margin
    return np.linspace(-half * element, half * element, 2 * half + 1)


class Edge:
    """Continues a sheet beyond the circle r = radius; `beyond` (n, n) are the nodes that it drives."""

    def __init__(self, lines: FloatArray, radius: float, clamped: bool) -> None:
        element = float(lines[1] - lines[0])
        if 6.0 * element > radius:
            raise MeshError(
                f"cells of {element:g} mm are too large for a disc of {radius:g} mm radius", "take a sixth of it"
            )
        x, y = np.meshgrid(lines, lines, indexing="ij")
        r = np.hypot(x, y)
        self.beyond: BoolArray = r > radius - CLOSE * element
        reach = (2.01 if clamped else 1.01) * np.sqrt(2.0) * element
        near = self.beyond & (r < radius + reach)
        self.near = np.flatnonzero(near)
        s = (r - radius).ravel()[self.near]
        depth = 2.5 * element
        if clamped:
            q = s / depth
            first, second = 2.0 * q**2 + q**3, -0.25 * (q**2 + q**3)
        else:
            first, second = -s * (s + 2.0 * depth) / depth**2, s * (s + depth) / (2.0 * depth**2)
        cosine, sine = (a.ravel()[self.near] / r.ravel()[self.near] for a in (x, y))
        self._weights = csr_matrix((self.near.size, r.size))
        for share, level in ((first, depth), (second, 2.0 * depth)):
            at = radius - level
            self._weights = self._weights + _bilinear(lines, at * cosine, at * sine).multiply(share[:, None])
        self._weights = csr_matrix(self._weights)

    def drive(self, x: FloatArray, v: FloatArray, start: FloatArray, seconds: float) -> None:
        """Set the velocities (3, n, n) of the nodes beyond so that they arrive after `seconds` of time."""
        for c in range(3):
            u = (x[c] - start[c]).ravel()
            aim = self._weights @ u
            v[c].reshape(-1)[self.near] = (aim - u[self.near]) / seconds


def _bilinear(lines: FloatArray, x: FloatArray, y: FloatArray) -> csr_matrix:
    """Rows of bilinear weights at points (k,) of the grid."""
    size = lines.size
    u, v = ((p - lines[0]) / (lines[1] - lines[0]) for p in (x, y))
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j
    rows = np.tile(np.arange(x.size), 4)
    columns = np.concatenate([i * size + j, (i + 1) * size + j, i * size + j + 1, (i + 1) * size + j + 1])
    weights = np.concatenate([(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b])
    return csr_matrix((weights, (rows, columns)), (x.size, size * size))
