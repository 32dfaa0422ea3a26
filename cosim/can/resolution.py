"""A signal in another resolution than its DBC gives it (the setting `resolution` of a bus)."""

from __future__ import annotations

import dataclasses

from .bus_settings import Resolution
from .database import Signal


def with_resolution(signal: Signal, resolution: Resolution) -> Signal:
    """Return the signal, coarser by a factor: its scale multiplied, minimum and maximum as they are.

    "ideal": a value in range arrives as it was sent, one out of range as the limit that it would meet in the
    DBC's signal, of which the last raw value is one. A float signal has no resolution that a factor changes.
    """
    if resolution == "ideal":
        low, high = physical_range(signal)
        return dataclasses.replace(
            signal, scale=1, offset=0, minimum=low, maximum=high, is_float=True, length=64,
            start_raw=signal.start_raw * signal.scale + signal.offset, not_available=None, choices={},
        )  # fmt: skip # what changes, then what follows from it
    if signal.is_float or resolution == 1.0:
        return signal
    scale = signal.scale * resolution
    # whole scales stay integers, with which large values are computed exactly (see `quantization`)
    whole = isinstance(signal.scale, int) and float(scale).is_integer()
    return dataclasses.replace(signal, scale=int(scale) if whole else scale)


def physical_range(signal: Signal) -> tuple[float, float]:
    """Return the least and the greatest value that can arrive, in the signal's unit."""
    ends = sorted(float(raw * signal.scale + signal.offset) for raw in signal.raw_range)
    low = ends[0] if signal.minimum is None else max(ends[0], signal.minimum)
    high = ends[1] if signal.maximum is None else min(ends[1], signal.maximum)
    return low, high
