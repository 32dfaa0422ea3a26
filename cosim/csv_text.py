"""The text of CSV files as people, spreadsheets and tools write it: encoding, comments, separator, header.

Text is UTF-8, UTF-16 as Excel writes it, or else Windows-1252. Values are separated by ',', ';' or a tab: the
header says by which. A line that begins with '#' is a comment, and empty lines above the header count for
nothing. The header is the first line, or, where that has numbers, the comment right above it, as numpy writes
it. A first line `sep=;`, as Excel knows it, names the separator.
"""

from __future__ import annotations

import codecs
import contextlib
import csv
import itertools
import math
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple, TextIO

from .clock import LATEST
from .errors import ConfigError, counted
from .reading import LARGEST, require_file
from .shortage import reason

SEPARATORS = (";", "\t", ",")
"""In the order in which they are tried: a ';' or a tab that stands in each line is no part of a name."""

_BLOCK = 1 << 20
_SHOWN = 60  # bytes of a line
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # it begins as that of UTF-16 does
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_TIME = re.compile(r"(time|t|timestamps?|zeit)\s*(?:[\[(/_,]?\s*(s|sec|seconds?)\s*[\])]?)?", re.IGNORECASE)


class Header(NamedTuple):
    """The names of the columns, the lines of the file up to their end, and the separator of values."""

    names: tuple[str, ...]
    lines: int
    separator: str


class Comments:
    """Counts the comments that it takes out of lines."""

    def __init__(self) -> None:
        self.count = 0

    def without(self, lines: Iterable[str]) -> Iterator[str]:
        """Yield the lines that are no comments: a line within a quoted text is none."""
        quoted = False
        for line in lines:
            if "#" in line and not quoted and line.lstrip().startswith("#"):
                self.count += 1
                continue
            if '"' in line:
                quoted ^= line.count('"') % 2 == 1
            yield line


def encoding_of(path: Path) -> str:
    """Return Python's name of the encoding of a file.

    Raises ConfigError for one that cannot be read, begins with zeros, or whose first line has no end.
    """
    size = require_file(path).st_size
    try:
        with path.open("rb") as file:
            first = file.read(4)
            if first.count(0) > 2:
                raise ConfigError(f"{path}: is no text: it begins with bytes of 0")
            line = file.readline(LARGEST) if size > LARGEST else b"\n"
            if not line.endswith(b"\n") and b"\r" not in line:
                raise ConfigError(f"{path}: line 1 has more than {LARGEST} bytes, which are read at most")
            for mark, name in _MARKS:
                if first.startswith(mark):
                    return name
            if len(first) >= 2 and 0 in first[:2]:  # UTF-16 without a mark: a letter has one byte of 0
                return "utf-16-le" if first[1] == 0 else "utf-16-be"
            file.seek(0)
            return _of_bytes(path, iter(lambda: file.read(_BLOCK), b""))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {reason(error)}") from error


def _of_bytes(path: Path, blocks: Iterable[bytes]) -> str:
    """Return utf-8 where the bytes are UTF-8, else cp1252.

    Raises ConfigError for UTF-8 that ends within a character: the file was cut off.
    """
    decoder = codecs.getincrementaldecoder("utf-8")()
    letters = False  # beyond ASCII: without any, the last byte may well be a letter of Windows-1252
    try:
        for block in blocks:
            letters |= not decoder.decode(block).isascii()
    except UnicodeDecodeError:
        return "cp1252"
    if not decoder.getstate()[0]:
        return "utf-8"
    if letters:
        raise ConfigError(f"{path}: ends within a character of UTF-8: the file was cut off")
    return "cp1252"


@contextlib.contextmanager
def opened(path: Path, encoding: str, skipped: int = 0) -> Iterator[TextIO]:
    """Open a file and pass over its first `skipped` lines.

    Raises ConfigError naming it where it cannot be read or is no text, within the `with` block too.
    """
    try:
        with path.open(encoding=encoding, newline="") as file:
            for _ in range(skipped):
                file.readline()
            yield file
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {reason(error)}") from error
    except UnicodeError as error:
        kind = "UTF-16 or UTF-32" if encoding.startswith(("utf-16", "utf-32")) else "UTF-8 or Windows-1252"
        where = f" at byte {error.start}" if isinstance(error, UnicodeDecodeError) else ""
        raise ConfigError(f"{path}: is not {kind} text: {error.args[-1]}{where}") from error


