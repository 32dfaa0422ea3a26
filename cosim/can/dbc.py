"""CAN databases (DBC): messages and signals as records of our own, and the rules that a channel relies on.

cantools reads the file, strictly: what it refuses is refused here, said with the file and the bits.
The words are those of cantools: a raw value is what stands in the frame, physical = scale * raw + offset.

Rules on the whole file hold when it is loaded. Rules on one message or signal hold when a connection
asks for it with `require`, so that a message nobody uses cannot stop a run.
"""

from __future__ import annotations

import dataclasses
import math
import re
import struct
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import ConfigError, nearest

_MILLISECOND = Fraction(1, 1000)
_NOT_AVAILABLE = {"sna", "notavailable", "signalnotavailable"}
_FLOAT_MAX = {32: struct.unpack("<f", b"\xff\xff\x7f\x7f")[0], 64: math.ldexp(2.0 - 2.0**-52, 1023)}


@dataclasses.dataclass(frozen=True)
class Signal:
    """One signal of a message.

    `start` is the DBC start bit: of the least significant bit where `little_endian`, else of the most
    significant one. `scale` and `offset` are int where the physical values of all raw values are
    integers, as in cantools. `minimum`, `maximum` are physical, in `unit`; None: no limit. `start_raw` is
    the raw value that is sent until a value is known; `not_available` the raw code that says that there
    is no value. `multiplexer_ids` is empty unless the signal is multiplexed.
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
    multiplexer_ids: tuple[int, ...] = ()
    is_multiplexer: bool = False
    comment: str = ""

    @property
    def raw_type_range(self) -> tuple[int, int] | tuple[float, float]:
        """Least and greatest raw value that `length` bits hold (for a float: finite value)."""
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

    `length` is in bytes, `cycle_time` (None: not sent cyclically) and `start_delay` are in s. `file` is
    where the message stands, for error messages.
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
    comment: str = ""

    @property
    def multiplexed(self) -> bool:
        """Whether a signal selects which other signals a frame holds."""
        return any(s.is_multiplexer for s in self.signals.values())

    def require(self, name: str, place: str = "") -> Signal:
        """The signal `name`, fit for a channel.

        Raises ConfigError, which starts with `place` (who asks), when there is none or it breaks a rule of
        `check_signal`.
        """
        if name not in self.signals:
            raise ConfigError(
                f"{_prefix(place)}{self.file}: message '{self.name}' has no signal '{name}'"
                f"{nearest(name, self.signals)}; signals: {', '.join(self.signals) or 'none'}"
            )
        signal = self.signals[name]
        check_signal(self, signal, place)
        return signal


@dataclasses.dataclass(frozen=True)
class Database:
    """The messages of a DBC file, by name."""

    path: Path
    messages: dict[str, Message]

    def require(self, name: str, place: str = "") -> Message:
        """The message `name`, or ConfigError, which starts with `place`, with the nearest one there is."""
        if name not in self.messages:
            raise ConfigError(
                f"{_prefix(place)}{self.path}: no message '{name}'{nearest(name, self.messages)}; "
                f"messages: {', '.join(self.messages) or 'none'}"
            )
        return self.messages[name]


def _prefix(place: str) -> str:
    return f"{place}: " if place else ""


def load_dbc(path: str | Path) -> Database:
    """Read a DBC file in UTF-8 or, where it is not valid UTF-8, in cp1252 (the usual encoding of DBC files).

    Raises ConfigError when the file cannot be read, is no DBC (with the line), has signals that overlap or
    do not fit into their message, or gives a name or frame id twice.
    """
    path = Path(path)
    database = _parse(path, _read(path))
    messages = [_message(path, m) for m in database.messages]
    for parsed, message in zip(database.messages, messages, strict=True):
        _refuse_twice(message, "signal", [s.name for s in parsed.signals])
        _check_layout(parsed, message)
    _refuse_twice(path, "message", [m.name for m in messages])
    _refuse_twice(path, "frame id", [f"{m.frame_id:#x}{' (extended)' * m.extended}" for m in messages])
    return Database(path, {m.name: m for m in messages})


def _read(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigError(f"{path}: cannot read the CAN database: {error.strerror or error}") from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")  # as cantools does: five bytes have no meaning


def _parse(path: Path, text: str) -> Any:
    import cantools.database  # 0.2 s, and only a system with a bus needs it

    try:
        return cantools.database.load_string(text, "dbc", strict=False)
    except cantools.database.UnsupportedDatabaseFormatError as error:
        reason = error.e_dbc or error
        line = getattr(reason, "line", None)
        if line is None:
            raise ConfigError(f"{path}: not a valid DBC file: {reason}") from error
        lines = text.splitlines() or [""]
        shown = lines[min(line, len(lines)) - 1].strip()
        raise ConfigError(f"{path}: line {line}: not valid in a DBC file: '{shown[:80]}'") from error


def _message(path: Path, parsed: Any) -> Message:
    delay = _attribute(parsed.dbc, "GenMsgStartDelayTime", default=True) or 0
    return Message(
        file=str(path),
        name=parsed.name,
        frame_id=parsed.frame_id,
        extended=parsed.is_extended_frame,
        length=parsed.length,
        cycle_time=_seconds(parsed.cycle_time) if parsed.cycle_time else None,
        start_delay=_seconds(delay),
        senders=tuple(parsed.senders),
        signals={s.name: _signal(s) for s in parsed.signals},
        fd=parsed.is_fd,
        comment=parsed.comment or "",
    )


def _signal(parsed: Any) -> Signal:
    scale, offset = parsed.conversion.scale, parsed.conversion.offset
    if not parsed.is_float and float(scale).is_integer() and float(offset).is_integer():
        scale, offset = int(scale), int(offset)
    start = parsed.raw_initial or 0
    return Signal(
        name=parsed.name,
        start=parsed.start,
        length=parsed.length,
        little_endian=parsed.byte_order == "little_endian",
        signed=parsed.is_signed,
        is_float=parsed.is_float,
        scale=scale,
        offset=offset,
        minimum=parsed.minimum,
        maximum=parsed.maximum,
        unit=parsed.unit or "",
        choices={int(raw): str(text) for raw, text in (parsed.choices or {}).items()},
        start_raw=int(start) if not parsed.is_float and float(start).is_integer() else start,
        not_available=_not_available(parsed),
        multiplexer_ids=tuple(parsed.multiplexer_ids or ()),
        is_multiplexer=parsed.is_multiplexer,
        comment=parsed.comment or "",
    )


def _not_available(parsed: Any) -> int | None:
    """The raw code by attribute GenSigSNA, else by a value description such as "SNA"."""
    if parsed.is_float:
        return None
    given = _attribute(parsed.dbc, "GenSigSNA")
    named = (raw for raw, text in (parsed.choices or {}).items() if _says_not_available(str(text)))
    if given is None and (given := next(named, None)) is None:
        return None
    code = int(given)
    if parsed.is_signed and code >= 1 << parsed.length - 1:  # written as a bit pattern
        code -= 1 << parsed.length
    return code


def _says_not_available(text: str) -> bool:
    return re.sub(r"[\s_-]", "", text).casefold() in _NOT_AVAILABLE


def _attribute(specifics: Any, name: str, default: bool = False) -> Any:
    """An attribute's own value; where it has none and `default`, the file's default for it."""
    if specifics is None:
        return None
    if name in (specifics.attributes or {}):
        return specifics.attributes[name].value
    definition = (specifics.attribute_definitions or {}).get(name) if default else None
    return definition.default_value if definition is not None else None


def _seconds(milliseconds: float) -> float:
    return float(Fraction(str(milliseconds)) * _MILLISECOND)


def _refuse_twice(where: Message | Path, what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            place = f"{where.file}: message '{where.name}'" if isinstance(where, Message) else f"{where}"
            raise ConfigError(f"{place}: {what} {name} is given twice")
        seen.add(name)


def _check_layout(parsed: Any, message: Message) -> None:
    import cantools.database

    try:
        parsed.refresh(strict=True)
    except cantools.database.Error as error:
        problem = _layout_problem(message) or str(error)
        raise ConfigError(f"{message.file}: message '{message.name}': {problem}") from error


def _layout_problem(message: Message) -> str:
    """What is wrong with where the signals lie, or nothing."""
    taken: list[Signal] = []
    for signal in message.signals.values():
        if any(not 0 <= bit < 8 * message.length for bit in signal.bits):
            return (
                f"signal '{signal.name}' (start bit {signal.start}, {signal.length} bits) does not fit into "
                f"{message.length} bytes"
            )
        for other in taken:
            alternatives = other.multiplexer_ids and signal.multiplexer_ids
            if alternatives and set(other.multiplexer_ids).isdisjoint(signal.multiplexer_ids):
                continue
            if shared := sorted(set(other.bits) & set(signal.bits)):
                bits = f"bits {shared[0]} to {shared[-1]}"
                return f"signals '{other.name}' and '{signal.name}' overlap in {bits}"
        taken.append(signal)
    return ""


def check_signal(message: Message, signal: Signal, place: str = "") -> None:
    """Raise ConfigError where a channel could not carry the signal without saying something wrong.

    The rules: not multiplexed; a scale other than 0; floats of 32 or 64 bits; minimum <= maximum, some
    value between them can be sent, and none of them is sent as the "not available" code.
    """
    for problem in (_message_problem(message), _unsupported(signal), _range_problem(signal)):
        if problem:
            raise ConfigError(f"{_prefix(place)}{message.file}: {message.name}.{signal.name}: {problem}")


def _message_problem(message: Message) -> str:
    if message.multiplexed:
        return "the message is multiplexed; a connection needs one whose frames all hold the same signals"
    for s in message.signals.values():
        low, high = s.raw_type_range
        if not low <= s.start_raw <= high or (not s.is_float and s.start_raw != int(s.start_raw)):
            return f"the start value {s.start_raw} of {s.name} is no raw value of {_bits(s)}"
    return ""


def _bits(signal: Signal) -> str:
    if signal.is_float:
        return f"a {signal.length}-bit float"
    return f"{signal.length} {'signed' if signal.signed else 'unsigned'} bits"


def _unsupported(signal: Signal) -> str:
    if signal.is_float and signal.length not in _FLOAT_MAX:
        return f"a float of {signal.length} bits; 32 or 64 are supported"
    if signal.scale == 0 or not math.isfinite(signal.scale) or not math.isfinite(signal.offset):
        return f"scale {signal.scale} and offset {signal.offset}: no value can be told from another"
    return ""


def _range_problem(signal: Signal) -> str:
    low, high = signal.minimum, signal.maximum
    if low is not None and high is not None and low > high:
        return f"minimum {low} is above maximum {high}"
    if signal.is_float:
        return ""
    raw_low, raw_high, least, greatest = _raw_limits(signal)
    if raw_low > raw_high:
        return f"no value in [{low}, {high}] fits into {_bits(signal)}"
    code = signal.not_available
    if code is None or not raw_low <= code <= raw_high:
        return ""
    if (least is None and code == raw_low) or (greatest is None and code == raw_high):
        return ""  # no limit was written on that side, so the raw range ends before the code
    return (
        f"values in [{low}, {high}] are sent as raw {raw_low} to {raw_high}, but raw {code} means not "
        f"available; give the signal a minimum and maximum that leave {code} out"
    )


def _raw_limits(signal: Signal) -> tuple[int, int, float | None, float | None]:
    """Least and greatest raw value of any rounding to the nearest, and the limit each comes from."""
    limits = (signal.minimum, signal.maximum) if signal.scale > 0 else (signal.maximum, signal.minimum)
    least, greatest = (_steps(limit, signal) if limit is not None else None for limit in limits)
    first, last = (int(raw) for raw in signal.raw_type_range)
    raw_low = first if least is None else max(first, math.ceil(least - 0.5))
    raw_high = last if greatest is None else min(last, math.floor(greatest + 0.5))
    return raw_low, raw_high, least, greatest


def _steps(value: float, signal: Signal) -> float:
    """A physical value in raw steps, kept finite."""
    return max(-1e30, min(1e30, (value - signal.offset) / signal.scale))


def schedule(message: Message, step_size: float, place: str = "") -> tuple[int, int]:
    """When the message is sent, in communication steps of `step_size` s: every how many, and the first.

    The first is the first communication point at or after the start delay. Exact: 10 ms is once in a step
    of 0.01 s. Raises ConfigError when the message has no cycle time or it is no multiple of the step.
    """
    where = f"{_prefix(place)}{message.file}: message '{message.name}'"
    if message.cycle_time is None:
        raise ConfigError(
            f"{where} has no cycle time, and a connection needs a cyclic message; set its attribute "
            "GenMsgCycleTime [ms]"
        )
    step, cycle, delay = (_decimal(t) for t in (step_size, message.cycle_time, message.start_delay))
    if step <= 0 or cycle <= 0 or delay < 0:
        raise ConfigError(
            f"{where}: cycle time {message.cycle_time} s and step size {step_size} s must be positive, "
            f"start delay {message.start_delay} s not negative"
        )
    every = cycle / step
    if every.denominator != 1:
        raise ConfigError(
            f"{where}: its cycle time {message.cycle_time} s is no multiple of the communication step "
            f"{step_size} s"
        )
    return every.numerator, math.ceil(delay / step)


def _decimal(seconds: float) -> Fraction:
    """The decimal number that was written: 0.01 is 1/100, not the nearest double."""
    return Fraction(str(float(seconds)))
