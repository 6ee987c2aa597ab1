"""A shear law that falls: bands one element wide, whatever the element.

A ply is held along two edges of family 1 and one of them is moved along itself, with family 2 soft enough to be in the
way of nothing. Every row of cells along family 1 has its own shear angle g, and the mean of sin g is what the edge asks
for. Of the energy  sum A W(sin g), dW/d(sin g) = N_s(g),  even shear is the least only where N_s rises. Where it falls
some rows take the shear and others give theirs back, one row of cells at a time. The published law falls between 6.8
and 10.8 degrees; the monotone law falls nowhere. The fabric of this map has no rigidity in its plane: fibres that bend
from one row to the next would bound how fast the shear changes, and bands would be as wide on every mesh.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from ddf.case import WovenMaterial
from ddf.elements.shear import shear_sine
from ddf.errors import UnstableError
from ddf.plausible.materials import falling_range
from ddf.plausible.prepare import examine
from ddf.simulate import Simulation
from ddf.study.stability.map import WARNED, FloatArray, Limit, Map, RuleLine, Spot, grid, judge
from ddf.study.stability.scenes import FLAT, make_case
from ddf.study.stability.trial import warnings_of
from ddf.verify.problem import Options
from ddf.verify.scenes import damped, fabric_of, held, lead, ply_scene, positions, settle

LENGTH_MM, HEIGHT_MM = 120.0, 24.0
SOFT_N_MM = 5.0  # modulus of family 2
SIZES, QUICK_SIZES = (2.0, 3.0, 4.0), (3.0,)
ANGLES, QUICK_ANGLES = (3.0, 6.0, 8.0, 10.0, 16.0), (3.0, 9.0)
DAMPING_1_S, SPEED_MM_S = 200.0, 200.0
EVEN_DEG = 1.0
"""Neighbouring rows that differ by less than this are evenly sheared (the edges' disturbance is smooth)."""


def _fabric(law: str) -> WovenMaterial:
    return fabric_of(Options()).model_copy(update={"shear_law": law, "in_plane_bending_Nmm": 0.0})


def row_angles(fabric: WovenMaterial, element: float, degrees: float) -> FloatArray:
    """Shear angles [deg] of the rows of cells between the edges, in the middle of the ply, at rest."""
    soft = fabric.model_copy(update={"membrane_modulus_N_mm": (fabric.membrane_modulus_N_mm[0], SOFT_N_MM)})
    scene = damped(ply_scene(soft, (LENGTH_MM, HEIGHT_MM), element), DAMPING_1_S)
    start = positions(scene).copy()
    far = 0.5 * HEIGHT_MM - 1e-3
    edges = np.abs(start[1]) > far
    scene = held(scene, edges)
    noise = np.random.default_rng(0).uniform(-1e-3, 1e-3, start[:2, ~edges].shape)
    positions(scene)[:2, ~edges] += element * noise
    target = start[:, edges].copy()
    upper, angle = target[1] > 0, np.deg2rad(degrees)
    target[0, upper] += HEIGHT_MM * np.sin(angle)
    target[1, upper] -= HEIGHT_MM * (1.0 - np.cos(angle))
    sim = Simulation(scene)
    way = HEIGHT_MM * float(np.sin(angle))
    lead(sim, edges, target, round(way / SPEED_MM_S / scene.model.dt))
    sim.state.v[:] = 0.0
    with suppress(UnstableError):  # what does not come to rest is judged as it is
        settle(sim, 0.05, 0.15)
    shear = np.rad2deg(np.arcsin(shear_sine(positions(scene))))
    rows: FloatArray = np.abs(shear[shear.shape[0] // 2])
    return rows


def _spot(law: str, element: float, degrees: float, falls: tuple[float, float] | None) -> tuple[Spot, float]:
    """The spot, and the mean width of its bands [mm]."""
    rows = row_angles(_fabric(law), element, degrees)
    jump = float(np.abs(np.diff(rows)).max())
    case = make_case(
        FLAT, materials={"fabric": _fabric(law).model_dump(exclude={"base"})}, plies={"material": "fabric"}
    )
    warned = [w for w in warnings_of(examine(case)).split("; ") if "shear_law" in w]
    safe = falls is None or not falls[0] - 0.5 <= degrees <= falls[1] + 0.5
    verdict, guard = judge(jump < EVEN_DEG, WARNED, "; ".join(warned) if jump >= EVEN_DEG else "")
    above = rows > rows.mean()
    bands = int(above[0]) + int((above[1:] & ~above[:-1]).sum())
    return Spot(element, degrees, safe, verdict, jump, guard), element * float(above.sum()) / max(bands, 1)


def _chart(law: str, quick: bool) -> Map:
    sizes, angles = (QUICK_SIZES, QUICK_ANGLES) if quick else (SIZES, ANGLES)
    falls = falling_range(_fabric(law))
    spots: list[Spot] = []
    widths: dict[float, list[float]] = {}
    for size, degrees in grid(sizes, angles):
        spot, width = _spot(law, size, degrees, falls)
        spots.append(spot)
        if spot.measure >= EVEN_DEG:
            widths.setdefault(size, []).append(width)
    ends = np.array([0.8 * sizes[0], 1.25 * sizes[-1]])
    lines = tuple(RuleLine(f"N_s falls {side} {g:.1f} deg", ends, np.full(2, g))
                  for side, g in zip(("from", "to"), falls or (), strict=False))  # fmt: skip
    notes = [f"{size:g} mm: bands {np.mean(found):.1f} mm wide, {np.mean(found) / size:.1f} rows of cells"
             for size, found in widths.items()]  # fmt: skip
    return Map("element [mm]", "mean shear angle [deg]", "largest step of shear from row to row [deg]",
               tuple(spots), lines, log_x=False, log_y=False, notes=tuple(notes))  # fmt: skip


def chart_published(quick: bool) -> Map:
    """The published law."""
    return _chart("published", quick)


def chart_monotone(quick: bool) -> Map:
    """The monotone law."""
    return _chart("monotone", quick)


PUBLISHED = Limit(
    "shear-bands", "Simple shear of a ply, published shear law",
    "shear is even outside of where N_s falls (warned of before the run); half a degree beside it", chart_published,
)  # fmt: skip
MONOTONE = Limit(
    "shear-bands-monotone", "Simple shear of a ply, monotone shear law", "no limit: N_s rises everywhere",
    chart_monotone,
)  # fmt: skip