def read_header(path: Path, encoding: str) -> Header:
    """Read the header of a file: no names where the file is empty.

    Raises ConfigError naming the file where it cannot be read, does not close a quote, or has numbers in
    place of names.
    """
    with opened(path, encoding) as file:
        above, given, comment = _above(file)
    candidates = [given] if given else SEPARATORS
    found = [_with_separator(path, encoding, above, separator) for separator in candidates]
    several = [(h, row) for h, row in found if len(h.names) > 1]
    fits = [h for h, row in several if len(row) == len(h.names) or len(filled(row)) == len(filled(h.names))]
    header = fits[0] if fits else several[-1][0] if several else found[-1][0]
    if header.names and all(number_in(name, header.separator) is not None for name in header.names):
        names = _cells(comment, header.separator)
        if len(names) == len(header.names) and any(number_in(n, header.separator) is None for n in names):
            return Header(names, above, header.separator)
        shown = header.separator.join(header.names)
        raise ConfigError(f"{path}: line {above + 1}: a header with names is needed, not numbers: {shown!r}")
    return header


def _above(lines: Iterable[str]) -> tuple[int, str, str]:
    """Return the number of lines above the header, the separator given there, and the comment right above.

    Separator and comment are "" where there is none.
    """
    count, separator, comment = 0, "", ""
    for line in lines:
        text = line.strip()
        given = re.fullmatch(r"sep=([;,\t])", line.strip("\r\n"), re.IGNORECASE)
        if given and not separator:
            separator, comment = given[1], ""
        elif text.startswith("#"):
            comment = text.lstrip("#")
        elif text:
            break
        else:
            comment = ""
        count += 1
    return count, separator, comment


def _with_separator(path: Path, encoding: str, above: int, separator: str) -> tuple[Header, list[str]]:
    """Return the header as a separator divides it, and the first row; both may be empty.

    Raises ConfigError where the header does not close a quote or is no CSV.
    """
    taken: list[str] = []
    with opened(path, encoding, above) as file:
        reader = csv.reader(_noted(file, taken), delimiter=separator, skipinitialspace=True)
        try:
            names = tuple(name.strip() for name in next(reader, []))
        except csv.Error as error:
            raise ConfigError(f"{path}: line {above + 1}: is not well-formed CSV: {error}") from error
        lines = len(taken)
        rest = Comments().without(file)
        first = next((line for line in rest if line.strip()), None)
        if lines > 1 and first is None and "".join(taken).count('"') % 2:
            raise ConfigError(
                f"{path}: line {above + 1}: a quote of the header is not closed: {taken[0].strip()!r}"
            )
        row: list[str] = []
        with contextlib.suppress(csv.Error, StopIteration):  # what is wrong in a row is said when it is read
            row = next(csv.reader(itertools.chain([first or ""], rest), delimiter=separator))
    return Header(names, above + lines, separator), row


def _noted(lines: Iterable[str], taken: list[str]) -> Iterator[str]:
    """Yield lines, each of which is appended to `taken`."""
    for line in lines:
        taken.append(line)
        yield line


def _cells(text: str, separator: str) -> tuple[str, ...]:
    return tuple(cell.strip() for cell in next(csv.reader([text], delimiter=separator), []))


def filled(cells: Sequence[str]) -> Sequence[str]:
    """Return the cells of a line up to the last one in which something stands."""
    return cells[: next((k for k in range(len(cells), 0, -1) if cells[k - 1].strip()), 0)]


def number_in(text: str, separator: str) -> float | None:
    """Return the number that a text is, or None: for other texts, NaN, infinity, and '_' among digits.

    Where the separator is no ',', there may be one in place of the decimal point.
    """
    if separator != "," and text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None


