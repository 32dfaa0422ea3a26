"""The columns of a page: numbers as text, which the page unpacks to arrays of float32 or float64.

Numbers are written as the base64 of their deflated bytes, of all numbers the first bytes first, then the
second ones: neighbors are alike then, and the text is a third as long. A column stands on a grid, the times
of its rows; columns of one run share it.
"""

from __future__ import annotations

import base64
import hashlib
import zlib
from typing import Any

import numpy as np

from ..clock import Clock
from ..row_store import Array

_LEVEL = 6  # of deflate: a higher one takes twice the time for a hundredth of the size
_PRECISE = 1e-5  # of the range: a curve that is off by less is the same to the eye


def packed(values: Array, exact: bool = False) -> dict[str, Any]:
    """Return numbers, shape (n,), as text and its type: "f4" where float32 draws the same, else "f8"."""
    kind = "f4" if not exact and _fits_float32(values) else "f8"
    octets = np.frombuffer(values.astype(f"<{kind}").tobytes(), dtype=np.uint8)
    shuffled = octets.reshape(len(values), int(kind[1])).T.tobytes()
    return {"type": kind, "data": base64.b64encode(zlib.compress(shuffled, _LEVEL)).decode("ascii")}


def _fits_float32(values: Array) -> bool:
    """Return True where float32 is off by less than is seen of the curve through the values, shape (n,)."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return True
    with np.errstate(over="ignore"):
        rounded = finite.astype(np.float32).astype(np.float64)
        worst, span = float(np.max(np.abs(rounded - finite))), float(np.ptp(finite))
    return worst < np.inf and worst <= _PRECISE * span


class Columns:
    """The columns of a page and their grids, each packed once."""

    def __init__(self) -> None:
        self._grids: list[dict[str, Any]] = []
        self._columns: list[dict[str, Any]] = []
        self._places: dict[tuple[int, bytes], int] = {}  # by grid and digest of the values

    def grid(self, times: Array) -> int:
        """Return the number of the grid with these times [s], shape (n,)."""
        about = _counted(times) or {"count": len(times), **packed(times, exact=True)}
        if about not in self._grids:
            self._grids.append(about)
        return self._grids.index(about)

    def column(self, grid: int, values: Array) -> int:
        """Return the number of the column with these values, shape (n,), on a grid."""
        key = (grid, hashlib.sha256(values.tobytes()).digest())
        if key not in self._places:
            gaps = int(np.count_nonzero(~np.isfinite(values)))
            self._columns.append({"grid": grid, **packed(values), "gaps": gaps})
            self._places[key] = len(self._columns) - 1
        return self._places[key]

    def as_data(self) -> dict[str, Any]:
        """Return all grids and columns as JSON has them, in the order of their numbers."""
        return {"grids": self._grids, "columns": self._columns}


def _counted(times: Array) -> dict[str, Any] | None:
    """Return the numbers that make exactly these times [s], shape (n,); None: there are no equal steps."""
    if len(times) < 2:
        return None
    difference = float(times[1] - times[0])
    for step in (float(f"{difference:.9g}"), difference):
        if step <= 0.0:
            return None
        clock = Clock.counted(float(times[0]), step, len(times) - 1, float(times[-1]))
        if np.array_equal(clock.times(0, len(times)), times):
            ends = {"first": clock.first, "advance": clock.advance, "divisor": clock.divisor}
            return {"count": len(times), **ends, "last": clock.stop}
    return None
