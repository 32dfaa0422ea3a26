"""Notes for the users of a signal: limits that no frame holds, and what its file says.

A limit m of a signal means the raw value (m - offset)/scale. Where that is no whole number, or one that the
bits do not hold, another value than m arrives for m, and perhaps one beyond it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from .bus_settings import BusSettings
from .database import Message, Signal, bits_text
from .quantization import ChannelError, reference, wraps
from .resolution import with_resolution

_DIGITS = 0.1  # raw steps: a limit that is off by less was written with few digits


def notes_on(
    message: Message, signal: Signal, via: str, settings: BusSettings, replayed: bool = False
) -> Iterator[str]:
    """Yield the notes for users of a signal on a bus, each with file and line; as in `limits_note`."""
    line = f"line {signal.line}: " if signal.line else ""
    for note in (signal.note, limits_note(signal, settings, replayed)):
        if note:
            yield f"{message.file}: {line}{via}: {note}"


def limits_note(signal: Signal, settings: BusSettings, replayed: bool = False) -> str:
    """Return a sentence on limits that are no raw values, with what arrives for them; "" for none.

    The signal is one that `check_signal` passes. Where the bus wraps, limits are left out. Frames that are
    `replayed` from a log have what their bytes say, whatever the bus does with others.
    """
    if signal.is_float or (wraps(settings) and not replayed):
        return ""
    written = (signal.minimum, signal.maximum)
    limits = [limit for limit in written if limit is not None and math.isfinite(limit)]
    beyond = [limit for limit in limits if not _is_raw(signal, limit)]
    arriving = [(limit, _arriving(signal, settings, limit)) for limit in beyond]
    said = [f"{found} for {limit:.9g}" for limit, found in arriving if found != f"{limit:.9g} arrives"]
    if replayed:
        said = [f"no frame of a log has {limit:.9g}" for limit in beyond]
    if not said:
        return ""
    means = " to ".join(f"{_raw(signal, limit):.9g}" for limit in limits)
    low, high = signal.raw_type_range
    ends = ", ".join("none" if x is None else f"{x:.9g}" for x in written)
    unit = f" {signal.unit}" if signal.unit else ""
    return (
        f"its limits [{ends}]{unit} mean raw {means}, and {bits_text(signal)} have the whole raw values "
        f"{low} to {high}: {', and '.join(said)}"
    )


def _raw(signal: Signal, limit: float) -> float:
    return (limit - signal.offset) / signal.scale


def _is_raw(signal: Signal, limit: float) -> bool:
    raw = _raw(signal, limit)
    low, high = signal.raw_type_range
    if not math.isfinite(raw):
        return False
    return low - _DIGITS <= raw <= high + _DIGITS and abs(raw - round(raw)) <= _DIGITS


def _arriving(signal: Signal, settings: BusSettings, limit: float) -> str:
    """Return what a receiver sees for a limit, in words."""
    try:
        _, value = reference(with_resolution(signal, settings.resolution), settings, limit)
    except ChannelError:
        return "the run ends with an error"
    return f"{value:.9g} arrives"
