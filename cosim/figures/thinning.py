"""Fewer points that draw the same line: of a long run, the extremes of as many stretches as are seen."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..results.results import PIECE, Results
from ..row_store import Array

_POINTS = 40_000  # of all lines together: about 1 MB of SVG


def points_per_line(lines: int) -> int:
    """Return how many points each of so many lines may have."""
    return max(300, min(4000, _POINTS // max(1, lines)))


def thinned(values: Array, limit: int) -> NDArray[np.intp]:
    """Return the indices of about `limit` of the values, shape (n,), that draw the same picture.

    In each of limit/2 equal stretches the smallest and the largest value stay, in their order in time, so
    that a spike of one sample survives. The first and the last value always stay.
    """
    return _extremes(values, _width(len(values), limit))


def thinned_variable(results: Results, name: str, limit: int) -> tuple[Array, Array]:
    """Return times [s] and values of about `limit` points of a variable, shapes (n,), chosen as by `thinned`.

    One piece of a long run is in memory at a time. Raises ConfigError for a variable that there is not.
    """
    width = _width(len(results), limit)
    times, kept = [np.empty(0)], [np.empty(0)]
    for time, values in results.pieces([name], rows=width * max(1, PIECE // width)):
        at = _extremes(values[:, 0], width)
        times.append(time[at])
        kept.append(values[at, 0])
    return np.concatenate(times), np.concatenate(kept)


def _width(n: int, limit: int) -> int:
    """Return how many values a stretch has of which two are drawn; 1 where all are."""
    return 1 if n <= limit else math.ceil(n / max(1, limit // 2))


def _extremes(values: Array, width: int) -> NDArray[np.intp]:
    """Return the indices of the extremes in each stretch of `width` values, shape (n,), and of the ends."""
    n = len(values)
    if width == 1:
        return np.arange(n)
    whole = n - n % width
    blocks = values[:whole].reshape(-1, width)
    begin = np.arange(0, whole, width)
    keep = [begin + blocks.argmin(axis=1), begin + blocks.argmax(axis=1), np.array([0, n - 1])]
    if whole < n:
        keep.append(whole + np.array([values[whole:].argmin(), values[whole:].argmax()]))
    return np.unique(np.concatenate(keep))
