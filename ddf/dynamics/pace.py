"""How many members of a team to use: all of them, or half where that is quicker.

On a machine that is busy with other work a member is now and then off its processor for some milliseconds, and all
others wait for it at the next barrier, ten times a step: two threads beside one other process took 1.4 times as long as
one thread. Results do not depend on the number of threads, so it may change from batch to batch. The other number is
tried for some batches after the first ones, from time to time, and when batches suddenly take longer.
"""

from __future__ import annotations

FIRST, EVERY, TRIAL = 5, 300, 3
"""Batches before the first trial, from one to the next, and of a trial itself."""
GAIN = 0.9
"""A trial has to take less than this share of what batches took before it."""
JUMP, JUMPS = 1.4, 3
"""So many batches in a row, each so many times longer than those before, call for a trial."""
LONG, SHORT = 0.05, 0.4
"""Of the last batch in the running means: that of what is usual, and that of late."""


class Pace:
    """Chooses the number of members from how long batches of steps take."""

    def __init__(self, members: int) -> None:
        self.members = members
        self.chosen = members
        self._left, self._jumps = FIRST, 0
        self._usual = self._late = 0.0
        self._tried: list[float] = []

    @property
    def count(self) -> int:
        """Members for the next batch."""
        return self.chosen if self._left > 0 else self._other

    @property
    def _other(self) -> int:
        return max(1, self.members // 2) if self.chosen == self.members else self.members

    def took(self, seconds_a_step: float) -> None:
        """Note how long the batch with `count` members took [s a step]."""
        if self.members == 1:
            return
        if self._left == 0:
            self._tried.append(seconds_a_step)
            if len(self._tried) == TRIAL:
                self._end_trial(sum(self._tried) / TRIAL)
            return
        if self._usual == 0.0:
            self._usual = self._late = seconds_a_step
        self._jumps = self._jumps + 1 if seconds_a_step > JUMP * self._usual else 0
        self._usual += LONG * (seconds_a_step - self._usual)
        self._late += SHORT * (seconds_a_step - self._late)
        self._left = 0 if self._jumps == JUMPS else self._left - 1

    def _end_trial(self, pace: float) -> None:
        if pace < GAIN * self._late:
            self.chosen, self._usual, self._late = self._other, pace, pace
        else:
            self._usual = self._late
        self._tried, self._jumps = [], 0
        self._left = EVERY if self.chosen == self.members else EVERY // 4
