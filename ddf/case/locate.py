"""Lines of keys in the text of a TOML file, which the standard parser does not tell.

The text is known to be valid TOML, so the scanner only has to find where keys and values begin and end.
"""

from __future__ import annotations

import contextlib
import re
import tomllib

from ddf.case.words import KeyPath

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR = re.compile(r"[^,\]}\s#]+(?: \d\d:[^,\]}\s#]+)?")
_STRING = re.compile(
    r'''"""(?:[^"\\]|\\.|"(?!""))*"{3,5}|'''
    r"'''(?:[^']|'(?!''))*'{3,5}|"
    r'"(?:[^"\\]|\\.)*"|'
    r"'[^']*'",
    re.DOTALL,
)
_BLANK = re.compile(r"(?:[ \t\r\n]+|#[^\n]*)*")
_INLINE_BLANK = re.compile(r"[ \t]*")


class Lines:
    """Where each key path of one file stands; lines count from 1."""

    def __init__(self, lines: dict[KeyPath, int] | None = None) -> None:
        self.lines = lines or {}

    def at(self, path: KeyPath) -> int:
        """Return the line of a key path, else of the nearest table that would hold it, else 1."""
        for cut in range(len(path), 0, -1):
            if path[:cut] in self.lines:
                return self.lines[path[:cut]]
        return 1


def locate(text: str) -> Lines:
    """Return the lines of every key path, table and list item of a valid TOML text.

    Where a text is beyond the scanner (tables nested too deep), the lines found so far are returned.
    """
    scanner = _Scanner(text)
    with contextlib.suppress(IndexError, RecursionError, ValueError):
        scanner.document()
    return Lines(scanner.lines)


class _Scanner:
    """One pass over the text: `at` is the position, `table` the key path of the current header."""

    def __init__(self, text: str) -> None:
        self.text = text.removeprefix("\ufeff").replace("\r\n", "\n")
        self.at = 0
        self.line = 1
        self.counted = 0
        self.table: KeyPath = ()
        self.lines: dict[KeyPath, int] = {}
        self.array_tables: dict[KeyPath, int] = {}

    def document(self) -> None:
        self._skip(_BLANK)
        while self.at < len(self.text):
            if self.text[self.at] == "[":
                self._header()
            else:
                self._pair(self.table)
            self._skip(_BLANK)

    def _here(self) -> int:
        """Return the line of the position, counting on from the last one asked for."""
        self.line += self.text.count("\n", self.counted, self.at)
        self.counted = self.at
        return self.line

    def _skip(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self.text, self.at)
        if match is None or (match.end() == self.at and pattern not in (_BLANK, _INLINE_BLANK)):
            raise IndexError("not the TOML that was expected")
        self.at = match.end()
        return match.group()

    def _mark(self, path: KeyPath, line: int) -> None:
        self.lines.setdefault(path, line)

    def _header(self) -> None:
        line = self._here()
        is_array = self.text.startswith("[[", self.at)
        self.at += 2 if is_array else 1
        keys = self._keys()
        self.at += 2 if is_array else 1
        path: KeyPath = ()
        for place, key in enumerate(keys):
            path = (*path, key)
            self._mark(path, line)
            last = place == len(keys) - 1
            if last and is_array:
                self.array_tables[path] = self.array_tables.get(path, -1) + 1
            if path in self.array_tables:
                path = (*path, self.array_tables[path])
                self._mark(path, line)
        self.table = path

    def _keys(self) -> list[str]:
        """Read a dotted key and the blanks around it."""
        keys = []
        while True:
            self._skip(_INLINE_BLANK)
            if self.text[self.at] in "\"'":
                keys.append(next(iter(tomllib.loads(self._skip(_STRING) + " = 0"))))
            else:
                keys.append(self._skip(_BARE))
            self._skip(_INLINE_BLANK)
            if self.text[self.at] != ".":
                return keys
            self.at += 1

    def _pair(self, table: KeyPath) -> None:
        line = self._here()
        path = table
        for key in self._keys():
            path = (*path, key)
            self._mark(path, line)
        self.at += 1  # the equals sign
        self._skip(_INLINE_BLANK)
        self._value(path)

    def _value(self, path: KeyPath) -> None:
        first = self.text[self.at]
        if first in "\"'":
            self._skip(_STRING)
        elif first == "[":
            self._list(path)
        elif first == "{":
            self._inline_table(path)
        else:
            self._skip(_SCALAR)

    def _list(self, path: KeyPath) -> None:
        self.at += 1
        place = 0
        self._skip(_BLANK)
        while self.text[self.at] != "]":
            self._mark((*path, place), self._here())
            self._value((*path, place))
            place += 1
            self._skip(_BLANK)
            if self.text[self.at] == ",":
                self.at += 1
                self._skip(_BLANK)
        self.at += 1

    def _inline_table(self, path: KeyPath) -> None:
        self.at += 1
        self._skip(_BLANK)
        while self.text[self.at] != "}":
            self._pair(path)
            self._skip(_BLANK)
            if self.text[self.at] == ",":
                self.at += 1
                self._skip(_BLANK)
        self.at += 1
