"""What was found: faults that stop a run before it starts, and warnings that it starts with."""

from __future__ import annotations

from dataclasses import dataclass, field

from ddf.case.faults import Problem
from ddf.case.words import KeyPath


@dataclass
class Findings:
    """Problems by their weight, in the order they were found."""

    faults: list[Problem] = field(default_factory=list)
    warnings: list[Problem] = field(default_factory=list)

    def fault(self, path: KeyPath, problem: str, allowed: str = "", suggestion: str = "") -> None:
        """Note what makes the case impossible to run."""
        self.faults.append(Problem(path, problem, allowed, suggestion))

    def warn(self, path: KeyPath, problem: str, allowed: str = "") -> None:
        """Note what makes the result doubtful."""
        self.warnings.append(Problem(path, problem, allowed))

    def limit(self, value: float, warning: float, fault: float, path: KeyPath, problem: str, allowed: str) -> None:
        """Note a value that should not exceed `warning` and cannot exceed `fault`."""
        if value > fault:
            self.fault(path, problem, allowed)
        elif value > warning:
            self.warn(path, problem, allowed)
