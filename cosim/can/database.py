"""CAN databases as records of our own, and the rules that a channel relies on.

The words are those of cantools: a raw value is what a frame holds, physical = scale * raw + offset. Rules on
one message or signal are checked by `require`, so that a message that no connection uses cannot stop a run.
"""

from __future__ import annotations

import dataclasses
import math
import struct
import sys
from pathlib import Path

from ..errors import ConfigError, nearest
from .timing.arbitration import arbitration_key
from .timing.lengths import FD_LENGTHS, fd_length

LONGEST = 1785
"""Bytes of the longest message, which several frames transport."""
_FRAME = FD_LENGTHS[-1]
_FLOAT_MAX = {32: struct.unpack("<f", b"\xff\xff\x7f\x7f")[0], 64: math.ldexp(2.0 - 2.0**-52, 1023)}


@dataclasses.dataclass(frozen=True)
class Signal:
    """One signal of a message.

    `start` is the DBC start bit: of the least significant bit where `little_endian`, else of the most
    significant one. `scale` and `offset` are int where the physical values of all raw values are
    integers, as in cantools. `minimum`, `maximum` are physical, in `unit`; None: no limit. `start_raw` is
    the raw value that is sent until a value is known; `not_available` the raw code that says that there
    is no value. A frame holds a multiplexed signal where the raw value of its `multiplexer` is in one of the
    `multiplexer_ranges`, both ends included; "" and () for a signal of all frames.

    `send_type` is the text of the attribute GenSigSendType, `inactive_raw` the raw value at which a message
    that is sent if it is active is not (None: `start_raw`).
    `problem` is why the signal cannot be used, "" for nothing; `note` what its user should know; `line` is
    where it stands in the file, 0 where that has no lines.
    """

    name: str
    start: int
    length: int
    little_endian: bool = True
    signed: bool = False
    is_float: bool = False
    scale: float | int = 1
    offset: float | int = 0
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    choices: dict[int, str] = dataclasses.field(default_factory=dict)
    start_raw: float | int = 0
    not_available: int | None = None
    multiplexer: str = ""
    multiplexer_ranges: tuple[tuple[int, int], ...] = ()
    is_multiplexer: bool = False
    comment: str = ""
    receivers: tuple[str, ...] = ()
    send_type: str = ""
    inactive_raw: float | int | None = None
    problem: str = ""
    note: str = dataclasses.field(default="", compare=False)
    line: int = dataclasses.field(default=0, compare=False)

    @property
    def raw_type_range(self) -> tuple[int, int] | tuple[float, float]:
        """Least and greatest raw value that `length` bits hold (of a float: the finite ones)."""
        if self.is_float:
            return -_FLOAT_MAX[self.length], _FLOAT_MAX[self.length]
        if self.signed:
            return -(1 << self.length - 1), (1 << self.length - 1) - 1
        return 0, (1 << self.length) - 1

    @property
    def raw_range(self) -> tuple[int, int] | tuple[float, float]:
        """Least and greatest raw value that may be sent: `not_available` at an end is left out."""
        low, high = self.raw_type_range
        return low + (low == self.not_available), high - (high == self.not_available)

    @property
    def has_steps(self) -> bool:
        """True where scale and offset are numbers with which raw values can be told apart."""
        return self.scale != 0 and math.isfinite(self.scale) and math.isfinite(self.offset)

    @property
    def bits(self) -> tuple[int, ...]:
        """The bits in the message, least significant first; bit b is bit b % 8 of byte b // 8."""
        if self.little_endian:
            return tuple(range(self.start, self.start + self.length))
        # Motorola: from the most significant bit down to bit 0 of a byte, then bit 7 of the next byte
        position = 8 * (self.start // 8) + 7 - self.start % 8
        downward = range(position, position + self.length)
        return tuple(8 * (p // 8) + 7 - p % 8 for p in reversed(downward))


@dataclasses.dataclass(frozen=True)
class Message:
    """One message.

    `length` is in bytes, `own_length` that without the bytes that its frame adds (0: it adds none),
    `cycle_time` (None: not sent cyclically) and `start_delay` are in s. `file` is
    where the message stands, for error messages. `j1939` is True for a parameter group: more than 8 bytes
    are several frames then, and no CAN FD. `send_type` is the text of the attribute GenMsgSendType,
    `min_interval` and `fast_cycle` [s] the times of GenMsgDelayTime and GenMsgCycleTimeFast, and `attributes`
    are the texts of all that the file gives the message itself.

    `problem` and `line` are as those of a signal; `unread` are the names of signals that could not be read,
    each with the reason.
    """

    file: str
    name: str
    frame_id: int
    extended: bool = False
    length: int = 8
    cycle_time: float | None = None
    start_delay: float = 0.0
    senders: tuple[str, ...] = ()
    signals: dict[str, Signal] = dataclasses.field(default_factory=dict)
    fd: bool = False
    j1939: bool = False
    comment: str = ""
    send_type: str = ""
    min_interval: float = 0.0
    fast_cycle: float | None = None
    attributes: dict[str, str] = dataclasses.field(default_factory=dict)
    unread: dict[str, str] = dataclasses.field(default_factory=dict)
    problem: str = ""
    line: int = dataclasses.field(default=0, compare=False)
    own_length: int = 0

    @property
    def priority(self) -> int:
        """The number by which its frames win the arbitration: the least of those that start at once."""
        return arbitration_key(self.frame_id, self.extended)

    @property
    def frame_length(self) -> int:
        """Bytes of its frame: in CAN FD the next length that there is, where those that are added are 0."""
        return fd_length(self.length) if self.fd else self.length

    def require(self, name: str, place: str = "") -> Signal:
        """Return the signal `name`, fit for a channel.

        Raises ConfigError, which starts with `place` (of the connection), when there is none or it breaks a
        rule of `check_signal`.
        """
        if name in self.unread:
            raise ConfigError(f"{prefix(place)}{self.file}: {self.unread[name]}")
        if name not in self.signals:
            raise ConfigError(
                f"{prefix(place)}{self.file}: message '{self.name}' has no signal '{name}'"
                f"{nearest(name, self.signals)}; signals: {', '.join(self.signals) or 'none'}"
            )
        signal = self.signals[name]
        check_signal(self, signal, place)
        return signal


@dataclasses.dataclass(frozen=True)
class Database:
    """The messages of a file by name; `warnings` are its flaws, each with file, line and message."""

    path: Path
    messages: dict[str, Message]
    warnings: tuple[str, ...] = ()
    nodes: tuple[str, ...] = ()

    def require(self, name: str, place: str = "") -> Message:
        """Return the message `name`.

        Raises ConfigError, which starts with `place` (of the connection) and has the nearest name, when there
        is none.
        """
        if name not in self.messages:
            raise ConfigError(
                f"{prefix(place)}{self.path}: no message '{name}'{nearest(name, self.messages)}; "
                f"messages: {', '.join(self.messages) or 'none'}"
            )
        return self.messages[name]


def prefix(place: str) -> str:
    """Return the beginning of a message for `place`, which may be nothing."""
    return f"{place}: " if place else ""


def check_signal(message: Message, signal: Signal, place: str = "") -> None:
    """Raise ConfigError, which starts with `place`, when a receiver could read another value than was sent.

    The rules: neither message nor signal has a `problem`, and a frame holds the message; a finite scale other
    than 0 and a finite offset, with which all raw values are doubles; floats of 32 or 64 bits; minimum <=
    maximum, some value between them can be sent, and none of them is sent as the "not available" code.
    """
    # each relies on the one before: limits in raw steps need a scale
    if (
        problem := _message_problem(message)
        or signal.problem
        or _unsupported(signal)
        or _range_problem(signal)
    ):
        line = f"line {signal.line}: " if signal.line else ""
        raise ConfigError(f"{prefix(place)}{message.file}: {line}{message.name}.{signal.name}: {problem}")


def _message_problem(message: Message) -> str:
    """Return the rule that the message breaks, with the values; "" for none. So do the next two."""
    if message.problem:
        return message.problem
    if message.length > _FRAME:
        return f"the message has {message.length} bytes, and a frame holds {_FRAME} at most"
    if message.j1939 and message.length > 8:
        several = "J1939 sends it as several frames of 8 (transport protocol), which is not supported"
        return f"the message has {message.length} bytes; {several}"
    return ""


def _length_problem(signal: Signal) -> str:
    if signal.is_float and signal.length not in _FLOAT_MAX:
        return f"a float of {signal.length} bits; 32 or 64 are supported"
    return ""


def bits_text(signal: Signal) -> str:
    """Return the size of a signal in words, as "8 unsigned bits"."""
    if signal.is_float:
        return f"a {signal.length}-bit float"
    return f"{signal.length} {'signed' if signal.signed else 'unsigned'} bits"


def _unsupported(signal: Signal) -> str:
    if problem := _length_problem(signal):
        return problem
    if not signal.has_steps:
        rule = "the scale must be finite and not 0, the offset finite"
        return f"scale {signal.scale:.6g} and offset {signal.offset:.6g}: {rule}"
    if not signal.is_float and not all(
        math.isfinite(_physical(raw, signal)) for raw in signal.raw_type_range
    ):
        ends = f"scale {signal.scale:.6g} and offset {signal.offset:.6g}"
        return f"{ends}: raw values of {bits_text(signal)} are beyond {sys.float_info.max:.3g}"
    return ""


def _physical(raw: float | int, signal: Signal) -> float:
    """Return the value of a raw value; infinity beyond all doubles, and where a product on the way is."""
    return float(raw) * float(signal.scale) + float(signal.offset)


def _range_problem(signal: Signal) -> str:
    low, high = signal.minimum, signal.maximum
    if (low is not None and math.isnan(low)) or (high is not None and math.isnan(high)):
        return f"minimum {low} and maximum {high}: NaN is no limit"
    if low is not None and high is not None and low > high:
        return f"minimum {low} is above maximum {high}"
    if signal.is_float:
        return ""
    raw_low, raw_high, least, greatest = raw_limits(signal)
    if raw_low > raw_high:
        return f"no value in [{low}, {high}] fits into {bits_text(signal)}"
    code = signal.not_available
    if code is None or not raw_low <= code <= raw_high:
        return ""
    if (least is None and code == raw_low) or (greatest is None and code == raw_high):
        return ""  # no limit was written on that side, so the raw range ends before the code
    return (
        f"values in [{low}, {high}] are sent as raw {raw_low} to {raw_high}, but raw {code} means not "
        f"available; give the signal a minimum and maximum that leave {code} out"
    )


def raw_limits(signal: Signal) -> tuple[int, int, float | None, float | None]:
    """Return the least and the greatest raw value of any rounding to the nearest.

    The other two are minimum and maximum in raw steps, the one that limits the least raw value first; None:
    no limit.
    """
    limits = (signal.minimum, signal.maximum) if signal.scale > 0 else (signal.maximum, signal.minimum)
    least, greatest = (_in_raw_steps(limit, signal) if limit is not None else None for limit in limits)
    first, last = (int(raw) for raw in signal.raw_type_range)
    raw_low = first if least is None else max(first, math.ceil(least - 0.5))
    raw_high = last if greatest is None else min(last, math.floor(greatest + 0.5))
    return raw_low, raw_high, least, greatest


def _in_raw_steps(value: float, signal: Signal) -> float:
    """Return a physical value in raw steps, kept finite."""
    return max(-1e30, min(1e30, (value - signal.offset) / signal.scale))
