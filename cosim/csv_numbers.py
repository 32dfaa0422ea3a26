"""Numbers in CSV files: a header with the names of the columns, and in each line below a value for each.

`csv_text` says how a file may be written. Double quotes may stand around a value, or around a name that holds
separators or line ends. Lines without any value count for nothing, and so do separators at the end of a line,
behind which there is nothing, as spreadsheets and loggers write both. A file of numbers alone is read by
numpy. Any other one is read line by line: one of which few columns are wanted, one with decimal commas or a
column of texts, and one with a mistake, whose place is found so. Beside the numbers, no more than a few lines
are in memory.
"""

from __future__ import annotations

import array
import contextlib
import csv
import dataclasses
import itertools
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from .csv_text import (
    Comments,
    CutRow,
    cut_row,
    encoding_of,
    filled,
    is_date,
    named_as_time,
    number_in,
    opened,
    quoted_name,
    read_header,
    time_column,
)
from .errors import ConfigError, counted
from .row_store import Array
from .shortage import reason

_NUMPY_PAYS = 3  # numpy reads the numbers of all columns: faster where a third or more of them is wanted
_TRUTHS = {"true": 1.0, "false": 0.0}


@dataclasses.dataclass(frozen=True)
class CsvFile:
    """A CSV file of which the header was read: the `names` of its columns, and the lines up to its end.

    A column may have no name: "".
    """

    path: Path
    names: tuple[str, ...]
    header_lines: int
    encoding: str = "utf-8"
    separator: str = ","

    @classmethod
    def of(cls, path: Path) -> CsvFile:
        """Read the header of a file: no names where the file is empty.

        Raises ConfigError naming the file where it cannot be read, is no text, does not close a quote, or has
        numbers in place of names.
        """
        encoding = encoding_of(path)
        names, lines, separator = read_header(path, encoding)
        return cls(path, names, lines, encoding, separator)

    @property
    def named(self) -> tuple[str, ...]:
        """The names of the columns that have one."""
        return tuple(filter(None, self.names))

    def time_column(self) -> int:
        """Return the column of the time, by its name. Raises ConfigError where there is none, or several."""
        return time_column(self.names, f"{self.path}: line {self.header_lines}")

    def time_note(self) -> str:
        """Return a warning where another column has a name of the time too, with other numbers; "" if not.

        Raises ConfigError as `time_column` does, and as `numbers` for a line of another length.
        """
        taken = self.time_column()
        others = [j for j in named_as_time(self.names) if j != taken]
        for line, row in self.full_rows() if others else ():
            for j in others:
                time, other = (number_in(row[k], self.separator) for k in (taken, j))
                if time is not None and other is not None and time != other:
                    return (
                        f"{self._place(line, taken)}: {row[taken].strip()} is taken as the time, though "
                        f"column '{self.names[j]}' has another one, {row[j].strip()}"
                    )
        return ""

    def count_lines(self) -> int:
        """Return the number of lines below the header. Raises OSError."""
        return _count_lines(self.path) - self.header_lines

    def last_line_without_end(self) -> CutRow | None:
        """Return the last line where it does not end: it may be complete, or cut off. None: it ends.

        Raises ConfigError for a file as evcosim writes it, whose lines all end: one that does not was cut
        off, and that within its last number nobody could see. In any other file it was cut off where it ends
        with a decimal mark, within quotes, or without the separator with which the line above ends.
        """
        try:
            row = cut_row(self.path)
        except OSError as error:
            raise ConfigError(f"{self.path}: cannot be read: {reason(error)}") from error
        if row is None:
            return None
        if self._is_ours():
            more = ". 'evcosim results recover' leaves the line out of a run's folder"
        elif how := self._how_it_was_cut():
            more = f": its last value {how}"
        else:
            return row
        raise ConfigError(
            f"{self.path}: line {row.line}, the last, does not end: {row.text!r}; the file was cut off{more}"
            "; if nothing is missing, end the line"
        )

    def _how_it_was_cut(self) -> str:
        """Return how the last value of a file that does not end shows that it was cut; "" if it does not."""
        behind = "\0"  # in a row of its own, unless a quote above it is open
        last: list[str] = []
        before: list[str] = []
        with opened(self.path, self.encoding, self.header_lines) as file:
            for _, row in self._rows(itertools.chain(file, ("\n", behind))):
                if row == [behind]:
                    break
                if row:
                    last, before = row, last
            else:
                return "has no closing quote"
        if len(filled(self.names)) <= len(last) < len(before) and not any(before[len(last) :]):
            return f"lacks the '{self.separator}' behind it, which the line above has"
        text = last[-1].strip() if len(last) == len(self.names) else ""  # else its length is the mistake
        number = number_in(text, self.separator) is not None
        return "ends with its decimal mark" if number and text.endswith((".", ",")) else ""

    def _is_ours(self) -> bool:
        """Return True for a header as that of results: `time,unit.variable,...`."""
        if self.names[0] != "time" or not all("." in name for name in self.names[1:]):
            return False
        with opened(self.path, self.encoding) as lines:
            header = "".join(itertools.islice(lines, self.header_lines))
        return header.rstrip("\r\n") == ",".join(map(quoted_name, self.names))

    def numbers(self, columns: Sequence[int] | None = None, *, truths: Sequence[int] = ()) -> Array:
        """Return the numbers of some columns (default: of all), shape (n, len(columns)).

        In the columns `truths` true and false are 1 and 0. What stands in columns that are not wanted counts
        for nothing, but each line has as many values as the header has names. Raises ConfigError naming file,
        line, column and value of what is missing or is not a finite number.
        """
        wanted = range(len(self.names)) if columns is None else columns
        table = None
        if _NUMPY_PAYS * len(wanted) >= len(self.names):
            table = self._by_numpy(wanted)
        return self._line_by_line(wanted, truths) if table is None else table

    def texts(self, column: int) -> list[str]:
        """Return the texts of a column, without spaces around them.

        Raises ConfigError as `numbers` does for a line of another length.
        """
        return [row[column].strip() for _, row in self.full_rows()]

    def line_of(self, row: int) -> int:
        """Return the line of the file in which a row (0, 1, ...) ends."""
        return next(itertools.islice(self.full_rows(), row, None))[0]

    def _by_numpy(self, columns: Sequence[int]) -> Array | None:
        """Return the numbers as `numbers` does, shape (n, len(columns)), or None where a value is none."""
        with opened(self.path, self.encoding, self.header_lines) as file:
            table = _all_numbers(Comments().without(file), len(self.names), self.separator)
        if table is None:
            return None
        if columns != range(len(self.names)):
            table = table[:, list(columns)]
        return table if np.isfinite(table).all() else None

    def _line_by_line(self, columns: Sequence[int], truths: Sequence[int] = ()) -> Array:
        """Return the numbers, shape (n, len(columns)). Raises ConfigError for the file's first mistake."""
        found = array.array("d")
        marks: dict[str, str] = {}
        for line, row in self.full_rows():
            for j in columns:
                text = row[j]
                if self.separator != ",":
                    self._check_mark(text, line, j, marks)
                value = number_in(text, self.separator)
                if value is None and j in truths:
                    value = _TRUTHS.get(text.strip().lower())
                found.append(self._no_number(text, line, j) if value is None else value)
        return np.asarray(found, dtype=np.float64).reshape(-1, len(columns))

    def full_rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the rows that have a value, with the line that each ends in; each as long as the header."""
        with opened(self.path, self.encoding, self.header_lines) as file:
            for line, row in self._rows(file):
                if any(map(str.strip, row)):
                    yield line, self._full(line, row)

    def _full(self, line: int, row: list[str]) -> list[str]:
        """Return a row as long as the header. Raises ConfigError for one of another number of values."""
        count = len(self.names)
        if len(row) == count:
            return row
        if len(filled(row)) > count or len(row) < len(filled(self.names)):
            raise self._wrong_length(line, len(row))
        return [*row, *[""] * (count - len(row))][:count]

    def _rows(self, file: Iterable[str]) -> Iterator[tuple[int, list[str]]]:
        """Yield the values of each row with the line that it ends in."""
        comments = Comments()
        reader = csv.reader(comments.without(file), delimiter=self.separator, skipinitialspace=True)
        try:
            for row in reader:
                yield self.header_lines + comments.count + reader.line_num, row
        except csv.Error as error:
            line = self.header_lines + comments.count + reader.line_num
            raise ConfigError(f"{self.path}: line {line}: is not well-formed CSV: {error}") from error

    def _check_mark(self, text: str, line: int, column: int, marks: dict[str, str]) -> None:
        """Note the decimal mark of a number in `marks`. Raises ConfigError where another one came before."""
        for mark, other in ((",", "."), (".", ",")):
            if mark in text and number_in(text, self.separator) is not None:
                marks.setdefault(mark, text.strip())
                if other in marks:
                    raise ConfigError(
                        f"{self._place(line, column)}: {text.strip()!r} has '{mark}' as its decimal mark, "
                        f"and {marks[other]!r} above has '{other}'"
                    )

    def _place(self, line: int, column: int) -> str:
        return f"{self.path}: line {line}, column '{self.names[column]}'"

    def _wrong_length(self, line: int, count: int) -> ConfigError:
        """Return the error for a line that has another number of values than the header."""
        values = counted(count, "value")
        return ConfigError(f"{self.path}: line {line} has {values}, the header has {len(self.names)} columns")

    def _no_number(self, text: str, line: int, column: int) -> float:
        """Raise ConfigError naming the place of a cell that has no number."""
        place = self._place(line, column)
        if not text.strip():
            raise ConfigError(f"{place}: the value is missing")
        kind = "a number"
        with contextlib.suppress(ValueError):
            float(text)
            kind = "a finite number"  # it is nan, infinite, or has '_' among its digits
        if is_date(text):
            kind = "a number but a date or a time of day: times are in s, best from the start of the run on"
        raise ConfigError(f"{place}: {text.strip()!r} is not {kind}")


def _all_numbers(file: Iterator[str], columns: int, separator: str) -> Array | None:
    """Return the rest of a file, shape (n, columns), or None where it is something else."""
    first = next((line for line in file if line.strip("\r\n")), None)
    if first is None:
        return np.empty((0, columns))
    try:
        lines = itertools.chain([first], file)
        table = np.loadtxt(lines, delimiter=separator, comments=None, quotechar='"', ndmin=2)
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
