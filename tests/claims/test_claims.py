"""Every claim on synthetic parts that show it and on ones that do not."""

import math

import numpy as np
import pytest
from stars import formed, square, star

from ddf.claims.cases import DOUBLE, NO_FRICTION, SINGLE, TURNED, VACUUM_FIRST
from ddf.claims.claims import CLAIMS
from ddf.claims.verdict import FAILS, HOLDS, IN_PART, NO_EVIDENCE, NOT_REPRODUCED, REPRODUCED, UNDECIDED, judge

RAYS, BETWEEN = (0, 90, 180, 270), (45, 135, 225, 315)


def verdict(number, missing=None, **runs):
    names = {"single": SINGLE, "turned": TURNED, "double": DOUBLE, "free": NO_FRICTION, "vacuum": VACUUM_FIRST}
    given = {names[key]: run if isinstance(run, list) else [run] for key, run in runs.items()}
    return judge(CLAIMS[number - 1], given, missing or {})


def states(judged):
    return [finding.state for finding in judged.findings if finding.relation]


def test_radial_along_the_fibres():
    along = verdict(1, single=formed(star(0, RAYS)), turned=formed(star(45, BETWEEN)))
    assert along.verdict == REPRODUCED
    assert [f.value for f in along.findings if f.relation] == pytest.approx([0.0] * 4, abs=1e-9)
    round_it = verdict(1, single=formed(star(0, BETWEEN, turn_deg=90)), turned=formed(star(45, RAYS, turn_deg=90)))
    assert round_it.verdict == NOT_REPRODUCED
    radial_only = verdict(1, single=formed(star(0, BETWEEN)), turned=formed(star(45, RAYS)))
    assert states(radial_only) == [HOLDS, FAILS] * 2
    assert radial_only.verdict == IN_PART


def pinched(x, y):
    """Sides drawn in at their middles, corners left: the form changes."""
    return 0.2 * np.abs(np.cos(2 * np.arctan2(y, x)))


def test_outline_and_severity():
    star_like, square_like = square(0, inward=pinched), square(45, inward=lambda x, y: 0.02)
    high, low = {"amplitude": 8.0, "percent": 20.0}, {"amplitude": 4.0, "percent": 10.0}
    as_claimed = verdict(2, single=formed(star(0, RAYS, surface=star_like, **low)),
                         turned=formed(star(45, BETWEEN, surface=square_like, **high)))  # fmt: skip
    assert as_claimed.verdict == REPRODUCED
    assert as_claimed.findings[-2].value == pytest.approx(2.0)
    other_way = verdict(2, single=formed(star(0, RAYS, surface=square(0, inward=lambda x, y: 0.02), **high)),
                        turned=formed(star(45, BETWEEN, surface=square(45, inward=pinched), **low)))  # fmt: skip
    assert other_way.verdict == NOT_REPRODUCED


SINGLES = {"single": formed(star(0, RAYS)), "turned": formed(star(45, BETWEEN))}


def test_superposed_and_magnified():
    both = verdict(
        3, double=formed(star(45, RAYS + BETWEEN, amplitude=7), star(0, RAYS + BETWEEN, amplitude=7)), **SINGLES
    )
    assert both.verdict == REPRODUCED
    chance = both.findings[6].value
    assert 0 < chance < 100
    assert [f.value for f in both.findings] == pytest.approx([0, 0, 4, 100, 100, 100, chance, 1.4, 1.4, 2.8], abs=0.02)
    elsewhere = [22.5, 112.5, 202.5, 292.5]
    neither = verdict(3, double=formed(star(45, elsewhere, amplitude=2, turn_deg=60),
                                       star(0, elsewhere, amplitude=2, turn_deg=60)), **SINGLES)  # fmt: skip
    assert HOLDS not in states(neither)
    one_only = verdict(3, double=formed(star(45, RAYS), star(0, RAYS)), **SINGLES)
    assert one_only.verdict == IN_PART
    assert [f.state for f in one_only.findings[2:5]] == [FAILS, HOLDS, FAILS]  # sites of 0/90, but not of +-45


def test_friction_between_the_plies():
    alone = {"single": formed(star(0, RAYS, surface=square(0, shear=0.1))),
             "turned": formed(star(45, BETWEEN, surface=square(45, shear=0.2)))}  # fmt: skip
    tied = formed(star(45, RAYS, amplitude=8, percent=20, surface=square(45, shear=0.3)),
                  star(0, RAYS, amplitude=8, percent=20, surface=square(0, shear=0.3)))  # fmt: skip
    slipping = formed(star(45, RAYS, amplitude=4, surface=square(45, shear=0.2)),
                      star(0, RAYS, amplitude=4, surface=square(0, shear=0.1)))  # fmt: skip
    assert verdict(4, double=tied, free=slipping, **alone).verdict == REPRODUCED
    smooth = formed(*(star(angle, (), surface=square(angle, shear=0.3), percent=0.0) for angle in (45, 0)))
    gone = verdict(4, double=tied, free=smooth, **alone)
    assert states(gone) == [HOLDS] * 3 + [FAILS] * 3  # none left, shear unchanged, plies as far from alone as before
    worse = verdict(4, double=slipping, free=tied, **alone)
    assert states(worse)[:3] == [FAILS] * 3
    assert states(worse)[-1] == FAILS
    turns_up = formed(*(star(angle, RAYS, surface=square(angle, shear=0.05)) for angle in (45, 0)))
    scattered = verdict(4, double=[tied, turns_up], free=slipping, **alone)
    shear = next(f for f in scattered.findings if f.quantity.startswith("change of shear"))
    assert shear.state == FAILS  # repeats with friction differ by more
    assert shear.value > 0.25


def test_vacuum_first():
    high, low = (formed(star(45, RAYS, amplitude=a, percent=a), star(0, RAYS, amplitude=a, percent=a)) for a in (9, 6))
    less = verdict(5, double=high, vacuum=low)
    assert less.verdict == REPRODUCED
    assert less.findings[0].margin == pytest.approx(1 / 3)
    assert verdict(5, double=low, vacuum=high).verdict == NOT_REPRODUCED


def test_what_scatter_decides_is_undecided():
    def two(a):
        return formed(star(45, RAYS, amplitude=a, percent=a), star(0, RAYS, amplitude=a, percent=a))

    unsure = verdict(5, double=[two(6), two(8)], vacuum=[two(5), two(7)])
    assert unsure.verdict == UNDECIDED
    assert (unsure.findings[0].low, unsure.findings[0].high) == pytest.approx((5 / 8, 7 / 6))
    assert unsure.findings[0].combinations == 4
    assert unsure.findings[0].value == pytest.approx(5 / 6)  # of the first of each
    assert verdict(5, double=[two(8), two(9)], vacuum=[two(5), two(7)]).verdict == REPRODUCED


def test_a_run_that_is_missing_is_no_evidence():
    part = formed(star(45, RAYS), star(0, RAYS))
    lost = verdict(5, {VACUUM_FIRST: "failed, unstable at 0.133 s"}, double=part)
    assert lost.verdict == NO_EVIDENCE
    assert "unstable at 0.133 s" in lost.findings[0].reason
    smooth = formed(star(45, (), percent=0.0), star(0, (), percent=0.0))
    nothing = verdict(5, double=smooth, vacuum=part)  # nothing to compare with
    assert nothing.verdict == NO_EVIDENCE
    assert math.isnan(nothing.findings[0].value)
    assert verdict(1, single=formed(star(0, ())), turned=formed(star(45, ()))).verdict == NO_EVIDENCE
