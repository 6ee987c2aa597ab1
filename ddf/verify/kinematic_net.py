"""The kinematic net on a hemisphere: shear against that of a pin-jointed cloth on a sphere.

With two great circles at right angles as generators and arc coordinates u, v along the yarns in units of the
radius, the net's angle w between the families obeys the sine-Gordon equation of a Chebyshev net of curvature 1,
d2w/du dv = -sin w. In w = 90 deg - g, g(z), z = u v, it is

    z g'' + g' = cos g,   g(0) = 0,   g = z - z^3/18 + ...

(Chebyshev, "Sur la coupe des vetements", 1878; Mack and Taylor, J. Textile Inst. 47 (1956) T477.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from ddf.kinematic.drape import Drape, drape_ply
from ddf.mesh.analytic import hemisphere_distance
from ddf.mesh.distance import DistanceField, distance_field
from ddf.mesh.ply import mesh_ply
from ddf.mesh.tool import build_tool
from ddf.metrics import PlySurface, shear_angle
from ddf.verify.problem import Answer, Check, Curve, Figure, Options, Problem

FloatArray = NDArray[np.float64]

RADIUS_MM = 60.0
HALF_MM = 64.0  # of the square ply: its corners just pass the equator
BOUND_DEG = 0.05
SERIES = 1.0e-3  # up to here the series is used
ELEMENT_MM, QUICK_MM = 2.0, 4.0


def sphere_shear_deg(z: FloatArray) -> FloatArray:
    """Shear angle g [deg] at z = u v of the net on a sphere; odd in z."""
    size = np.abs(z)
    largest = max(float(size.max()), 2 * SERIES)
    start = [SERIES - SERIES**3 / 18, 1 - SERIES**2 / 6]
    solution = solve_ivp(
        lambda at, y: (y[1], (np.cos(y[0]) - y[1]) / at), (SERIES, largest), start,
        rtol=1e-10, atol=1e-12, dense_output=True,
    ).sol  # fmt: skip
    beyond = solution(np.maximum(size, SERIES).ravel())[0].reshape(size.shape)
    return np.asarray(np.sign(z) * np.degrees(np.where(size < SERIES, size, beyond)))


def exact_hemisphere(spacing_mm: float = 1.0) -> DistanceField:
    """The hemisphere's own distance on a grid: what is left is the error of the net and of the grid's lookup."""
    reach, depth = RADIUS_MM + 6.0, 6.0
    count = [int(2 * reach / spacing_mm) + 1] * 2 + [int((reach + depth) / spacing_mm) + 1]
    origin = np.array([-reach, -reach, -depth])
    points = np.stack(np.meshgrid(*(o + spacing_mm * np.arange(k) for o, k in zip(origin, count, strict=True)),
                                  indexing="ij"), axis=-1)  # fmt: skip
    d = hemisphere_distance(points.reshape(-1, 3), RADIUS_MM).reshape(points.shape[:3])
    radial = points.copy()
    radial[..., 2] = np.maximum(radial[..., 2], 0.0)
    radial /= np.maximum(np.linalg.norm(radial, axis=-1, keepdims=True), 1e-9)
    return DistanceField(np.concatenate([d[..., None], radial], axis=-1).astype(np.float32), origin, spacing_mm)


def drape_square(field: DistanceField, element_mm: float) -> Drape:
    """A square ply laid from the pole."""
    h = HALF_MM
    ply = mesh_ply([(-h, -h), (h, -h), (h, h), (-h, h)], [], [], 0.0, element_mm)
    return drape_ply(ply, field, (0.0, 0.0))


def cell_shear(drape: Drape) -> tuple[FloatArray, FloatArray]:
    """Product u v [-] and shear angle [deg] of the cells that are on the hemisphere, (k,) each."""
    m, x = drape.mesh, drape.x
    surface = PlySurface(m.name, x, m.x, m.spacing, m.active, m.cell_fraction)
    places = []
    for axis in (0, 1):  # a chord of length a spans the arc 2 asin(a / 2R)
        arc = 2.0 * np.arcsin(0.5 * m.spacing[axis] / RADIUS_MM)
        places.append((np.arange(x.shape[1 + axis] - 1) + 0.5 - drape.start[axis]) * arc)
    z = places[0][:, None] * places[1][None]
    lowest = np.minimum.reduce([x[2, 1:, 1:], x[2, :-1, 1:], x[2, 1:, :-1], x[2, :-1, :-1]])
    on = lowest > 1.0
    return z[on], shear_angle(surface)[on]


def _solve(options: Options) -> Answer:
    element = options.element_mm or (QUICK_MM if options.quick else ELEMENT_MM)
    z, got = cell_shear(drape_square(exact_hemisphere(), element))
    expected = sphere_shear_deg(z)
    worst = int(np.argmax(np.abs(got - expected)))
    corner = int(np.argmax(z))
    checks = [
        Check("shear angle where it errs most", "deg", float(expected[worst]), float(got[worst]), BOUND_DEG, False),
        Check("largest shear angle", "deg", float(expected[corner]), float(got[corner]), BOUND_DEG, False),
    ]
    notes = []
    if not options.quick:
        meshed = distance_field(build_tool("hemisphere", radius_mm=RADIUS_MM))
        zm, gm = cell_shear(drape_square(meshed, element))
        em = sphere_shear_deg(zm)
        k = int(np.argmax(np.abs(gm - em)))
        checks.append(Check("the same on the tool as meshed", "deg", float(em[k]), float(gm[k]), None, False))
        notes.append("the meshed tool's triangles lie up to 0.02 mm under the hemisphere")
    order = np.argsort(z)
    line = np.linspace(0.0, float(z.max()), 200)
    some = order[z[order] > 0][:: max(1, len(z) // 150)]
    curves = (
        Curve("z g'' + g' = cos g", line, sphere_shear_deg(line)),
        Curve(f"net, {element:g} mm", z[some], got[some], points=True),
    )
    table = {"uv": z[order], "shear_deg": got[order], "expected_deg": expected[order]}
    return Answer(tuple(checks), Figure("u v / R^2 [-]", "shear angle [deg]", curves), table, tuple(notes))


PROBLEM = Problem(
    name="kinematic-net",
    title="Pin-jointed net on a hemisphere",
    source="Chebyshev 1878; Mack and Taylor, J. Textile Inst. 47 (1956) T477; ODE integrated here",
    solve=_solve,
)
