"""The five claims: what the paper saw, as quantities of runs with thresholds that were set before any was measured.

"More", "less": a ratio above or below 1. "Along": a mean angle of at most half of what random directions give.
"At the same sites": more than 95 of 100 random radial patterns would have. "Much", "strongly": the factors below.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from ddf.claims.cases import DOUBLE, NO_FRICTION, SINGLE, TURNED, VACUUM_FIRST
from ddf.claims.formed import Formed
from ddf.claims.measures import (
    FIBRE_CHANCE_DEG,
    FOUR_FIBRES_CHANCE_DEG,
    RADIAL_CHANCE_DEG,
    amplitude_ratios,
    any_fibre_angle,
    below_chance,
    directions_with_wrinkles,
    own_fibre_angle,
    radial_angle,
    severity,
    share_by_chance,
    share_found,
)
from ddf.claims.verdict import AGAIN, Claim, Measure, Panel, Value
from ddf.compare.fields import shear_difference

MUCH = 1.5  # ratio that counts as "much more"
STRONGLY = 0.25  # change of a shear field over the field, both rms
CLEAR_WRINKLE_MM = 1.0  # twice a ply's thickness

Set = Mapping[str, Formed]


def _directions(forming: str, runs: Set) -> list[Value]:
    rows = runs[forming].wrinkles
    return [
        Value(f"{forming}: mean angle to the radius", "deg", radial_angle(rows), "below",
              below_chance(rows, RADIAL_CHANCE_DEG)),
        Value(f"{forming}: mean angle to the nearer fibres", "deg", own_fibre_angle(rows), "below",
              below_chance(rows, FIBRE_CHANCE_DEG)),
        Value(f"{forming}: wrinkles", "", float(len(rows)), ""),
    ]  # fmt: skip


def _outlines(runs: Set) -> list[Value]:
    straight, turned = runs[SINGLE].plies[0], runs[TURNED].plies[0]
    return [
        Value("change of outline, 0/90 over +-45", "", _ratio(straight.outline_change_mm, turned.outline_change_mm),
              "above", MUCH),
        Value("change of the outline's form, 0/90 over +-45", "",
              _ratio(straight.outline_form_change_mm, turned.outline_form_change_mm), "above", MUCH),
        Value("mean distance of flat and formed outline, 0/90", "mm", straight.outline_change_mm, ""),
        Value("mean distance of flat and formed outline, +-45", "mm", turned.outline_change_mm, ""),
        Value("shear angle rms, 0/90 over +-45", "", _ratio(straight.shear_rms_deg, turned.shear_rms_deg), ""),
    ]  # fmt: skip


def _severities(of: str, over: str, words: str, relation: str, runs: Set) -> list[Value]:
    """Ratios of the three severities of two formings."""
    a, b = severity(runs[of].plies), severity(runs[over].plies)
    found = (("length times amplitude", a.ridge_mm2, b.ridge_mm2), ("largest amplitude", a.largest_mm, b.largest_mm),
             ("wrinkled area", a.area_percent, b.area_percent))  # fmt: skip
    return [Value(f"{name}, {words}", "", _ratio(x, y), relation, 1.0) for name, x, y in found]  # type: ignore[arg-type]


def _stack_directions(runs: Set) -> list[Value]:
    run = runs[DOUBLE]
    found, directions = directions_with_wrinkles(run)
    return [
        Value("mean angle to the radius, both plies", "deg", radial_angle(run.wrinkles), "below",
              below_chance(run.wrinkles, RADIAL_CHANCE_DEG)),
        Value("mean angle to the nearest fibres of either ply", "deg", any_fibre_angle(run.plies), "below",
              below_chance(run.wrinkles, FOUR_FIBRES_CHANCE_DEG)),
        Value(f"of {directions} fibre directions, with a wrinkle along it", "", float(found), "above",
              directions - 0.5),
    ]  # fmt: skip


def _superposed(runs: Set) -> list[Value]:
    double, singles = runs[DOUBLE], {"0/90": runs[SINGLE], "+-45": runs[TURNED]}
    both = [row for run in singles.values() for row in run.wrinkles]
    stack = [ply.wrinkles for ply in double.plies]
    sought = [(f"sites of {name} alone found in each of the two plies", run.wrinkles, stack)
              for name, run in singles.items()]  # fmt: skip
    values = [
        Value(words, "%", 100 * share_found(rows, among), "above", 100 * share_by_chance(rows, among, double.axis_xy))
        for words, rows, among in sought
    ]
    # the other way round is not judged: so many wrinkles of the single plies meet most of any pattern
    back, chance = share_found(double.wrinkles, [both]), share_by_chance(double.wrinkles, [both], double.axis_xy)
    values += [
        Value("sites of the two plies found in either alone", "%", 100 * back, ""),
        Value("what 95 of 100 random patterns do not exceed there", "%", 100 * chance, ""),
    ]
    ratios = amplitude_ratios(both, double.wrinkles)
    median = float(np.median(ratios)) if ratios else math.nan
    alone, two = [severity(run.plies) for run in singles.values()], severity(double.plies)
    largest = _ratio(two.largest_mm, max(one.largest_mm for one in alone))
    ridges = _ratio(two.ridge_mm2, sum(one.ridge_mm2 for one in alone))
    values += [
        Value("amplitude at these sites, two plies over one, median", "", median, "above", 1.0),
        Value("largest amplitude, two plies over the larger of one", "", largest, "above", 1.0),
        Value("length times amplitude, two plies over both single ones", "", ridges, "above", 1.0),
    ]
    return values


def _still_wrinkled(runs: Set) -> list[Value]:
    high = [row for row in runs[NO_FRICTION].wrinkles if row["amplitude_mm"] > CLEAR_WRINKLE_MM]
    return [Value(f"wrinkles over {CLEAR_WRINKLE_MM:g} mm without friction", "", float(len(high)), "above", 0.5)]


def _shear_change(runs: Set) -> list[Value]:
    field = _rms([ply.shear_rms_deg for ply in runs[DOUBLE].plies])
    change = _shear_apart(runs[DOUBLE], runs[NO_FRICTION])
    again = runs.get(DOUBLE + AGAIN)
    between = None if again is None else _ratio(_shear_apart(runs[DOUBLE], again), field)
    words, threshold = "change of shear without friction over the shear with it", max(STRONGLY, between or 0.0)
    values = [Value(words, "", _ratio(change, field), "above", threshold)]
    return values if between is None else [*values, Value("the same between repeats with friction", "", between, "")]


def _independence(runs: Set) -> list[Value]:
    alone = Formed("alone", (runs[TURNED].plies[0], runs[SINGLE].plies[0]), (0.0, 0.0))  # +-45 is the bottom ply
    away = {name: _shear_apart(alone, runs[name]) for name in (DOUBLE, NO_FRICTION)}
    return [
        Value("shear apart from the plies formed alone, no friction over friction", "",
              _ratio(away[NO_FRICTION], away[DOUBLE]), "below", 1.0)
    ]  # fmt: skip


def _shear_apart(first: Formed, second: Formed) -> float:
    """Difference of the shear angles of two runs' plies, rms [deg]."""
    pairs = zip(first.plies, second.plies, strict=True)
    return _rms([shear_difference(a.surface, b.surface).rms_deg for a, b in pairs])


