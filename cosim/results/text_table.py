"""The texts of a run: a table beside the numbers, of the rows in which a text differs from the row before.

It is the file results.texts.csv beside results.csv: the header `"time","unit.variable",...`, then a line for
each such row. All but the times stand in double quotes. Beside another file, x.csv, it is x.texts.csv; a file
of that name which does not begin so is somebody's own, and stays as it is.
"""

from __future__ import annotations

import contextlib
import csv
import io
import math
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..csv_text import both, cut_row
from ..errors import ConfigError
from ..row_store import Array
from ..shortage import reason
from ..writing import replacing
from .variable import ResultVariable

Change = tuple[int, tuple[str, ...]]
"""A row and the texts of all variables from it on."""

_BEGIN = b'"time",'
_OF_A_RUN = "results.texts.csv"
_SHOWN = 60  # characters of a text in a line
_LONGEST = 2**31 - 1  # characters: the csv module counts them in a C long


class TextTable:
    """The texts of n rows of some variables of type String.

    `changes` are pairs of a row and the texts of all variables from it on, in order of the rows; the first is
    row 0 where there is any row.
    """

    def __init__(
        self, variables: Sequence[ResultVariable] = (), changes: Sequence[tuple[int, tuple[str, ...]]] = ()
    ) -> None:
        self.variables, self.changes = tuple(variables), tuple(changes)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the variables."""
        return tuple(v.name for v in self.variables)

    def column(self, name: str, count: int) -> NDArray[np.object_]:
        """Return the texts of a variable in the first `count` rows, shape (count,)."""
        j = self.names.index(name)
        found = np.full(count, "", dtype=object)
        ends = [row for row, _ in self.changes[1:]]
        for (row, texts), end in zip(self.changes, [*ends, count], strict=False):
            found[row:end] = texts[j]
        return found

    def final(self) -> tuple[str, ...]:
        """Return the last text of each variable; nothing without a row."""
        return self.changes[-1][1] if self.changes else ()

    def part(self, rows: NDArray[np.bool_] | slice, names: Sequence[str], count: int) -> TextTable:
        """Return the table of some variables and some of the first `count` rows.

        `rows` is a slice, or a choice of shape (count,).
        """
        if not names:
            return TextTable()
        places = [self.names.index(name) for name in names]
        begins = np.array([row for row, _ in self.changes], dtype=np.int64)
        valid = np.searchsorted(begins, np.arange(count)[rows], side="right") - 1
        changes: list[Change] = []
        for k in np.flatnonzero(np.diff(valid, prepend=-1)).tolist():
            texts = tuple(self.changes[valid[k]][1][j] for j in places)
            if not changes or changes[-1][1] != texts:
                changes.append((k, texts))
        return TextTable([self.variables[j] for j in places], changes)


def shown_text(text: str) -> str:
    """Return a text in quotes, without characters that steer a terminal, cut where it is long."""
    shown = repr(text)
    return shown if len(shown) <= _SHOWN else f"{shown[: _SHOWN - 3]}..."


def texts_path(path: Path) -> Path:
    """Return the path of the texts that stand beside a file of results."""
    return path.with_name(f"{path.stem}.texts.csv")


def write_texts(path: Path, table: TextTable, times: Array) -> None:
    """Write the table beside a file of results with `times` [s], shape (n,); without texts, remove the file.

    Raises ConfigError where the disk refuses, and where a file that is no table of texts would be replaced.
    """
    beside = texts_path(path)
    ours = _is_table(beside)
    if not table.variables and not ours:
        return
    if not ours and beside.exists():
        raise ConfigError(
            f"{beside}: the texts of {path.name} go there, and the file that is there holds no texts of "
            "results; choose another name"
        )
    if not table.variables:
        try:
            beside.unlink(missing_ok=True)
        except OSError as error:
            raise ConfigError(
                f"{beside}: is of other results and cannot be removed: {error.strerror}"
            ) from error
        return
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    writer.writerow(["time", *table.names])
    writer.writerows([float(times[row]), *texts] for row, texts in table.changes if row < len(times))
    with replacing(beside) as file:
        file.write(text.getvalue().encode())


def read_texts(path: Path, times: Array, names: Sequence[str] = ()) -> TextTable:
    """Read the table beside a file of results with `times` [s], shape (n,); an empty one where there is none.

    What comes after the last time is left out: the results may have been cut off. Raises ConfigError naming
    file and line of any other time that the results do not have, and for a name that stands twice in the
    header or is among the `names` of the results' numbers.
    """
    beside = texts_path(path)
    if not _is_table(beside):
        return TextTable()
    lines: list[int] = []
    try:
        with _texts_of_any_length(), beside.open(encoding="utf-8", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = next(reader, ["time"])
            rows = []
            for cells in reader:
                rows.append(cells)
                lines.append(reader.line_num)
        cut = cut_row(beside)
    except OSError as error:
        raise ConfigError(f"{beside}: cannot be read: {reason(error)}") from error
    except (csv.Error, UnicodeDecodeError) as error:
        raise ConfigError(f"{beside}: is no table of texts: {error}") from error
    if cut is not None:
        raise ConfigError(
            f"{beside}: line {cut.line}, the last, does not end: {cut.text!r}; the file was cut off; if "
            "nothing is missing, end the line"
        )
    _check_names(header, [*names], beside)
    variables = [ResultVariable(name, type="String", variability="discrete") for name in header[1:]]
    changes: list[Change] = []
    for line, cells in zip(lines, rows, strict=True):
        row = _row_of(cells, len(header), times)
        if row == len(times):
            break
        if row is None or (changes and row <= changes[-1][0]):
            raise ConfigError(
                f"{beside}: line {line}: {cells[0] if cells else ''!r} begins no row of {path.name}: the two "
                "are not of one run"
            )
        changes.append((row, tuple(cells[1:])))
    return TextTable(variables, changes)


def _check_names(header: Sequence[str], names: Sequence[str], beside: Path) -> None:
    for j, name in enumerate(header):
        if name in header[:j]:
            raise ConfigError(
                f"{beside}: line 1: {both(header, [header.index(name), j])} both have this name"
            )
        if name in names:
            raise ConfigError(f"{beside}: line 1, column {j + 1}: {name!r} has numbers in the results")


def _is_table(path: Path) -> bool:
    """Return True for a file that holds the texts of results."""
    if path.name == _OF_A_RUN:
        return path.is_file()
    try:
        with path.open("rb") as file:
            return file.read(len(_BEGIN)) == _BEGIN
    except OSError:
        return False


_limit = threading.Lock()


@contextlib.contextmanager
def _texts_of_any_length() -> Iterator[None]:
    """Lift the limit of 128 KiB for a cell, which the csv module has for the whole process."""
    with _limit:
        before = csv.field_size_limit(_LONGEST)
        try:
            yield
        finally:
            csv.field_size_limit(before)


def _row_of(cells: list[str], width: int, times: Array) -> int | None:
    """Return the row of the results at the time of a line with `width` cells; None: there is none.

    Behind the last time it is len(times).
    """
    try:
        time = float(cells[0]) if len(cells) == width else math.nan
    except ValueError:
        return None
    row = int(np.searchsorted(times, time))
    return row if math.isfinite(time) and (row == len(times) or times[row] == time) else None
