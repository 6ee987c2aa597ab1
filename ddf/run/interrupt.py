"""SIGINT and SIGTERM of a run."""

from __future__ import annotations

import signal
from typing import Any


class Interrupt:
    """SIGINT and SIGTERM: while `noting`, the first is only noted; else, and from the second on, KeyboardInterrupt.

    Compilers and meshers do not survive an exception out of nowhere: while they work signals are noted.
    """

    def __init__(self) -> None:
        self.noting = False
        self.caught = False
        self._old: dict[int, Any] = {}

    def __enter__(self) -> Interrupt:
        for number in (signal.SIGINT, signal.SIGTERM):
            try:
                self._old[number] = signal.signal(number, self._note)
            except ValueError:  # not in the main thread: leave signals alone
                return self
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._old.items():
            signal.signal(number, handler)

    def _note(self, *_: object) -> None:
        if self.caught or not self.noting:
            raise KeyboardInterrupt
        self.caught = True