def _ratio(first: float, second: float) -> float:
    return first / second if second > 0 else math.nan


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


CLAIMS = (
    Claim(
        1, "wrinkles run radially and along the fibres",
        "Formed alone, the 0/90 ply and the +-45 ply both wrinkle radially from the tool's centre, along their fibres.",
        "2.1, figures 3 to 5",
        (Measure("directions, 0/90", (SINGLE,), partial(_directions, SINGLE)),
         Measure("directions, +-45", (TURNED,), partial(_directions, TURNED))),
        (Panel(SINGLE, 0), Panel(TURNED, 0)),
    ),
    Claim(
        2, "0/90 changes its outline, +-45 wrinkles the more",
        "The outline of the +-45 ply stays much as it was, that of the 0/90 ply changes a great deal; but the +-45 "
        "ply's wrinkles are the more severe.",
        "2.1, figures 5, 11 to 13",
        (Measure("outlines", (SINGLE, TURNED), _outlines),
         Measure("severity, +-45 over 0/90", (SINGLE, TURNED),
                 partial(_severities, TURNED, SINGLE, "+-45 over 0/90", "above"))),
        (Panel(SINGLE, 0, True), Panel(TURNED, 0, True)),
    ),
    Claim(
        3, "two plies: both patterns at once, magnified",
        "Formed together, +-45 under 0/90, the plies wrinkle along every fibre direction of either, radially; the "
        "part shows the patterns of both plies formed alone, with larger wrinkles.",
        "2.2 and 3.3.3, figures 6, 15, 16",
        (Measure("directions, two plies", (DOUBLE,), _stack_directions),
         Measure("sites, two plies and each alone", (DOUBLE, SINGLE, TURNED), _superposed)),
        (Panel(SINGLE, 0), Panel(TURNED, 0), Panel(DOUBLE, 0), Panel(DOUBLE, 1)),
    ),
    Claim(
        4, "without friction between the plies: less severe, not gone, sheared otherwise",
        "With no friction between the plies in place of 0.28 wrinkles are less severe but do not vanish; the shear "
        "changes strongly, for the plies deform almost as if each were alone.",
        "3.4, figures 17, 18",
        (Measure("severity, no friction over friction", (DOUBLE, NO_FRICTION),
                 partial(_severities, NO_FRICTION, DOUBLE, "no friction over 0.28", "below")),
         Measure("wrinkles without friction", (NO_FRICTION,), _still_wrinkled),
         Measure("shear, friction and none", (DOUBLE, NO_FRICTION), _shear_change),
         Measure("shear, and each ply alone", (DOUBLE, NO_FRICTION, SINGLE, TURNED), _independence)),
        (Panel(DOUBLE, 0, True), Panel(NO_FRICTION, 0, True), Panel(DOUBLE, 1, True), Panel(NO_FRICTION, 1, True)),
    ),
    Claim(
        5, "vacuum before the lift: less severe",
        "With the box evacuated before the tool is lifted, not after, the two plies' wrinkles are less severe.",
        "3.5, figure 19",
        (Measure("severity, vacuum first over lift first", (DOUBLE, VACUUM_FIRST),
                 partial(_severities, VACUUM_FIRST, DOUBLE, "vacuum first over lift first", "below")),),
        (Panel(DOUBLE, 0), Panel(VACUUM_FIRST, 0), Panel(DOUBLE, 1), Panel(VACUUM_FIRST, 1)),
    ),
)  # fmt: skip
