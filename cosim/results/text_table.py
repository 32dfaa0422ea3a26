"""The texts of a run: a table beside the numbers, of the rows in which a text differs from the row before.

It is the file results.texts.csv beside results.csv: the header `time,unit.variable,...`, then a line for
each such row.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import ConfigError
from ..row_store import Array
from ..writing import replacing
from .variable import ResultVariable


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
        for row, texts in self.changes:
            found[row:] = texts[j]
        return found


def texts_path(path: Path) -> Path:
    """Return the path of the texts that stand beside a file of results."""
    return path.with_name(f"{path.stem}.texts.csv")


def write_texts(path: Path, table: TextTable, times: Array) -> None:
    """Write the table beside a file of results with `times` [s], shape (n,); without texts, remove the file.

    Raises ConfigError where the disk refuses.
    """
    beside = texts_path(path)
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


def read_texts(path: Path, times: Array) -> TextTable:
    """Read the table beside a file of results with `times` [s], shape (n,); an empty one where there is none.

    Raises ConfigError naming file and line of a time that the results do not have.
    """
    beside = texts_path(path)
    if not beside.is_file():
        return TextTable()
    lines: list[int] = []
    try:
        with beside.open(encoding="utf-8", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = next(reader, ["time"])
            rows = []
            for cells in reader:
                rows.append(cells)
                lines.append(reader.line_num)
    except OSError as error:
        raise ConfigError(f"{beside}: cannot be read: {error.strerror or error}") from error
    except (csv.Error, UnicodeDecodeError) as error:
        raise ConfigError(f"{beside}: is no table of texts: {error}") from error
    variables = [ResultVariable(name, type="String", variability="discrete") for name in header[1:]]
    changes: list[tuple[int, tuple[str, ...]]] = []
    for line, cells in zip(lines, rows, strict=True):
        row = _row_of(cells, len(header), times)
        if row is None or (changes and row <= changes[-1][0]):
            raise ConfigError(
                f"{beside}: line {line}: {cells[0] if cells else ''!r} begins no row of {path.name}: the two "
                "are not of one run"
            )
        changes.append((row, tuple(cells[1:])))
    return TextTable(variables, changes)


def _row_of(cells: list[str], width: int, times: Array) -> int | None:
    """Return the row of the results at the time of a line with `width` cells; None: there is none."""
    try:
        time = float(cells[0]) if len(cells) == width else math.nan
    except ValueError:
        return None
    row = int(np.searchsorted(times, time))
    return row if row < len(times) and times[row] == time else None
