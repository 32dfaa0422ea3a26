"""Results as CSV: the header `time,unit.variable,...`, then a line for each communication point.

Lines end in '\\n'. A Real is written as the shortest decimal that reads back as the same bits; Integer,
Boolean (0, 1) and Enumeration as integers. Units of measure, types, texts and the manifest have no place in
it.
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...clock import LATEST
from ...csv_numbers import CsvFile
from ...csv_text import both, check_seconds, number_in, quoted_name
from ...csv_thousands import thousands_note
from ...errors import ConfigError
from ...row_store import Array
from ..recording import Recording
from ..variable import ResultVariable
from .format import Contents

_ROWS = 4096  # formatted at a time: 40 columns of text then take about 10 MB


def write(recording: Recording, file: BinaryIO) -> None:
    """Write all rows. Raises OSError where the disk refuses."""
    kinds = [v.type for v in recording.variables]
    file.write((",".join(["time", *map(quoted_name, recording.names)]) + "\n").encode())
    for time, values in recording.pieces(recording.names, rows=_ROWS):
        columns = [list(map(repr, time.tolist()))]
        columns += [_texts(values[:, j], kind) for j, kind in enumerate(kinds)]
        file.write(("\n".join(map(",".join, zip(*columns, strict=True))) + "\n").encode())


def _texts(values: Array, kind: str) -> list[str]:
    """Return the texts of a column of values, shape (n,), each stretch of equal ones formatted once."""
    bits = values.view(np.int64)  # as bits, -0.0 differs from 0.0 and NaN equals itself
    starts = np.concatenate(([0], np.flatnonzero(bits[1:] != bits[:-1]) + 1))
    distinct = values[starts]
    if kind != "Real" and np.isfinite(distinct).all() and np.array_equal(distinct, np.rint(distinct)):
        texts = list(map(str, map(int, distinct.tolist())))  # an int64 would not hold a large UInt64
    else:
        texts = list(map(repr, distinct.tolist()))
    if len(starts) == len(values):
        return texts
    lengths = np.diff(starts, append=len(values)).tolist()
    return [text for text, length in zip(texts, lengths, strict=True) for _ in range(length)]


def read(path: Path) -> Contents:
    """Read any CSV file of finite numbers of which a column is the time [s], by its name.

    Its variables, in the order of the other columns, are Reals without a unit of measure; true is 1 and
    false is 0. A column without a name is left out where it is empty, or is the first and names the rows. The
    last line of another tool's file need not end, if it is complete; one with a header as `write` makes it
    was cut off then, maybe within its last number. Numbers and times that can be read two ways are warnings
    in the manifest. Raises ConfigError naming file, line, column and value of what is missing, is no finite
    number, or is a time before the one above it or beyond any run.
    """
    file = CsvFile.of(path)
    time = _time_column(file)
    row = file.last_line_without_end()
    named = [j for j, name in enumerate(file.names) if name]
    others = [j for j in named if j != time]
    try:
        table = file.numbers(None if len(named) == len(file.names) else named, truths=others)
        _check_unnamed(file)
    except ConfigError as error:
        if row is None or not str(error).startswith(f"{path}: line {row.line}"):
            raise
        raise ConfigError(f"{error}; the line, the last, does not end: the file was cut off") from error
    place = named.index(time)
    times = table[:, place]
    backward = np.flatnonzero(times[1:] < times[:-1])
    if len(backward):
        k = int(backward[0])
        raise ConfigError(
            f"{path}: line {file.line_of(k + 1)}, column '{file.names[time]}': {float(times[k + 1])!r} "
            f"comes after {float(times[k])!r}; time must not decrease"
        )
    for k in (0, len(times) - 1) if len(times) else ():
        if abs(times[k]) > LATEST:  # only then the file is read again for the line
            check_seconds(float(times[k]), f"{path}: line {file.line_of(k)}, column '{file.names[time]}'")
    variables = [ResultVariable(file.names[j]) for j in others]
    notes = [note for note in (thousands_note(file, named), file.time_note()) if note]
    data = table[:, 1:] if place == 0 else np.delete(table, place, axis=1)
    return Contents(times, data, variables, {"warnings": notes} if notes else {})


def _time_column(file: CsvFile) -> int:
    """Return the column of the time. Raises ConfigError where a column has another one's name."""
    names = file.names
    if not file.named:
        raise ConfigError(f"{file.path}: line 1: a header with the names of the columns is needed")
    for j, name in enumerate(names):
        if name and name in names[:j]:
            found = both(names, [names.index(name), j])
            raise ConfigError(f"{file.path}: line {file.header_lines}: {found} both have this name")
    return file.time_column()


def _check_unnamed(file: CsvFile) -> None:
    """Raise ConfigError for a column without a name that holds something, other than the names of rows."""
    for j, name in enumerate(file.names):
        texts = [] if name else file.texts(j)
        if any(texts) and not (j == 0 and _are_row_names(file, texts)):
            raise ConfigError(f"{file.path}: line {file.header_lines}, column {j + 1}: a name is needed")


def _are_row_names(file: CsvFile, texts: list[str]) -> bool:
    """Return True for the texts of the column of names of rows that pandas and R write first.

    Each row has a whole number of its own, or a text: those that are left of a longer table keep theirs.
    """
    numbers = [number_in(text, file.separator) for text in texts]
    kept = all(text.isdecimal() for text in texts) or all(n is None for n in numbers)
    return kept and all(texts) and len(set(texts)) == len(texts)
