"""Stimuli of inputs that are not Real: each value in the input's type, held until the next one's time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..clock import Clock
from ..csv_text import number_in
from ..errors import ConfigError
from ..interface import Value, VariableInfo
from ..units.measure import Affine
from .scenario import StimulusEntry
from .stimuli import Rows, TimeFunction, check_times, csv_of, held, read_times, stimulus
from .values import WHOLE, of_type

ToDouble = Callable[[Value, str], float]
"""(value, place): the double in which a run keeps a value of the input's type."""


def held_stimulus(
    entry: StimulusEntry,
    place: str,
    beside: Path | None,
    variable: VariableInfo,
    map_: Affine,
    clock: Clock,
    to_double: ToDouble,
) -> TimeFunction:
    """Return the signal that an entry describes, for an input that is not Real, in the input's own unit.

    `place` is the entry's in the scenario file `beside`, from which a csv path is looked up; `map_` converts
    from the entry's unit; a time that misses a point of `clock` by rounding alone is that point. Raises
    ConfigError naming the place of a value that is none of the input's type, and for a signal that only a
    Real can follow.
    """
    kind = f"{variable.name} is of type {variable.type}"
    for key in ("sine", "ramp"):
        if getattr(entry, key) is not None:
            raise ConfigError(f"{place}.{key}: {kind}, which takes a constant, a table or a csv")
    if entry.interpolation == "linear" and "interpolation" in entry.model_fields_set:
        raise ConfigError(
            f'{place}.interpolation: {kind}, whose values hold until the next one: "linear" is between Reals'
        )

    def number(value: Any, where: str) -> float:
        if isinstance(value, int | float) and not isinstance(value, bool) and map_ != Affine():
            value = map_(value)
        return to_double(of_type(value, variable, where), where)

    if entry.constant is not None:
        return held(np.zeros(1), np.array([number(entry.constant, f"{place}.constant")]))
    if entry.table is not None:
        rows = Rows(f"{place}.table")
        times = np.array([time for time, _ in entry.table], dtype=float)
        check_times(times, rows)
        values = [number(value, rows.at(k, 1)) for k, (_, value) in enumerate(entry.table)]
        return held(clock.on_points(times), np.array(values))
    return _of_csv(entry, place, beside, variable, clock, number)


def _of_csv(
    entry: StimulusEntry,
    place: str,
    beside: Path | None,
    variable: VariableInfo,
    clock: Clock,
    number: Callable[[Any, str], float],
) -> TimeFunction:
    file, rows = csv_of(entry, place, beside)
    times = read_times(file, rows)
    texts = file.texts(rows.value)
    known: dict[str, float] = {}
    values: NDArray[np.float64] = np.empty(len(texts))
    for k, text in enumerate(texts):
        if text not in known:
            value = _value(text, variable, file.separator)
            try:
                known[text] = number(value, "")
            except ConfigError:  # only then the file is read again for the line
                known[text] = number(value, rows.at(k, 1))
        values[k] = known[text]
    return held(clock.on_points(times), values)


def course(
    entry: StimulusEntry, place: str, beside: Path | None, clock: Clock, times: NDArray[np.float64]
) -> list[Value]:
    """Return the values at some times [s], shape (n,), of a stimulus whose input is not known.

    Where all are numbers it is taken as that of a Real, else each value holds until the next one's time.
    Raises ConfigError as `stimulus` does.
    """
    pairs = _pairs(entry, place, beside)
    if all(isinstance(value, int | float) and not isinstance(value, bool) for _, value in pairs):
        signal = stimulus(entry, place, beside, VariableInfo(entry.to), clock)
        return list(signal(times).tolist())
    rows = Rows(place)
    check_times(points := np.array([time for time, _ in pairs], dtype=float), rows)
    signal = held(clock.on_points(points), np.arange(len(pairs), dtype=float))
    return [pairs[int(k)][1] for k in signal(times)]


def _pairs(entry: StimulusEntry, place: str, beside: Path | None) -> list[tuple[float, Value]]:
    """Return the times [s] and values of a constant, a table or a csv; none of another signal."""
    if entry.csv is not None:
        file, rows = csv_of(entry, place, beside)
        known = VariableInfo(entry.to, "Boolean")  # of which true and false are values
        values = [_value(text, known, file.separator) for text in file.texts(rows.value)]
        return list(zip(read_times(file, rows).tolist(), values, strict=True))
    return [(0.0, entry.constant)] if entry.constant is not None else list(entry.table or [])


def _value(text: str, variable: VariableInfo, separator: str) -> Value:
    """Return the value of a cell of a CSV file: a text where it is neither a number nor a truth value.

    Numbers are those of `csv_text.number_in`, but whole ones are exact.
    """
    if variable.type == "String":
        return text
    if variable.type == "Boolean" and text.lower() in ("true", "false"):
        return text.lower() == "true"
    if WHOLE.fullmatch(text):
        return int(text)
    number = number_in(text, separator)
    return text if number is None else number
