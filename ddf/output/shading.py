"""Light on a sheet seen from above: a lamp from the upper left, its shadows, and light from the sky."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ddf.output.raster import TopView

Array = NDArray[np.float64]

LIGHT = np.array([-0.46, 0.52, 0.72]) / np.linalg.norm([-0.46, 0.52, 0.72])
AMBIENT = 0.34
PENUMBRA_MM = 2.0  # how far a ray may pass below an edge until it is dark
SKY_RADIUS_MM = 7.0  # hollows of this size are darker

FLOOR_LEAST = 0.62  # the floor's least brightness: under a raised edge the sheet is what is looked at
CLOTH = (0.80, 0.79, 0.755)
RUBBER = (0.80, 0.70, 0.57)
FLOOR = (0.885, 0.895, 0.905)


def node_normals(x: Array, exists: NDArray[np.bool_]) -> Array:
    """Unit normals (3, n, m) at the nodes, upward: the area-weighted mean of the cells that exist around each."""
    first = x[:, 1:, 1:] - x[:, :-1, :-1]
    second = x[:, :-1, 1:] - x[:, 1:, :-1]
    normal = np.pad(np.where(exists, np.cross(first, second, axis=0), 0.0), ((0, 0), (1, 1), (1, 1)))
    total = normal[:, 1:, 1:] + normal[:, :-1, 1:] + normal[:, 1:, :-1] + normal[:, :-1, :-1]
    size = np.sqrt((total * total).sum(axis=0))
    up = np.array([0.0, 0.0, 1.0])[:, None, None]
    return np.where(size > 0, total / np.maximum(size, 1e-300), up)


def brightness(
    view: TopView, x: Array, exists: NDArray[np.bool_], gloss: float = 0.0, cast: bool = True
) -> tuple[Array, Array]:
    """Diffuse brightness and highlight of every pixel, (rows, columns) each.

    Lambert: ambient * sky + (1 - ambient) * shadow * n.l, 1 on a flat sheet; highlight: gloss (n.h)^40, h half-way
    between the lamp and the eye. `cast`: with shadows.
    """
    normal = view.nodes(node_normals(x, exists))
    normal[:, ~view.covered] = np.array([[0.0], [0.0], [1.0]])
    normal /= np.sqrt((normal * normal).sum(axis=0))
    shade = np.clip(np.tensordot(LIGHT, normal, axes=1), 0.0, None) / LIGHT[2]
    lit = shadows(view) if cast else np.ones_like(view.z)
    sky = sky_light(view)
    half = LIGHT + [0.0, 0.0, 1.0]
    highlight = np.clip(np.tensordot(half / np.linalg.norm(half), normal, axes=1), 0.0, 1.0) ** 40
    return AMBIENT * sky + (1 - AMBIENT) * lit * shade * (0.5 + 0.5 * sky), gloss * lit * highlight


def shadows(view: TopView) -> Array:
    """Share of the lamp's light that reaches each pixel, (rows, columns), 0..1, soft over PENUMBRA_MM."""
    slope = LIGHT[2] / float(np.hypot(LIGHT[0], LIGHT[1]))
    height, pixel = view.z[::2, ::2], 2.0 * view.pixel_mm  # half the resolution is enough for what is blurred
    reach = float(np.ptp(height)) / slope
    step = max(1.0, reach / pixel / 100)
    blocked = np.full(height.shape, -np.inf)
    direction = LIGHT[:2] / np.hypot(LIGHT[0], LIGHT[1])
    for k in range(1, int(reach / (step * pixel)) + 2):
        distance = k * step
        moved = _shifted(height, round(distance * direction[1]), round(distance * direction[0]))
        np.maximum(blocked, moved - height - distance * pixel * slope, out=blocked)
    dark = ndimage.gaussian_filter(np.clip(blocked / PENUMBRA_MM, 0.0, 1.0), 1.2 / pixel)
    return 1.0 - np.repeat(np.repeat(dark, 2, axis=0), 2, axis=1)[: view.z.shape[0], : view.z.shape[1]]


def sky_light(view: TopView) -> Array:
    """Share of the sky each pixel sees, roughly: darker where it lies below its surroundings."""
    total = np.zeros_like(view.z)
    for radius in (SKY_RADIUS_MM, 0.35 * SKY_RADIUS_MM):
        total += (_blurred(view.z, radius / view.pixel_mm) - view.z) / radius
    return np.clip(1.0 - 0.9 * total, 0.45, 1.15)


def _blurred(image: Array, sigma: float) -> Array:
    """The image blurred by a Gaussian of `sigma` pixels, at a resolution at which that is three to six pixels."""
    coarse = max(1, int(sigma / 3.0))
    small = ndimage.gaussian_filter(ndimage.uniform_filter(image, coarse)[::coarse, ::coarse], sigma / coarse)
    if coarse == 1:
        return np.asarray(small)
    return _stretched(_stretched(small, coarse, image.shape[0]).T, coarse, image.shape[1]).T


def _stretched(image: Array, factor: int, rows: int) -> Array:
    """The image with `rows` rows, of which every `factor`-th is one of its own, the others interpolated."""
    place = np.minimum(np.arange(rows) / factor, image.shape[0] - 1.0)
    low = np.minimum(place.astype(np.intp), max(image.shape[0] - 2, 0))
    part = (place - low)[:, None]
    between: Array = image[low] * (1.0 - part) + image[np.minimum(low + 1, image.shape[0] - 1)] * part
    return between


def photograph(
    view: TopView,
    x: Array,
    exists: NDArray[np.bool_],
    colour: tuple[float, float, float] = CLOTH,
    gloss: float = 0.06,
    ink: Array | None = None,
) -> Array:
    """RGB image (rows, columns, 3), 0..1. `ink` (rows, columns), 0..1, darkens the sheet: drawn lines."""
    light, highlight = brightness(view, x, exists, gloss)
    light = np.where(view.covered, light, np.maximum(light, FLOOR_LEAST))
    base = np.where(view.covered[..., None], colour, FLOOR)
    if ink is not None:
        base = base * (1.0 - ink[..., None])
    image = base * light[..., None] + np.where(view.covered, highlight, 0.0)[..., None]
    return np.clip(image, 0.0, 1.0) ** 0.92


def drawn_lines(
    view: TopView,
    exists: NDArray[np.bool_],
    spacing: tuple[float, float],
    every_mm: float = 10.0,
    width_mm: float = 0.7,
) -> Array:
    """Ink of lines drawn on the flat ply along both families every `every_mm` from its edge, (rows, columns), 0..1."""
    ink = np.zeros(view.z.shape)
    for axis, coordinate, size in ((0, view.u, spacing[0]), (1, view.v, spacing[1])):
        place = (coordinate - np.flatnonzero(exists.any(axis=1 - axis))[0]) * size
        away = np.abs(place - every_mm * np.round(place / every_mm))
        ink = np.maximum(ink, np.clip(1.5 - away / (0.5 * width_mm), 0.0, 1.0))
    return np.where(view.covered, 0.30 * ink, 0.0)


def _shifted(image: Array, rows: int, columns: int) -> Array:
    """The image's value `rows` up and `columns` right of each pixel; -inf beyond the edge."""
    moved = np.full_like(image, -np.inf)
    n, m = image.shape
    if abs(rows) < n and abs(columns) < m:
        target = (slice(max(-rows, 0), n - max(rows, 0)), slice(max(-columns, 0), m - max(columns, 0)))
        source = (slice(max(rows, 0), n + min(rows, 0)), slice(max(columns, 0), m + min(columns, 0)))
        moved[target] = image[source]
    return moved
