"""The definition of a CAN signal's effect on a value, and the constants that every engine computes with.

In the unit of the DBC signal, a value x becomes

    s = x saturated to [minimum, maximum]                                                  (1)
    q = (s - offset) / scale                                                               (2)
    n = q rounded to an integer (a float signal: as it is)                                 (3)
    r = n clipped to the raw range (a float signal: then rounded to its 32 or 64 bits)     (4)
    y = scale * r + offset                                                                 (5)

Public codecs disagree on (3) and on values out of range, so both are settings of a bus. `rounding`, in (3):

    nearest     to the nearest integer, a half away from zero (2.5 -> 3, -2.5 -> -3)
    half_even   to the nearest integer, a half to the even one (2.5 -> 2), as cantools
    truncate    toward zero (2.9 -> 2, -2.9 -> -2), as C code that casts, for example cantools'. A value that
                has crossed such a bus may lose one more raw step on the next one

`overflow`, a value outside [minimum, maximum] or the raw range:

    saturate    (1) and (4) send the nearest limit; +-Inf too
    wrap        as C code without a range check: (1) is left out, and (4) keeps the low bits of the integer
                (120 % in 8 bits of 0.4 % arrives as 17.6 %). A float becomes +-Inf. +-Inf has no low bits and
                is a ChannelError in an integer signal
    error       it is a ChannelError; +-Inf too

NaN is a ChannelError always.

`reference` computes this one line at a time; the generated code is tested against it. For values in range and
rounding "half_even" it is what encode and decode of cantools give, bit for bit.

`operation` folds a signal and the settings of its bus into a SignalOperation. Since (1) to (4) are monotone,
all values that nothing saturates lie in one interval [low, high], so an engine compares twice, then computes
(2), (3), (5); every value outside becomes one of two constants. This is exact: low and high are doubles, and
the next double outside saturates.
"""

from __future__ import annotations

import dataclasses
import math
import struct
import sys
from collections.abc import Callable
from typing import Literal, NamedTuple, assert_never

from ..errors import ConfigError, RunError
from .bus_settings import BusSettings, Rounding
from .database import Signal

Kind = Literal["integer", "exact", "float32", "float64"]

_EXACT = 2.0**50  # up to here every rounding of the generated code is exact in doubles, with a margin


class ChannelError(RunError):
    """A value that a channel cannot carry: `signal`, `value` in the DBC signal's unit, and the `rule`."""

    def __init__(self, signal: str, value: float, rule: str) -> None:
        super().__init__(f"{signal}: {rule}")
        self.signal, self.value, self.rule = signal, value, rule


def reference(signal: Signal, settings: BusSettings, value: float) -> tuple[int | float, float]:
    """Return the raw value that is sent for `value`, and the value received; both values in the signal's
    unit.

    Raises ChannelError for NaN and for what `settings` make an error.
    """
    if math.isnan(value):
        raise ChannelError(signal.name, value, "the value is NaN")
    x = value if wraps(settings) else _saturate(signal, value)  # (1)
    n = quantize(signal, settings.rounding, x)  # (2), (3)
    low, high = signal.raw_range
    raw: int | float
    match settings.overflow:  # (4)
        case "wrap":
            raw = _wrap(signal, n, value)
        case "saturate":
            raw = _clip(signal, n)
        case "error":
            if x != value or not low <= n <= high:
                raise ChannelError(
                    signal.name, value, f"the value {value!r} is outside {_range_text(signal)}"
                )
            raw = _clip(signal, n)
        case _:
            assert_never(settings.overflow)
    return raw, decode(signal, raw)  # (5)


def wraps(settings: BusSettings) -> bool:
    """Return True where step (1) is left out, and (4) keeps the low bits."""
    match settings.overflow:
        case "wrap":
            return True
        case "saturate" | "error":
            return False
        case _:
            assert_never(settings.overflow)


def quantize(signal: Signal, rounding: Rounding, x: float) -> int | float:
    """Return n of steps (2) and (3) for x in the signal's unit: not clipped; +-inf beyond all doubles."""
    q = (x - signal.offset) / signal.scale
    if signal.is_float or math.isinf(q):
        return q
    match rounding:
        case "half_even":
            return round(q)
        case "truncate":
            return math.trunc(q)
        case "nearest":
            whole = math.trunc(q)
            if abs(q - whole) >= 0.5:  # the difference is exact
                whole += 1 if q > 0 else -1
            return whole
        case _:
            assert_never(rounding)


def decode(signal: Signal, raw: int | float) -> float:
    """Return y of step (5), in the signal's unit. Integer scale and offset: in integers, rounded once, as
    cantools does."""
    if signal.scale == 1 and signal.offset == 0:
        return float(raw)
    return float(raw * signal.scale + signal.offset)


def _saturate(signal: Signal, x: float) -> float:
    if signal.minimum is not None and x < signal.minimum:
        return signal.minimum
    if signal.maximum is not None and x > signal.maximum:
        return signal.maximum
    return x


def _clip(signal: Signal, n: int | float) -> int | float:
    low, high = signal.raw_range
    if n < low:
        return low
    if n > high:
        return high
    return _to_float(signal, n) if signal.is_float else n


def _wrap(signal: Signal, n: int | float, value: float) -> int | float:
    if signal.is_float:
        return _to_float(signal, n)
    if math.isinf(n):
        raise ChannelError(signal.name, value, f"the value {value!r} has no low bits to wrap to")
    low = int(signal.raw_type_range[0])
    return (int(n) - low) % (1 << signal.length) + low


