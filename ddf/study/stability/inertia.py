"""Mass scaling and load time: a ply formed over a hemisphere, against the result with little inertia.

Time by tau = t/T turns the motion  m x'' + c m x' = F(x, t/T)  into that of the mass m/T^2 with the damping c T: all
masses times M and all durations times T (damping over T) give the result of M/T^2, and so does the map.
"""

from __future__ import annotations

import numpy as np

from ddf.build import build_scene
from ddf.compare.outlines import outline_distances
from ddf.metrics.boundary import boundary_profile
from ddf.output.snapshot import ply_surface
from ddf.study.stability.map import FloatArray, Limit, Map, RuleLine, Spot, grid, judge
from ddf.study.stability.scenes import HEMISPHERE, Tables, make_case
from ddf.study.stability.trial import Trial, run_guarded

MASSES, TIMES = (1.0, 4.0, 16.0, 64.0), (0.25, 0.5, 1.0, 2.0)
QUICK = ((4.0, 1.0), (16.0, 0.25))
LITTLE = (1.0, 2.0)  # mass and time of the result that the others are held against
LARGEST = 4.0  # of M/T^2 by the rule
RIGHT_MM = 0.15
"""Mean distance of the outlines up to which a result is right: 1.5 % of an element."""


def _formed(mass: float, time: float) -> tuple[Trial, list[FloatArray]]:
    """The guards' word, and the outline of the ply; mass and time over the shipped cases' masses and HEMISPHERE's."""
    stages: list[Tables] = []
    for stage in HEMISPHERE["process"]["stages"]:
        damping = {key: stage[key] / time for key in ("mass_damping_1_s",) if key in stage}
        stages.append(stage | {"duration_s": time * stage["duration_s"]} | damping)
    shipped = build_scene(make_case(HEMISPHERE))
    skin = shipped.case.solver.diaphragm_mass_scaling
    solver = {"mass_scaling": mass * shipped.sheets[1].mass_scaling, "diaphragm_mass_scaling": mass * skin,
              "mass_damping_1_s": 30.0 / time}  # fmt: skip
    scene = build_scene(make_case(HEMISPHERE, process={"stages": stages}, solver=solver))
    trial = run_guarded(scene)
    return trial, boundary_profile(ply_surface(scene, scene.state, 1)).deformed if trial.finished else []


def chart(quick: bool) -> Map:
    """Masses and load times."""
    _, best = _formed(*((1.0, 1.0) if quick else LITTLE))
    spots = []
    for mass, time in QUICK if quick else grid(MASSES, TIMES):
        trial, outline = _formed(mass, time)
        away = outline_distances(best, outline).mean_mm if outline else np.inf
        verdict, guard = judge(away <= RIGHT_MM, trial.kind, trial.guard)
        spots.append(Spot(mass, time, mass / time**2 <= LARGEST, verdict, away, guard))
    mass_line = np.array([0.5, 100.0])
    lines = tuple(
        RuleLine(f"M/T2 = {level:g}{note}", mass_line, np.sqrt(mass_line / level))
        for level, note in ((1.0, ""), (LARGEST, ": the rule"), (16.0, ""))
    )
    return Map(
        "masses over the shipped cases'", "durations over those of a lift at 0.8 m/s",
        "mean distance of the outlines [mm]", tuple(spots), lines,
    )  # fmt: skip


LIMIT = Limit(
    "inertia", "Mass scaling and load time of a ply formed over a hemisphere",
    "the largest kinetic energy stays below 30 % of the final internal energy (audited): here M/T^2 <= 4", chart,
)  # fmt: skip