def time_column(names: tuple[str, ...], place: str) -> int:
    """Return the column of the time, by its name: time, t, timestamp or Zeit, with or without a unit s.

    Case counts for nothing: `Time [s]`, `t(s)` and `time_s` are such names; but beside another one `T` is
    none. Where several columns have one, it is that named `time`, else the first column. Raises ConfigError,
    which begins with `place`, where there is none, or several and neither, or one name twice.
    """
    named = named_as_time(names)
    plain = [j for j in named if names[j].strip().lower() == "time"]
    found = named if len(named) == 1 else plain or [j for j in named if j == 0]
    listed = ", ".join(repr(name) for name in names)
    if found:
        same = [j for j in named if names[j].strip().lower() == names[found[0]].strip().lower()]
        if len(same) > 1:
            raise ConfigError(f"{place}: {both(names, same)} both have the name of the time: which is meant?")
        return found[0]
    if named:
        raise ConfigError(f"{place}: {counted(len(named), 'column')} could be the time: {listed}")
    raise ConfigError(
        f"{place}: no column has a name of the time in s ('time', 't', 'Time [s]', 'time_s', 'timestamps', "
        f"...): {listed}"
    )


def named_as_time(names: Sequence[str]) -> list[int]:
    """Return the columns that have a name of the time."""
    named = [j for j, name in enumerate(names) if _TIME.fullmatch(name.strip())]
    if len(named) > 1:
        named = [j for j in named if names[j].strip() != "T"] or named  # it is a temperature
    return named


_SINCE_1970 = {"seconds": 1.0, "milliseconds": 1e3, "microseconds": 1e6, "nanoseconds": 1e9}
_FIRST, _LAST = 3e8, 4.2e9  # of these seconds, 1979 to 2103


def as_date(time: float) -> str:
    """Return what a time looks like that is a date, as `milliseconds since 1970 (2026-05-04 12:00:00 UTC)`.

    "" for one that is none.
    """
    for name, parts in _SINCE_1970.items():
        if _FIRST <= (seconds := time / parts) < _LAST:
            return f"{name} since 1970 ({datetime.fromtimestamp(int(seconds), UTC):%Y-%m-%d %H:%M:%S} UTC)"
    return ""


_DATE = re.compile(
    r"(\d{4}([-/.])\d\d?\2\d\d?|\d\d?([-/.])(\d\d?|[^\W\d]{3,9})\3(\d{4}|\d\d)|\d{1,3}:\d\d)(\D.*)?",
    re.DOTALL,
)


def is_date(text: str) -> bool:
    """Return True for a text that looks like a date, a time of day, or both."""
    return _DATE.fullmatch(text.strip()) is not None


def check_seconds(time: float, place: str) -> None:
    """Raise ConfigError, which begins with `place`, for a time that cannot be in seconds."""
    if not abs(time) <= LATEST:
        seems = f"; it looks like {date}" if (date := as_date(time)) else ""
        raise ConfigError(
            f"{place}: {time:.16g} s is beyond the {LATEST:g} s of a run{seems}: the time is in s, best from "
            "the start of the run on"
        )


def both(names: Sequence[str], columns: Sequence[int]) -> str:
    """Return `columns 2 ('x') and 3 ('x')` for the first two of some columns, counted from 0."""
    return "columns " + " and ".join(f"{j + 1} ({names[j]!r})" for j in columns[:2])


def quoted_name(name: str) -> str:
    """Return a name as evcosim writes it: FMI's structured names may hold a comma, as in `x[1,2]`."""
    if any(c in name for c in ',"\n\r'):
        return '"' + name.replace('"', '""') + '"'
    return name


class CutRow(NamedTuple):
    """The last line of a file that does not end: its number, the place where it begins, and its text."""

    line: int
    begin: int
    text: str


def cut_row(path: Path) -> CutRow | None:
    """Return the last line of a text file, shortened, where it does not end; None: it does, or is the header.

    Raises OSError.
    """
    with path.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - 2))
        if file.read().rstrip(b"\0").endswith((b"\n", b"\r")):  # UTF-16 has a zero behind or before it
            return None
        file.seek(0)
        lines, begin, last = 0, 0, b""
        for line in file:
            lines, begin, last = lines + 1, begin + len(last), line
    return CutRow(lines, begin, last[:_SHOWN].decode("utf-8", "replace")) if lines > 1 else None
