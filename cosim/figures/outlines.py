"""The outlines of all variables of a run, found in one pass over its rows: size, range, a sample of values.

What only looks at each variable does so once; of two variables whose samples are far apart nobody has to
compare all rows.
"""

from __future__ import annotations

import math

import numpy as np

from ..errors import ConfigError
from ..results.results import Results, ResultVariable
from ..row_store import Array
from .check import panel_conversion

_SAME = 5e-3  # of the range: rms of a difference that nobody sees
_TOGETHER = 2**20  # values that are read at a time
_SAMPLE, _SHARE = 64, 500  # rows of a sample: so many, and one of so many


class Outlines:
    """The outlines of the variables of a run, all by name."""

    def __init__(self, results: Results) -> None:
        self._results = results
        self._places = {name: j for j, name in enumerate(results.names)}
        count, width = len(results), len(results.names)
        self._size, self._low, self._high = np.zeros(width), np.full(width, np.inf), np.full(width, -np.inf)
        self._changes = np.zeros(width, dtype=np.bool_)
        at = np.unique(np.linspace(0, max(0, count - 1), min(count, _SAMPLE + count // _SHARE)).astype(int))
        kept, first, begin = [np.empty((0, width))], None, 0
        for times, values in results.pieces(results.names, rows=max(1, _TOGETHER // max(1, width))):
            first = values[0] if first is None else first
            self._changes |= np.any(values != first, axis=0)
            # np.maximum passes a NaN on, as np.max does
            self._size = np.maximum(self._size, np.max(np.abs(values), axis=0))
            self._low = np.minimum(self._low, np.min(values, axis=0))
            self._high = np.maximum(self._high, np.max(values, axis=0))
            inside = at[(at >= begin) & (at < begin + len(times))]
            kept.append(values[inside - begin])
            begin += len(times)
        self._sample: Array = np.concatenate(kept)

    def size(self, variable: ResultVariable) -> float:
        """Return the largest magnitude of a variable; NaN where it has one."""
        return float(self._size[self._places[variable.name]])

    def changes(self, variable: ResultVariable) -> bool:
        """Return True for a variable that has more than one value."""
        return bool(self._changes[self._places[variable.name]])

    def repeats(self, variable: ResultVariable, others: list[ResultVariable]) -> bool:
        """Return True where a variable would draw the line of one of the others, which are of one kind.

        Kinds are told apart by `kind`. The two lines differ by 0.5 % (rms) of the range of the other: the
        quantization of a throttle of 0.4 % is below that, that of a speed of 1 km/h above it.
        """
        try:
            convert = panel_conversion(variable, others[0].unit, "figure")
        except ConfigError:
            return False
        places = [self._places[other.name] for other in others]
        with np.errstate(over="ignore", invalid="ignore"):  # infinite squares repeat nothing
            span = self._high[places] - self._low[places]
            own = convert.scale * self._sample[:, self._places[variable.name]] + convert.offset
            least = np.sum((own[:, None] - self._sample[:, places]) ** 2, axis=0)  # of the sum over all rows
            apart = least > 1.000001 * len(self._results) * (_SAME * span) ** 2  # beyond rounding
        near = [other for other, far in zip(others, apart, strict=True) if not far]
        return any(self._same(variable, other, convert.scale, convert.offset) for other in near)

    def _same(self, variable: ResultVariable, other: ResultVariable, scale: float, offset: float) -> bool:
        """Return True where two variables are equal in all rows, or nearly so."""
        equal, squares = True, 0.0
        for _, values in self._results.pieces([variable.name, other.name]):
            with np.errstate(over="ignore", invalid="ignore"):  # as above
                a, b = scale * values[:, 0] + offset, values[:, 1]
                equal = equal and np.array_equal(a, b)
                squares += float(np.sum((a - b) ** 2))
        place = self._places[other.name]
        low, high = float(self._low[place]), float(self._high[place])
        return equal or (high > low and math.sqrt(squares / len(self._results)) <= _SAME * (high - low))


def kind(variable: ResultVariable) -> tuple[object, ...]:
    """Return what two variables have in common that can be drawn as one line."""
    return variable.type == "Real", variable.items, variable.unit
