"""Signals that drive free inputs, as functions of time evaluated for many communication points at once."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..csv_numbers import CsvFile
from ..errors import ConfigError, nearest
from .scenario import Interpolation, Ramp, Sine, StimulusEntry
from .toml import data_file

TimeFunction = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Values, shape (n,), of a stimulus at the times [s], shape (n,)."""


def stimulus(entry: StimulusEntry, place: str, beside: Path | None) -> TimeFunction:
    """The signal that an entry describes, in the entry's own unit.

    `place` is the entry's in the scenario file `beside`, from which a csv path is looked up. Raises
    ConfigError naming `place` with the key, rule and values.
    """
    if entry.constant is not None:
        return _table(np.zeros(1), np.array([entry.constant]), "hold", f"{place}.constant")
    if entry.sine is not None:
        return _sine(entry.sine)
    if entry.ramp is not None:
        return _ramp(entry.ramp, f"{place}.ramp")
    if entry.table is not None:
        points = np.array(entry.table, dtype=float).reshape(-1, 2)
        return _table(points[:, 0], points[:, 1], entry.interpolation, f"{place}.table")
    assert entry.csv is not None  # the entry has exactly one kind
    path = data_file(entry.csv, beside, f"{place}.csv") if beside else Path(entry.csv)
    times, values = read_columns(path, entry.column)
    return _table(times, values, entry.interpolation, f"{place}.csv: {path}")


def _sine(sine: Sine) -> TimeFunction:
    def values(t: NDArray[np.float64]) -> NDArray[np.float64]:
        swing = sine.amplitude * np.sin(2.0 * math.pi * (t - sine.delay) / sine.period + sine.phase)
        return sine.mean + np.where(t >= sine.delay, swing, 0.0)

    return values


def _ramp(ramp: Ramp, place: str) -> TimeFunction:
    low, high = -math.inf, math.inf
    if ramp.end is not None:
        if ramp.end != ramp.start and not (ramp.end - ramp.start) * ramp.slope > 0.0:
            raise ConfigError(
                f"{place}: a ramp from {ramp.start} with slope {ramp.slope} per s never reaches {ramp.end}"
            )
        low, high = sorted((ramp.start, ramp.end))

    def values(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.clip(ramp.start + ramp.slope * np.maximum(t - ramp.delay, 0.0), low, high)

    return values


def _table(
    times: NDArray[np.float64], values: NDArray[np.float64], interpolation: Interpolation, place: str
) -> TimeFunction:
    if len(times) == 0:
        raise ConfigError(f"{place}: the table is empty")
    finite = np.isfinite(times) & np.isfinite(values)
    if not finite.all():
        row = int(np.argmin(finite))
        raise ConfigError(f"{place}: row {row + 1} is ({times[row]}, {values[row]}), not two finite numbers")
    # two equal times are a jump: the later row holds from that time on
    backward = np.flatnonzero(np.diff(times) < 0.0)
    if len(backward):
        row = int(backward[0])
        raise ConfigError(
            f"{place}: time goes back from {times[row]} s to {times[row + 1]} s in row {row + 2}"
        )

    if interpolation == "linear":
        return lambda t: _interpolate(t, times, values)
    return lambda t: values[np.maximum(np.searchsorted(times, t, side="right") - 1, 0)]


def _interpolate(
    t: NDArray[np.float64], times: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    after = np.searchsorted(times, t, side="right")
    left, right = np.maximum(after - 1, 0), np.minimum(after, len(times) - 1)
    span = times[right] - times[left]
    share = np.where(span > 0.0, (t - times[left]) / np.where(span > 0.0, span, 1.0), 0.0)
    return values[left] + np.clip(share, 0.0, 1.0) * (values[right] - values[left])


def read_columns(path: Path, column: str | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the time [s] and one column (default: the second) of a CSV file with a header, shapes (n,).

    The time is the first column. What stands in the others counts for nothing, nor do empty lines. Raises
    ConfigError naming file, line, column and value where a number is missing or is none, and where there is
    no such column or no row.
    """
    file = CsvFile.of(path)
    names = file.names
    if len(names) < 2:
        raise ConfigError(
            f"{path}: line 1: a header of two or more column names is needed, not {list(names)}"
        )
    if column is not None and column not in names[1:]:
        raise ConfigError(
            f"{path}: there is no column '{column}'{nearest(column, names[1:])}; "
            f"columns: {', '.join(names[1:])}"
        )
    table = file.numbers((0, names.index(column, 1) if column is not None else 1), empty_lines=True)
    if not len(table):
        raise ConfigError(f"{path}: there is no row below the header")
    return table[:, 0].copy(), table[:, 1].copy()
