"""Numbers in CSV files: a header with the names of the columns, and in each line below a value for each.

Values are separated by ','; double quotes may stand around a value, or around a name that holds commas or
line ends; a byte order mark counts for nothing. A file of numbers alone is read by numpy. Any other one is
read line by line: one of which few columns are wanted, one with a column of texts, and one with a mistake,
whose place is found so. Beside the numbers, no more than a few lines are in memory.
"""

from __future__ import annotations

import array
import contextlib
import csv
import dataclasses
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from .errors import ConfigError, counted
from .row_store import Array

_NUMPY_PAYS = 3  # numpy reads the numbers of all columns: faster where a third or more of them is wanted


@dataclasses.dataclass(frozen=True)
class CsvFile:
    """A CSV file of which the header was read: the `names` of its columns, and how many lines they take."""

    path: Path
    names: tuple[str, ...]
    header_lines: int

    @classmethod
    def of(cls, path: Path) -> CsvFile:
        """Read the header of a file: no names where the file is empty or begins with an empty line.

        Raises ConfigError naming the file where it cannot be read, is not UTF-8 text, does not close a quote,
        separates its columns by ';', or has numbers in place of names.
        """
        lines: list[str] = []
        with _opened(path) as file:
            reader = csv.reader(_noted(file, lines), skipinitialspace=True)
            try:
                names = tuple(name.strip() for name in next(reader, []))
            except csv.Error as error:
                raise ConfigError(f"{path}: line 1: is not well-formed CSV: {error}") from error
            all_taken = len(lines) > 1 and next(file, None) is None
        if all_taken and "".join(lines).count('"') % 2:
            raise ConfigError(f"{path}: line 1: a quote of the header is not closed: {lines[0].strip()!r}")
        if len(names) == 1 and ";" in names[0]:
            raise ConfigError(f"{path}: line 1: columns are separated by ',', not by ';': {names[0]!r}")
        if names and all(_finite(name) is not None for name in names):
            shown = ",".join(names)
            raise ConfigError(f"{path}: line 1: a header with names is needed, not numbers: {shown!r}")
        return cls(path, names, len(lines))

    def numbers(self, columns: Sequence[int] | None = None, *, empty_lines: bool = False) -> Array:
        """Return the numbers of some columns (default: of all), shape (n, len(columns)).

        What stands in the other columns counts for nothing, but each line has as many values as the header.
        Empty lines at the end are passed over; with `empty_lines`, those above are too. Raises ConfigError
        naming file, line, column and value of what is missing or is not a finite number.
        """
        wanted = range(len(self.names)) if columns is None else columns
        table = None
        if _NUMPY_PAYS * len(wanted) >= len(self.names):
            table = self._by_numpy(wanted, empty_lines)
        return self._line_by_line(wanted, empty_lines) if table is None else table

    def _by_numpy(self, columns: Sequence[int], empty_lines: bool) -> Array | None:
        """Return the numbers as `numbers` does, shape (n, len(columns)), or None where a value is none."""
        with _opened(self.path, self.header_lines) as file:
            table = _all_numbers(file, len(self.names))
        if table is None:
            return None
        if columns != range(len(self.names)):
            table = table[:, list(columns)]
        if not np.isfinite(table).all():
            return None
        if not empty_lines and _count_lines(self.path) != self.header_lines + len(table):
            return None  # numpy passes over empty lines without a word
        return table

    def _line_by_line(self, columns: Sequence[int], empty_lines: bool) -> Array:
        """Return the numbers, shape (n, len(columns)). Raises ConfigError for the file's first mistake."""
        found = array.array("d")
        empty = 0  # the first empty line
        with _opened(self.path, self.header_lines) as file:
            for line, row in self._rows(file):
                if not row:
                    empty = empty or line
                    continue
                if empty and not empty_lines:
                    raise self._wrong_length(empty, 0)
                if len(row) != len(self.names):
                    raise self._wrong_length(line, len(row))
                found.extend(self._number(row[j], line, self.names[j]) for j in columns)
        return np.asarray(found, dtype=np.float64).reshape(-1, len(columns))

    def _rows(self, file: TextIO) -> Iterator[tuple[int, list[str]]]:
        """Yield the values of each row with the line that it ends in."""
        reader = csv.reader(file)
        try:
            for row in reader:
                yield self.header_lines + reader.line_num, row
        except csv.Error as error:
            line = self.header_lines + reader.line_num
            raise ConfigError(f"{self.path}: line {line}: is not well-formed CSV: {error}") from error

    def _wrong_length(self, line: int, count: int) -> ConfigError:
        """Return the error for a line that has another number of values than the header."""
        values = counted(count, "value")
        return ConfigError(f"{self.path}: line {line} has {values}, the header has {len(self.names)} columns")

    def _number(self, text: str, line: int, name: str) -> float:
        """Return the number of a cell. Raises ConfigError naming its place where it has none."""
        value = _finite(text)
        if value is not None:
            return value
        place = f"{self.path}: line {line}, column '{name}'"
        if not text.strip():
            raise ConfigError(f"{place}: the value is missing")
        kind = "a number"
        with contextlib.suppress(ValueError):
            float(text)
            kind = "a finite number"  # it is nan, infinite, or has '_' among its digits
        raise ConfigError(f"{place}: {text.strip()!r} is not {kind}")


@contextlib.contextmanager
def _opened(path: Path, skipped: int = 0) -> Iterator[TextIO]:
    """Open a file and pass over its first `skipped` lines.

    Raises ConfigError naming it where it cannot be read or is not UTF-8 text, within the `with` block too.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            for _ in range(skipped):
                file.readline()
            yield file
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: {error.reason} at byte {error.start}") from error


def _noted(lines: Iterable[str], taken: list[str]) -> Iterator[str]:
    """Yield lines, each of which is appended to `taken`."""
    for line in lines:
        taken.append(line)
        yield line


def _all_numbers(file: TextIO, columns: int) -> Array | None:
    """Return the rest of a file, shape (n, columns), or None where it is something else."""
    first = next((line for line in file if line.strip("\r\n")), None)
    if first is None:
        return np.empty((0, columns))
    try:
        lines = itertools.chain([first], file)
        table = np.loadtxt(lines, delimiter=",", comments=None, quotechar='"', ndmin=2)
    except ValueError:
        return None
    return table if table.shape[1] == columns else None


def _count_lines(path: Path) -> int:
    """Return the number of lines of a file, without empty ones at its end."""
    count = 0
    tail = b""
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            count += block.count(b"\n")
            tail = (tail + block)[-4096:]
    empty = len(tail) - len(tail.rstrip(b"\r\n"))
    return count - tail[len(tail) - empty :].count(b"\n") + 1


def _finite(text: str) -> float | None:
    """Return the number that a text is, or None: for other texts, NaN, infinity, and '_' among digits."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None
