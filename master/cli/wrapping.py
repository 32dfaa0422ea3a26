"""The lines of a table whose cells are wrapped, each inside its column."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Sequence

GAP, _INDENT, _BEGIN = "  ", "    ", "  "
_LEAST = 8  # columns of a cell, however narrow the terminal is
_NAMES = re.compile(r"(?<=[./:])(?=[^\W\d_])")  # as in bus.message.signal and folder/file
_WORDS = re.compile(r"(?<=[./:_])(?=[^\W\d_])")  # as in rolling_coefficient
_QUOTED = re.compile(
    r"(?:(?<!\w)'(?=\S).*?(?<=\S)'(?!\w)|\S)+"
)  # a word, with all that stands in quotes in it
_PLACE = re.compile(r"(?:evcosim: )?(?:warning: )?[^:']*[./\\][^\s:']*:(?= )")  # the file that is spoken of


Table = Sequence[Sequence[str]]
"""Rows of cells, the first of them the headers; each has as many."""


def wrapped(table: Table, width: int, right: Collection[str] = ()) -> list[list[str]]:
    """Return the lines of each row of a table, no longer than `width` where 8 a column fit.

    Cells are wrapped between words; a word longer than its column is wrapped too, after a `.`, `/`, `_` or
    `:` if it has any, and nothing is left out. Columns whose headers are in `right` are right-aligned.
    """
    widths = column_widths(table, width - len(GAP) * (len(table[0]) - 1))
    return [_row_lines(row, widths, [name in right for name in table[0]]) for row in table]


def wrapped_below(table: Table, width: int, right: Collection[str] = ()) -> list[list[str]]:
    """Return the same with the cells of the last column below the others, over the whole width."""
    above = wrapped([row[:-1] for row in table], width, right)
    below = [cell_lines(row[-1], max(width - len(_INDENT), _LEAST)) for row in table]
    return [
        [*lines, *(_INDENT + line for line in more if line)] for lines, more in zip(above, below, strict=True)
    ]


def is_narrow(table: Table, width: int, least: int) -> bool:
    """Return True where a terminal is too narrow: a text in the last column has less than `least` columns."""
    if len(table[0]) < 2:
        return False
    gaps = len(GAP) * (len(table[0]) - 1)
    widths = column_widths(table, width - gaps)
    return widths[-1] < least < max(len(row[-1]) for row in table) or sum(widths) + gaps > width


def column_widths(table: Table, available: int) -> list[int]:
    """Return the widths of columns: what the longest cell needs, the widest ones cut to what is available.

    Words stay whole if that is enough, else the parts of names do, else the words in them.
    """
    columns = list(zip(*table, strict=True))
    widths = [max(map(len, column)) for column in columns]
    for cut in (None, _NAMES, _WORDS):
        parts = [[part for cell in column for part in _parts(cell, cut)] for column in columns]
        widths = _cut(widths, available, [max(map(len, column), default=0) for column in parts])
    return _cut(widths, available, [_LEAST] * len(columns))


def _parts(text: str, cut: re.Pattern[str] | None) -> list[str]:
    words = text.split()
    return words if cut is None else [part for word in words for part in cut.split(word)]


def _cut(widths: list[int], available: int, least: Sequence[int]) -> list[int]:
    """Return the widths, the widest of those above their least cut until all fit, if they can."""
    widths = list(widths)
    while sum(widths) > available:
        free = [i for i, w in enumerate(widths) if w > least[i]]
        if not free:
            break
        widths[max(free, key=lambda i: widths[i])] -= 1
    return widths


def _row_lines(row: Sequence[str], widths: Sequence[int], on_right: Sequence[bool]) -> list[str]:
    cells = [cell_lines(cell, width) for cell, width in zip(row, widths, strict=True)]
    return [
        GAP.join(
            part.rjust(width) if right else part.ljust(width)
            for part, width, right in zip(parts, widths, on_right, strict=True)
        ).rstrip()
        for parts in itertools.zip_longest(*cells, fillvalue="")
    ]


def message_lines(line: str, width: int) -> list[str]:
    """Return a line of a message as lines of a terminal, those after the first indented.

    It is wrapped between words. A word and the file with which a message begins stay whole, however long they
    are, and so does, where a line has room for it, what stands in quotes, as a command to be copied.
    """
    if len(line) <= width:
        return [line]
    place = _PLACE.match(line)
    start = place.end() if place else 0
    lines = [line[:start]] if start else []
    for word in _QUOTED.findall(line[start:]):
        for part in [word] if len(word) <= width - len(_BEGIN) else word.split():
            if lines and len(lines[-1]) + 1 + len(part) <= width:
                lines[-1] += f" {part}"
            else:
                lines.append(f"{_BEGIN}{part}" if lines else part)
    return lines


def cell_lines(text: str, width: int) -> list[str]:
    """Return the lines of a cell, none longer than `width`; [""] for an empty one."""
    lines, line = [], ""
    for word in text.split():
        cuts = (None, _NAMES, _WORDS)
        fitting = (parts for cut in cuts if max(map(len, parts := _parts(word, cut))) <= width)
        parts = next(fitting, _parts(word, _WORDS))
        for i, part in enumerate(parts):
            glue = " " if line and i == 0 else ""
            if len(line) + len(glue) + len(part) <= width:
                line += glue + part
                continue
            lines += [line] if line else []
            while len(part) > width:
                lines.append(part[:width])
                part = part[width:]
            line = part
    return [*lines, line] if line or not lines else lines
