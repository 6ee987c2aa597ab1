"""Errors that a user meets, each with a message, a hint and the exit code of the command line."""

from __future__ import annotations

from dataclasses import dataclass


class DdfError(Exception):
    """Base of all expected failures: `message` says what is wrong, `hint` what to do about it."""

    exit_code = 1

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        return f"{self.message}\n  hint: {self.hint}" if self.hint else self.message


@dataclass(frozen=True)
class Fault:
    """One fault of a case file: where it is, what is wrong, what is allowed."""

    file: str
    line: int
    key: str
    problem: str
    allowed: str = ""
    suggestion: str = ""

    def __str__(self) -> str:
        text = f"{self.file}:{self.line}: {self.key or '(file)'}: {self.problem}"
        if self.allowed:
            text += f"; allowed: {self.allowed}"
        if self.suggestion:
            text += f"; did you mean {self.suggestion!r}?"
        return text


class CaseError(DdfError):
    """An invalid case or sweep file; carries all its faults at once."""

    exit_code = 2
    shown = 100  # faults in the message; `faults` has them all

    def __init__(self, faults: list[Fault], what: str = "case") -> None:
        self.faults = faults
        count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
        lines = [f"{count} in the {what}", *(f"  {fault}" for fault in faults[: self.shown])]
        if len(faults) > self.shown:
            lines.append(f"  ... and {len(faults) - self.shown} more")
        super().__init__("\n".join(lines))


class UsageError(DdfError):
    """A request that cannot be met as it was asked (a folder that is not empty, nothing to resume)."""

    exit_code = 2


class MeshError(DdfError):
    """A mesh that cannot be made or that is not what was asked for."""


class UnstableError(DdfError):
    """The run went wrong: says where, when, the likely cause and the key to change.

    `smaller_step`: a smaller step may cure it.
    """

    exit_code = 3

    def __init__(self, message: str, hint: str = "", *, smaller_step: bool = False) -> None:
        super().__init__(message, hint)
        self.smaller_step = smaller_step
