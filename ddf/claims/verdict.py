"""A claim's measured quantities against their thresholds, over all repeats of the runs, and the verdict on it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from ddf.claims.formed import Formed
from ddf.errors import DdfError

REPRODUCED, IN_PART, UNDECIDED, NOT_REPRODUCED, NO_EVIDENCE = (
    "reproduced", "in part", "undecided", "not reproduced", "no evidence",
)  # fmt: skip
HOLDS, FAILS, WITHIN_SCATTER, NOT_JUDGED = "holds", "fails", "within scatter", "not judged"


@dataclass(frozen=True)
class Value:
    """A quantity of one set of runs and what the claim expects of it."""

    quantity: str
    unit: str
    value: float
    relation: Literal["above", "below", ""]  # to the threshold; "": reported, not judged
    threshold: float = math.nan

    @property
    def margin(self) -> float:
        """How far the value is on the claim's side of the threshold, in its unit; NaN where it is not judged."""
        away = self.value - self.threshold
        return away if self.relation == "above" else -away if self.relation == "below" else math.nan


@dataclass(frozen=True)
class Finding:
    """A quantity over all combinations of repeats: the value of the runs as shipped, and how far it scatters."""

    quantity: str
    unit: str
    relation: str
    threshold: float
    value: float
    low: float
    high: float
    margin: float
    least_margin: float  # of all combinations
    largest_margin: float
    combinations: int
    reason: str = ""  # why there is no evidence

    @property
    def state(self) -> str:
        """Whether the quantity is as expected in all combinations, in none, or in some."""
        if self.reason or (self.relation and math.isnan(self.margin)):
            return NO_EVIDENCE
        if not self.relation:
            return NOT_JUDGED
        if self.least_margin > 0:
            return HOLDS
        return FAILS if self.largest_margin <= 0 else WITHIN_SCATTER


AGAIN = ", again"  # a forming's other repeat, where there is one, under its name and this


@dataclass(frozen=True)
class Measure:
    """Quantities that the same formings are needed for: one run of each, and where there is one another repeat."""

    about: str  # in the table where a run is missing
    needs: tuple[str, ...]
    values: Callable[[Mapping[str, Formed]], list[Value]]


@dataclass(frozen=True)
class Panel:
    """A part of a claim's picture: a ply of a forming, as a photograph or by its shear."""

    forming: str
    ply: int  # 0 is the bottom one
    shear: bool = False


@dataclass(frozen=True)
class Claim:
    """A claim of the paper."""

    number: int
    title: str
    statement: str  # in our own words
    section: str  # of the paper
    measures: tuple[Measure, ...]
    panels: tuple[Panel, ...]


@dataclass(frozen=True)
class Judged:
    """A claim and what was found."""

    claim: Claim
    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> str:
        """All quantities as expected: reproduced; none: not; some, and some not: in part; undecided otherwise."""
        states = {finding.state for finding in self.findings} - {NOT_JUDGED}
        if states <= {NO_EVIDENCE}:
            return NO_EVIDENCE
        if states == {HOLDS}:
            return REPRODUCED
        if states == {FAILS}:
            return NOT_REPRODUCED
        return IN_PART if {HOLDS, FAILS} <= states else UNDECIDED


#: runs of each forming, its repeats in order; and why those that are missing are
Runs = Mapping[str, Sequence[Formed]]


def judge(claim: Claim, runs: Runs, missing: Mapping[str, str]) -> Judged:
    """Measure a claim on all combinations of the repeats that there are."""
    findings: list[Finding] = []
    for measure in claim.measures:
        lost = [f"{name}: {missing.get(name) or 'not run'}" for name in measure.needs if not runs.get(name)]
        if lost:
            findings.append(_none(measure.about, "; ".join(lost)))
            continue
        try:
            findings += _measured(measure, runs)
        except DdfError as error:
            findings.append(_none(measure.about, str(error)))
    return Judged(claim, tuple(findings))


def _measured(measure: Measure, runs: Runs) -> list[Finding]:
    tables = []
    for numbers in itertools.product(*(range(len(runs[name])) for name in measure.needs)):
        chosen = {}
        for name, k in zip(measure.needs, numbers, strict=True):
            chosen[name] = runs[name][k]
            if len(runs[name]) > 1:
                chosen[name + AGAIN] = runs[name][(k + 1) % len(runs[name])]
        tables.append(measure.values(chosen))
    return [_finding(column) for column in zip(*tables, strict=True)]


def _finding(values: Sequence[Value]) -> Finding:
    first = values[0]
    found, margins = [value.value for value in values], [value.margin for value in values]
    unknown = any(math.isnan(value) for value in found)
    return Finding(
        first.quantity, first.unit, first.relation, first.threshold, first.value,
        math.nan if unknown else min(found), math.nan if unknown else max(found), first.margin,
        math.nan if unknown else min(margins), math.nan if unknown else max(margins), len(values),
        "a run has nothing to measure it on" if unknown and first.relation else "",
    )  # fmt: skip


def _none(quantity: str, reason: str) -> Finding:
    nan = math.nan
    return Finding(quantity, "", "", nan, nan, nan, nan, nan, nan, nan, 0, reason)
