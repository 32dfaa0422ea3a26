"""The recorded rows of a run as columns of a page: all of them, or the extremes of stretches of a long run.

The signals of the figure have every row up to FULL_ROWS, the others too while all of the run has no more than
MOST values. Beyond that a column has the smallest and the largest value of equal stretches of rows, in their
order, so that a spike of one sample survives, and the first and the last row as they are.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..results.results import PIECE, Results
from ..row_store import Array
from .columns import Columns

FULL_ROWS = 200_000
MOST = 8_000_000  # values of all columns: some 6 MB of page
_OF_FIGURE, _LEAST = 40_000, 2000  # points of a column of extremes: of the figure, and of another one
_TOGETHER = 32  # columns that are read at a time: 50 MB of FULL_ROWS
_TEXTS, _LONGEST = 2000, 200  # texts of a variable that are told apart, and their characters

Items = tuple[tuple[int, str], ...]
"""Values of a column and their names."""


@dataclasses.dataclass(frozen=True)
class Recorded:
    """The columns of a run: their numbers by name, the names of their values, and a sentence on the rows."""

    columns: dict[str, int]
    items: dict[str, Items]
    said: str


Codes = dict[str, dict[str, int]]
"""The numbers of texts by variable: runs on one page share them."""


def recorded(results: Results, drawn: Sequence[str], page: Columns, codes: Codes | None = None) -> Recorded:
    """Put variables and texts of a run, which has a row at least, into a page; `drawn` are the figure's.

    `codes` are added to.
    """
    codes = {} if codes is None else codes
    count, names = len(results), (*results.names, *results.texts)
    rest = [name for name in names if name not in drawn]
    full = count <= FULL_ROWS
    all_full = full and count * len(names) <= MOST
    few = min(_OF_FIGURE // 2, max(_LEAST, MOST // max(1, len(names))))
    columns: dict[str, int] = {}
    items = {v.name: _items(v.type, v.items) for v in results.variables}
    for some, limit in (
        (list(drawn), count if full else _OF_FIGURE),
        (rest, count if all_full else few),
    ):
        width = stretch(count, limit)
        numbers = [name for name in some if name not in results.texts]
        for i in range(0, len(numbers), _TOGETHER):
            part = numbers[i : i + _TOGETHER]
            times, values = _read(results, part, width)
            grid = page.grid(times)
            columns |= {name: page.column(grid, values[:, j].copy()) for j, name in enumerate(part)}
        for name in (name for name in some if name in results.texts):
            texts, items[name] = _coded(results, name, codes.setdefault(name, {}))
            columns[name] = page.column(*_column(page, results.time, texts, width))
    widths = (stretch(count, count if full else _OF_FIGURE), stretch(count, count if all_full else few))
    return Recorded(columns, items, _said(count, widths, bool(drawn), bool(rest)))


def array_column(page: Columns, times: Array, values: Array) -> int:
    """Put values at times [s], shapes (n,), into a page as those of a figure; return the column's number."""
    width = stretch(len(times), len(times) if len(times) <= FULL_ROWS else _OF_FIGURE)
    return page.column(*_column(page, times, values, width))


def _column(page: Columns, times: Array, values: Array, width: int) -> tuple[int, Array]:
    """Return the grid and the values, shape (k,), of the points of an array."""
    size = width * max(1, PIECE // width)
    starts = range(0, len(values), size)
    pieces = ((times[k : k + size], values[k : k + size, None]) for k in starts)
    at, kept = _joined(_extremes(pieces, width))
    return page.grid(at), kept[:, 0].copy()


def stretch(count: int, limit: int) -> int:
    """Return the rows of a stretch of which two points are drawn, so that `count` rows make about `limit`."""
    return 1 if count <= limit else max(4, math.ceil(count / max(1, limit // 2)))


def _said(count: int, widths: tuple[int, int], drawn: bool, rest: bool) -> str:
    """Return the sentence on the resolution; `widths` are those of the figure's columns and of the others."""
    rows = f"{count:,} row{'s' if count != 1 else ''}"
    parts = [
        f"{who} in full resolution" if width == 1 else f"{who} as the extremes of each {width:,} rows"
        for who, width, there in zip(
            ("the figure's signals", "the others"), widths, (drawn, rest), strict=True
        )
        if there
    ]
    if widths[0] == widths[1] or len(parts) == 1:
        parts = [
            "every signal in full resolution" if widths[0] == 1 else f"extremes of each {widths[0]:,} rows"
        ]
    return f"{rows}: {', '.join(parts)}"


def _read(results: Results, names: Sequence[str], width: int) -> tuple[Array, Array]:
    """Return times [s], shape (k,), and values, shape (k, len(names)), of the points of some variables."""
    pieces = results.pieces(names, rows=PIECE if width == 1 else width * max(1, PIECE // width))
    return _joined(pieces if width == 1 else _extremes(pieces, width))


def _joined(pieces: Iterator[tuple[Array, Array]]) -> tuple[Array, Array]:
    parts = list(pieces)
    return np.concatenate([t for t, _ in parts]), np.concatenate([v for _, v in parts])


def _extremes(pieces: Iterator[tuple[Array, Array]], width: int) -> Iterator[tuple[Array, Array]]:
    """Yield the points of pieces that have whole stretches of rows, all but the last one.

    The two points of a stretch stand at its quarters; the first row, the rows behind the last whole stretch
    and the last row stand as they are.
    """
    if width == 1:
        yield from pieces
        return
    last: tuple[Array, Array] | None = None
    for times, values in pieces:
        if last is None:
            yield times[:1], values[:1]
        whole = len(times) - len(times) % width
        if whole:
            at = np.arange(0, whole, width)
            rows = np.column_stack((at + (width + 1) // 4, at + (3 * width - 1) // 4)).ravel()
            yield times[rows], _pairs(values[:whole].reshape(-1, width, values.shape[1]))
        yield times[whole:], values[whole:]
        last = (times[-1:], values[-1:]) if whole == len(times) else (times[:0], values[:0])
    if last is not None:
        yield last


def _pairs(blocks: Array) -> Array:
    """Return smallest and largest values of stretches, shape (s, width, m), in their order, shape (2 s, m).

    A value that is not finite counts only where a stretch has no other.
    """
    good = np.isfinite(blocks)
    low = np.where(good, blocks, np.inf)
    high = np.where(good, blocks, -np.inf)
    first = low.argmin(axis=1) <= high.argmax(axis=1)
    smallest, largest = low.min(axis=1), high.max(axis=1)
    pairs = np.stack((np.where(first, smallest, largest), np.where(first, largest, smallest)), axis=1)
    return np.asarray(np.where(np.isfinite(pairs), pairs, np.nan).reshape(-1, blocks.shape[2]))


def _items(kind: str, items: Items) -> Items:
    return ((0, "false"), (1, "true")) if kind == "Boolean" else items


def _coded(results: Results, name: str, codes: dict[str, int]) -> tuple[Array, Items]:
    """Return the number of the text in each row, shape (n,), and the texts by number, long ones cut."""
    place = results.texts.index(name)
    found = np.zeros(len(results))
    changes = results.text_table.changes
    for (row, texts), end in zip(changes, [*(row for row, _ in changes[1:]), len(results)], strict=True):
        found[row:end] = codes.setdefault(texts[place], min(len(codes), _TEXTS))
    shown = [(code, text[:_LONGEST]) for text, code in codes.items() if code < _TEXTS]
    return found, (*shown, *([(_TEXTS, "(another text)")] if len(codes) > _TEXTS else []))
