"""The texts of a run while it lives: results.texts.rows beside results.rows, of which any prefix reads.

A line of JSON says what the variables are; each line below has a row and the texts of all variables from it
on. A text is written before the row that has it, so that no row is on the disk without its texts. The file is
removed with results.rows.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from ..errors import ConfigError
from ..shortage import reason
from ..writing import create
from .manifest import described, from_json, manifest_text, variables_in
from .text_table import Change, TextTable
from .variable import ResultVariable

TEXT_ROWS_NAME = "results.texts.rows"
_FORMAT = "evcosim texts 1"


class TextRows:
    """A file at `path` of the texts of some variables, which is made at the first `save`.

    `since` returns the rows from a number on that were noted, each with its texts.
    """

    def __init__(
        self,
        path: Path,
        variables: Sequence[ResultVariable],
        since: Callable[[int], Sequence[Change]],
    ) -> None:
        self._path, self._variables, self._since = path, tuple(variables), since
        self._count = self._size = 0  # of what stands in the file: rows, bytes

    def beside(self, path: Path) -> TextRows:
        """Return another file of the same texts, from the first on."""
        return TextRows(path, self._variables, self._since)

    def go_on(self, count: int) -> None:
        """Go on with a file that has so many rows, and maybe half of another one. Raises OSError."""
        self._count, self._size = count, self._path.read_bytes().rfind(b"\n") + 1

    def save(self) -> None:
        """Append the rows that were noted since the last time. Raises OSError where the disk refuses."""
        if self._count and not self._path.exists():  # somebody removed it
            self._count = self._size = 0
        changes = self._since(self._count)
        if not changes:
            return
        if not self._size:
            self._size = _make(self._path, self._variables)
        lines = b"".join(json.dumps([row, *texts]).encode() + b"\n" for row, texts in changes)
        with self._path.open("r+b") as file:
            file.truncate(self._size)  # what stands behind is of a call that failed
            file.seek(self._size)
            file.write(lines)
        self._count += len(changes)
        self._size += len(lines)


def complete_texts(path: Path, table: TextTable) -> bool:
    """Write the texts of a run that its file does not have; return False where the disk refuses.

    Raises ConfigError where what is there holds no texts.
    """
    written = read_text_rows(path, sys.maxsize).changes
    if len(written) < len(table.changes):
        rows = TextRows(path, table.variables, lambda first: table.changes[first:])
        try:
            if path.exists():
                rows.go_on(len(written))
            rows.save()
        except OSError:
            return False
    return True


def _make(path: Path, variables: Sequence[ResultVariable]) -> int:
    """Make a file without rows, and return its bytes. Raises OSError; then there is none."""
    about = {"format": _FORMAT, "variables": [described(v) for v in variables]}
    begin = manifest_text(about, indent=None) + b"\n"
    with create(path) as file:
        try:
            file.write(begin)
            file.flush()
        except OSError:
            path.unlink()
            raise
    return len(begin)


def read_text_rows(path: Path, count: int) -> TextTable:
    """Read the texts of `count` rows, whatever stands behind them; an empty table where there is no file.

    Raises ConfigError naming a file that cannot be read, and line and rule of one that does not hold texts.
    """
    if not path.is_file():
        return TextTable()
    try:
        lines = path.read_bytes().split(b"\n")[:-1]  # half a line at the end counts for nothing
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {reason(error)}") from error
    variables = _variables(path, lines[0]) if lines else []
    changes: list[Change] = []
    for number, line in enumerate(lines[1:], 2):
        row, texts = _change(path, number, line, len(variables))
        if changes and row <= changes[-1][0]:
            raise ConfigError(f"{path}: line {number}: row {row} comes after row {changes[-1][0]}")
        if row >= count:
            break
        changes.append((row, texts))
    return TextTable(variables, changes)


def _variables(path: Path, line: bytes) -> list[ResultVariable]:
    """Return the variables that the first line describes."""
    try:
        about = from_json(line)
    except ValueError:
        about = None
    if not isinstance(about, dict) or about.get("format") != _FORMAT:
        raise ConfigError(f"{path}: does not begin as a file of texts ({_FORMAT})")
    return list(variables_in(about.get("variables", []), path).values())


def _change(path: Path, number: int, line: bytes, width: int) -> Change:
    """Return the row and the texts of a line."""
    try:
        row, *texts = from_json(line)
    except (ValueError, TypeError) as error:
        raise ConfigError(f"{path}: line {number}: is no row with texts: {error}") from error
    whole = isinstance(row, int) and not isinstance(row, bool) and row >= 0
    if not whole or len(texts) != width or not all(isinstance(text, str) for text in texts):
        raise ConfigError(f"{path}: line {number}: needs a row, then {width} texts")
    return row, tuple(texts)