def _to_float(signal: Signal, q: float) -> float:
    """Return q in the signal's floating-point format, to nearest even; beyond its range Inf, as a C cast."""
    if signal.length == 64:
        return q
    try:
        return float(struct.unpack("<f", struct.pack("<f", q))[0])
    except OverflowError:
        return math.copysign(math.inf, q)


def _range_text(signal: Signal) -> str:
    low = signal.minimum if signal.minimum is not None else "-inf"
    high = signal.maximum if signal.maximum is not None else "inf"
    first, last = signal.raw_range
    return f"[{low}, {high}] {signal.unit} or raw {first!r} to {last!r}".replace("]  or", "] or")


@dataclasses.dataclass(frozen=True)
class SignalOperation:
    """The constants of one signal on one bus, for an engine.

    A value with `low` <= x <= `high`, in the signal's unit, is sent as raw = rounding((x - offset) / scale)
    and received as raw * scale + offset. Any other value saturates (or wraps, or is an error:
    `settings.overflow`): `raw_above` is sent for one above `high`, `raw_below` for one below `low` (both None
    unless overflow is "saturate"). `kind` is the arithmetic that is exact: "integer": doubles, since |raw| <=
    2**50; "exact": integers of any size (`quantize` and `decode`); "float32", "float64": no rounding, but to
    that format.
    """

    signal: Signal
    kind: Kind
    settings: BusSettings
    scale: float
    offset: float
    low: float
    high: float
    raw_below: int | float | None
    raw_above: int | float | None

    @property
    def adds_offset(self) -> bool:
        """True when decoding adds the offset: one of 0.0 makes 0.0 of -0.0, where there can be one."""
        if self.scale == 1.0 and self.offset == 0.0:
            return False
        return bool(self.offset) or self.scale < 0 or self.kind != "integer"


def operation(signal: Signal, settings: BusSettings) -> SignalOperation:
    """Return the constants of a signal under the settings of its bus.

    Raises ConfigError when no value at all can be sent.
    """
    about = repr((
        *(signal.length, signal.signed, signal.is_float, signal.scale, signal.offset),
        *(signal.minimum, signal.maximum, signal.not_available, settings.rounding, settings.overflow),
    ))  # fmt: skip # in words, since -0.0 equals 0.0, and 1 equals 1.0
    if (limits := _limits.get(about)) is None:
        limits = _limits_of(signal, settings)
        if len(_limits) >= _MOST_LIMITS:
            _limits.clear()
        _limits[about] = limits
    if limits.low > limits.high:
        raise ConfigError(f"signal '{signal.name}': no value in {_range_text(signal)} can be sent")
    scale, offset = float(signal.scale), float(signal.offset)
    return SignalOperation(signal, _kind(signal), settings, scale, offset, *limits)


class _Limits(NamedTuple):
    """The numbers of a SignalOperation that are searched for, and do not depend on a signal's name."""

    low: float
    high: float
    raw_below: int | float | None
    raw_above: int | float | None


_limits: dict[str, _Limits] = {}
"""Those that this process has found, by all that they depend on."""
_MOST_LIMITS = 4096


def _limits_of(signal: Signal, settings: BusSettings) -> _Limits:
    low, high = _unsaturated(signal, settings)
    if low > high or settings.overflow != "saturate":
        return _Limits(low, high, None, None)
    below, above = (reference(signal, settings, end)[0] for end in (-math.inf, math.inf))
    return _Limits(low, high, below, above)


def _kind(signal: Signal) -> Kind:
    if signal.is_float:
        return "float32" if signal.length == 32 else "float64"
    # cantools computes with integers while scale and offset are integers: the same in doubles while small
    raw = max(abs(r) for r in signal.raw_type_range)
    product = raw * abs(signal.scale) if isinstance(signal.scale, int) else 0
    total = product + abs(signal.offset) if isinstance(signal.offset, int) else product
    return "integer" if max(raw, product, total) <= _EXACT else "exact"


def _unsaturated(signal: Signal, settings: BusSettings) -> tuple[float, float]:
    """Return the least and the greatest x, in the signal's unit, that steps (1) and (4) leave alone."""
    first, last = signal.raw_type_range if wraps(settings) else signal.raw_range

    def too_low(x: float) -> bool:
        n = quantize(signal, settings.rounding, x)
        return n < first if signal.scale > 0 else n > last

    def too_high(x: float) -> bool:
        n = quantize(signal, settings.rounding, x)
        return n > last if signal.scale > 0 else n < first

    low, high = _first_double(lambda x: not too_low(x)), -_first_double(lambda x: not too_high(-x))
    if not wraps(settings):
        low = low if signal.minimum is None else max(low, float(signal.minimum))
        high = high if signal.maximum is None else min(high, float(signal.maximum))
    return low, high


def _first_double(holds: Callable[[float], bool]) -> float:
    """Return the least finite double at which `holds`, which stays true from there on; Inf: it never does."""
    low, high = -_rank(sys.float_info.max), _rank(sys.float_info.max)
    if not holds(_double(high)):
        return math.inf
    while low < high:
        middle = (low + high) // 2
        if holds(_double(middle)):
            high = middle
        else:
            low = middle + 1
    return _double(high)


def _rank(x: float) -> int:
    """Return the place of a double in the order of all doubles, 0.0 being 0."""
    bits: int = struct.unpack("<q", struct.pack("<d", abs(x)))[0]
    return bits if x >= 0 else -bits


def _double(rank: int) -> float:
    """Return the double of a rank."""
    x: float = struct.unpack("<d", struct.pack("<q", abs(rank)))[0]
    return x if rank >= 0 else -x
