"""The lines of a table whose cells are wrapped, each inside its column."""

from __future__ import annotations

import itertools
import textwrap
from collections.abc import Sequence

GAP = "  "
_LEAST = 8  # columns of a cell, however narrow the terminal is


def wrapped(headers: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> list[str]:
    """Return the lines of a table with its headers, no longer than `width` where that leaves 8 a column.

    Cells are wrapped between words; a word longer than its column is wrapped too, and nothing is left out.
    Rows of which one is wrapped are apart by an empty line.
    """
    table = [list(headers), *(list(row) for row in rows)]
    widths = column_widths(table, width - len(GAP) * (len(headers) - 1))
    lines = [_row_lines(row, widths) for row in table]
    between = [""] if any(len(some) > 1 for some in lines) else []
    return [*lines[0], *itertools.chain.from_iterable([*between, *some] for some in lines[1:])]


def column_widths(table: Sequence[Sequence[str]], available: int) -> list[int]:
    """Return the widths of columns: what the longest cell needs, the widest ones cut to what is available."""
    wanted = [max(map(len, column)) for column in zip(*table, strict=True)]
    widths = list(wanted)
    while sum(widths) > available and max(widths) > _LEAST:
        widest = max(widths)
        below = max([w for w in widths if w < widest], default=_LEAST)
        many = widths.count(widest)
        cut = min(widest - max(below, _LEAST), -(-(sum(widths) - available) // many))
        widths = [w - cut if w == widest else w for w in widths]
    return widths


def _row_lines(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    cells = [
        textwrap.wrap(cell, width, break_on_hyphens=False) or [""]
        for cell, width in zip(row, widths, strict=True)
    ]
    return [
        GAP.join(part.ljust(width) for part, width in zip(parts, widths, strict=True)).rstrip()
        for parts in itertools.zip_longest(*cells, fillvalue="")
    ]
