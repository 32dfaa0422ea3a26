"""Signals that drive free inputs, as functions of time evaluated for many communication points at once."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..clock import LATEST, Clock
from ..csv_numbers import CsvFile
from ..csv_text import both, check_seconds
from ..errors import ConfigError, nearest
from ..interface import VariableInfo
from .scenario import Interpolation, Ramp, Sine, StimulusEntry
from .toml import data_file
from .values import WHOLE, check_whole, of_type

TimeFunction = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Values, shape (n,), of a stimulus at the times [s], shape (n,)."""


def stimulus(
    entry: StimulusEntry, place: str, beside: Path | None, variable: VariableInfo, clock: Clock
) -> TimeFunction:
    """Return the signal that an entry describes for a Real input `variable`, in the entry's own unit.

    `place` is the entry's in the scenario file `beside`, from which a csv path is looked up. A time that
    misses a communication point of `clock` by rounding alone is that point. Raises ConfigError naming
    `place` with the key, rule and values.
    """
    if entry.constant is not None:
        value = float(of_type(entry.constant, variable, f"{place}.constant"))
        return held(np.zeros(1), np.array([value]))
    if entry.sine is not None:
        return _sine(entry.sine, clock)
    if entry.ramp is not None:
        return _ramp(entry.ramp, f"{place}.ramp", clock)
    if entry.table is not None:
        rows = Rows(f"{place}.table")
        values = [float(of_type(value, variable, rows.at(k, 1))) for k, (_, value) in enumerate(entry.table)]
        times = np.array([time for time, _ in entry.table], dtype=float)
        return _table(clock.on_points(times), np.array(values), entry.interpolation, rows)
    file, rows = csv_of(entry, place, beside)
    table = file.numbers((rows.time, rows.value))
    _check_whole(table[:, 1], variable, rows)
    return _table(clock.on_points(table[:, 0]), table[:, 1].copy(), entry.interpolation, rows)


def _check_whole(values: NDArray[np.float64], variable: VariableInfo, rows: Rows) -> None:
    """Raise ConfigError naming the row of a whole number that was rounded: values, shape (n,), as read."""
    large = np.flatnonzero(np.abs(values) >= (2**24 if variable.limits else 2**53))
    texts = rows.texts() if len(large) else []
    for k in large:
        if WHOLE.fullmatch(texts[k]):
            try:
                check_whole(int(texts[k]), variable, "")
            except ConfigError:  # only then the file is read again for the line
                check_whole(int(texts[k]), variable, rows.at(int(k), 1))


