"""What a verification problem is: a question with a known answer, and what the solver said to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ddf.case.schema import HyperelasticMaterial, WovenMaterial

FloatArray = NDArray[np.float64]

LATTICE, SHELL_MEMBRANE = "lattice", "shell-membrane"


@dataclass(frozen=True)
class Options:
    """How to solve a problem. What is None takes the problem's own default."""

    quick: bool = False  # coarser and shorter, same bounds
    element_mm: float | None = None
    fabric: WovenMaterial | None = None
    rubber: HyperelasticMaterial | None = None
    formulation: str = "lattice"  # of plies; the other one is SHELL_MEMBRANE
    threads: int = 1

    @property
    def shell(self) -> bool:
        """Whether plies are of shell-membrane cells."""
        return self.formulation == SHELL_MEMBRANE


@dataclass(frozen=True)
class Check:
    """One quantity against its expected value."""

    quantity: str
    unit: str
    expected: float
    got: float
    bound: float | None  # largest error allowed; None: reported, not judged
    relative: bool = True  # error over |expected|, else in the quantity's unit

    @property
    def error(self) -> float:
        """Error, relative or in the quantity's unit."""
        difference = abs(self.got - self.expected)
        return difference / abs(self.expected) if self.relative else difference

    @property
    def passed(self) -> bool:
        """Whether the error is within its bound; NaN is not."""
        return self.bound is None or (math.isfinite(self.got) and self.error <= self.bound)


def worst(
    quantity: str, unit: str, at: Sequence[str], expected: FloatArray, got: FloatArray, bound: float | None
) -> Check:
    """The check of a curve: its point with the largest relative error; `at` says where each point is."""
    k = int(np.argmax(np.nan_to_num(np.abs(got / expected - 1.0), nan=np.inf)))
    return Check(f"{quantity}, worst: {at[k]}", unit, float(expected[k]), float(got[k]), bound)


@dataclass(frozen=True)
class Curve:
    """One curve of a figure."""

    name: str
    x: FloatArray
    y: FloatArray
    points: bool = False  # markers (what the solver said) instead of a line (what is known)


@dataclass(frozen=True)
class Figure:
    """One picture a problem: axes with units, known answer as lines, the solver's as points."""

    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    equal_axes: bool = False
    log_y: bool = False


@dataclass(frozen=True)
class Answer:
    """What the solver said."""

    checks: tuple[Check, ...]
    figure: Figure
    table: dict[str, FloatArray]  # columns of the CSV; names carry units, as in "force_N"
    notes: tuple[str, ...] = ()  # e.g. the observed order of convergence

    @property
    def passed(self) -> bool:
        """Whether all checks passed."""
        return all(check.passed for check in self.checks)


@dataclass(frozen=True)
class Problem:
    """A problem by its name on the command line."""

    name: str
    title: str
    source: str  # where the known answer comes from
    solve: Callable[[Options], Answer] = field(repr=False)
    formulations: tuple[str, ...] = (LATTICE,)  # of plies, that it can be solved with