def _sine(sine: Sine, clock: Clock) -> TimeFunction:
    delay = _on_point(sine.delay, clock)

    def values(t: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(over="ignore", invalid="ignore"):  # the engine refuses what is not finite
            swing = sine.amplitude * np.sin(2.0 * math.pi * (t - delay) / sine.period + sine.phase)
            return sine.mean + np.where(t >= delay, swing, 0.0)

    return values


def _ramp(ramp: Ramp, place: str, clock: Clock) -> TimeFunction:
    low, high = -math.inf, math.inf
    delay = _on_point(ramp.delay, clock)
    if ramp.end is not None:
        if ramp.end != ramp.start and not (ramp.end - ramp.start) * ramp.slope > 0.0:
            raise ConfigError(
                f"{place}: a ramp from {ramp.start} with slope {ramp.slope} per s never reaches {ramp.end}"
            )
        low, high = sorted((ramp.start, ramp.end))

    def values(t: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(over="ignore", invalid="ignore"):
            return np.clip(ramp.start + ramp.slope * np.maximum(t - delay, 0.0), low, high)

    return values


def _on_point(time: float, clock: Clock) -> float:
    return float(clock.on_points(np.array([time]))[0])


class Rows:
    """The rows of a table for messages: the `place` of the table, and the CSV file that it is read from.

    `time` and `value` are columns of the file.
    """

    def __init__(self, place: str, file: CsvFile | None = None, time: int = 0, value: int = 0) -> None:
        self.place, self.time, self.value = place, time, value
        self._file = file

    def at(self, row: int, column: Literal[0, 1]) -> str:
        """Return the place of the time (column 0) or the value (1) of a row."""
        if self._file is None:
            return f"{self.place}: row {row + 1}"
        name = self._file.names[(self.time, self.value)[column]]
        return f"{self._file.path}: line {self._file.line_of(row)}, column '{name}'"

    def texts(self) -> list[str]:
        """Return the cells of the column of values."""
        return [] if self._file is None else self._file.texts(self.value)


def _table(
    times: NDArray[np.float64], values: NDArray[np.float64], interpolation: Interpolation, rows: Rows
) -> TimeFunction:
    """Return the function of a table. Raises ConfigError naming the row that no function has."""
    check_times(times, rows)
    if interpolation == "hold":
        return held(times, values)
    _check_differences(values, rows)
    return _Table(times, values, "linear")


def held(times: NDArray[np.float64], values: NDArray[np.float64]) -> TimeFunction:
    """Return the function that holds each value, shape (n,), until the next time [s], shape (n,)."""
    return _Table(times, values, "hold")


def check_times(times: NDArray[np.float64], rows: Rows) -> None:
    """Raise ConfigError naming the row unless there are times [s], shape (n,), that never go back.

    They are times of a run: one that is none says what date it looks like.
    """
    if len(times) == 0:
        raise ConfigError(f"{rows.place}: there is no row")
    # two equal times are a jump: the later row holds from that time on
    backward = np.flatnonzero(times[1:] < times[:-1])
    if len(backward):
        row = int(backward[0]) + 1
        raise ConfigError(f"{rows.at(row, 0)}: time goes back from {times[row - 1]} s to {times[row]} s")
    beyond = np.flatnonzero(np.abs(times) > LATEST)
    if len(beyond):
        check_seconds(float(times[beyond[0]]), rows.at(int(beyond[0]), 0))


@dataclasses.dataclass(frozen=True)
class _Table:
    """The function of a table of `times` [s] and `values`, shapes (n,)."""

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    interpolation: Interpolation

    def __call__(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.interpolation == "linear":
            return _interpolate(t, self.times, self.values)
        return self.values[np.maximum(np.searchsorted(self.times, t, side="right") - 1, 0)]


def moves_between(entry: StimulusEntry, signal: TimeFunction) -> tuple[float, float]:
    """Return the times [s] from which on and until which the signal of an entry can change.

    A constant has no such times: they are infinite, as those without a begin or an end.
    """
    if entry.sine is not None:
        return entry.sine.delay, math.inf
    if entry.ramp is not None:
        return entry.ramp.delay, math.inf
    if isinstance(signal, _Table) and entry.constant is None:
        end = float(signal.times[-1]) if len(signal.times) > 1 else math.inf  # one row is a constant
        return float(signal.times[0]), end
    return -math.inf, math.inf


def initial_value(signal: TimeFunction, start_time: float) -> float:
    """Return the value of a stimulus for the initialization, at the start time [s].

    That is its value there; a jump of a table at the start time itself comes after the initialization.
    """
    if isinstance(signal, _Table):
        (rows,) = np.nonzero(signal.times == start_time)
        if len(rows) > 1:
            return float(signal.values[rows[0]])
    return float(signal(np.array([start_time]))[0])


def _check_differences(column: NDArray[np.float64], rows: Rows) -> None:
    """Raise ConfigError where the difference of two values, shape (n,), overflows."""
    with np.errstate(over="ignore"):
        beyond = np.flatnonzero(~np.isfinite(np.diff(column)))
    if len(beyond):
        row = int(beyond[0]) + 1
        raise ConfigError(
            f"{rows.at(row, 1)}: {column[row]} is too far from {column[row - 1]} in the row above for a "
            f'straight line between them; interpolation = "hold" needs none'
        )


def _interpolate(
    t: NDArray[np.float64], times: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    after = np.searchsorted(times, t, side="right")
    left, right = np.maximum(after - 1, 0), np.minimum(after, len(times) - 1)
    span = times[right] - times[left]
    share = np.where(span > 0.0, (t - times[left]) / np.where(span > 0.0, span, 1.0), 0.0)
    return values[left] + np.clip(share, 0.0, 1.0) * (values[right] - values[left])


def csv_of(entry: StimulusEntry, place: str, beside: Path | None) -> tuple[CsvFile, Rows]:
    """Return the CSV file of an entry and its columns.

    The time is the column of the name `time_column`, else that whose name says so (`csv_text.time_column`);
    the values are in that of the name `column`, else in the first one beside the time that has a name. What
    stands in the others counts for nothing. Raises ConfigError where there is no such file or column.
    """
    assert entry.csv is not None  # the entry has exactly one kind
    path = data_file(entry.csv, beside, f"{place}.csv") if beside else Path(entry.csv)
    file = CsvFile.of(path)
    every = [j for j, name in enumerate(file.names) if name]
    if len(every) < 2:
        raise ConfigError(
            f"{path}: line {max(1, file.header_lines)}: a header of two or more column names is needed, not "
            f"{list(file.named)}"
        )
    file.last_line_without_end()  # raises for results that were cut off
    time = file.time_column() if entry.time_column is None else _column(file, entry.time_column, every)
    others = [j for j in every if j != time]
    value = _column(file, file.names[others[0]] if entry.column is None else entry.column, others)
    return file, Rows(f"{path}", file, time, value)


def read_times(file: CsvFile, rows: Rows) -> NDArray[np.float64]:
    """Return the times [s] of a CSV file, shape (n,). Raises ConfigError naming the row that has none."""
    times = file.numbers((rows.time,))[:, 0]
    check_times(times, rows)
    return times


def _column(file: CsvFile, name: str, among: Sequence[int]) -> int:
    """Return the place of the column of a name. Raises ConfigError where there is none, or several."""
    found = [j for j in among if file.names[j] == name]
    if len(found) == 1:
        return found[0]
    names = [file.names[j] for j in among]
    if found:
        place = f"{file.path}: line {file.header_lines}"
        raise ConfigError(f"{place}: {both(file.names, found)} both have this name: which is meant?")
    raise ConfigError(
        f"{file.path}: there is no column '{name}'{nearest(name, names)}; columns: {', '.join(names)}"
    )
