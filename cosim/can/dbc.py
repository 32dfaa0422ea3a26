"""Reading DBC files.

cantools reads the file, strictly: what it refuses is refused here, with the file and the bits in the message.
Rules on the whole file hold when it is loaded, those on one message or signal later (see `database`).
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import ConfigError
from ..reading import content
from .database import Database, Message, Signal

_MILLISECOND = Fraction(1, 1000)
_LONGEST = 1785  # bytes of a message that several frames transport
_DIGITS = 400  # of a number; a double has 309 at most
_STRING = re.compile(r'"(?:\\"|[^"])*"')  # as cantools sees one
_HUGE = re.compile(rf"(?<![\w.])[-+]?(?:\d{{{_DIGITS},}}|\d+(?:\.\d*)?[eE][+-]?0*[1-9]\d{{3,}})")
_SIZES = (
    ("message", re.compile(r"^\s*BO_\s+\d+\s+(\w+)\s*:\s*(\d+)", re.M), _LONGEST, "bytes"),
    ("signal", re.compile(r"^\s*SG_\s+(\w+)[^:\n]*:\s*(\d+)", re.M), 8 * _LONGEST, "as its start bit"),
    ("signal", re.compile(r"^\s*SG_\s+(\w+)[^:\n]*:\s*\d+\s*\|\s*(\d+)", re.M), 8 * _LONGEST, "bits"),
)
_NOT_AVAILABLE = {"sna", "notavailable", "signalnotavailable"}


def load_dbc(path: str | Path) -> Database:
    """Return the messages of a DBC file in UTF-8 or, where it is no UTF-8, in cp1252, the usual encoding.

    Raises ConfigError when the file cannot be read, is no DBC (with the line), has signals that overlap or
    do not fit into their message, gives a name or frame id twice, or a size or an attribute that can be none.
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
    data = content(path, "the CAN database ")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")  # as cantools does: five bytes have no meaning


def _parse(path: Path, text: str) -> Any:
    import cantools.database  # 0.2 s, and only a system with a bus needs it

    _check_sizes(path, text)
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
    except Exception as error:  # cantools raises all kinds for statements that contradict each other
        raise ConfigError(f"{path}: not a valid DBC file: {type(error).__name__}: {error}") from error


def _check_sizes(path: Path, text: str) -> None:
    """Raise ConfigError for numbers that no message needs, from which cantools would make texts as long."""
    bare = _STRING.sub(lambda found: '"' + "\n" * found[0].count("\n") + '"', text)
    if huge := _HUGE.search(bare):
        line = bare.count("\n", 0, huge.start()) + 1
        raise ConfigError(
            f"{path}: line {line}: the number {huge[0][:40]}... is beyond all that a DBC file needs"
        )
    for kind, pattern, most, what in _SIZES:
        for found in pattern.finditer(bare):
            if int(found[2]) > most:
                line = bare.count("\n", 0, found.start(1)) + 1
                has = f"{kind} '{found[1]}' has {found[2][:40]} {what}"
                raise ConfigError(f"{path}: line {line}: {has}; at most {most} are read")


def _message(path: Path, parsed: Any) -> Message:
    place = f"{path}: message '{parsed.name}'"
    cycle = _number(parsed.cycle_time or 0, f"{place}: GenMsgCycleTime")
    delay = _number(
        _attribute(parsed.dbc, "GenMsgStartDelayTime", default=True) or 0, f"{place}: start delay"
    )
    return Message(
        file=str(path),
        name=parsed.name,
        frame_id=parsed.frame_id,
        extended=parsed.is_extended_frame,
        length=parsed.length,
        cycle_time=_seconds(cycle) if cycle else None,
        start_delay=_seconds(delay),
        senders=tuple(parsed.senders),
        signals={s.name: _signal(s, f"{place}: signal '{s.name}'") for s in parsed.signals},
        fd=parsed.is_fd,
        comment=parsed.comment or "",
    )


def _signal(parsed: Any, place: str) -> Signal:
    scale, offset = _real(parsed.conversion.scale), _real(parsed.conversion.offset)
    if not parsed.is_float and float(scale).is_integer() and float(offset).is_integer():
        scale, offset = int(scale), int(offset)
    start = _number(parsed.raw_initial or 0, f"{place}: start value")
    return Signal(
        name=parsed.name,
        start=parsed.start,
        length=parsed.length,
        little_endian=parsed.byte_order == "little_endian",
        signed=parsed.is_signed,
        is_float=parsed.is_float,
        scale=scale,
        offset=offset,
        minimum=parsed.minimum if parsed.minimum is None else _real(parsed.minimum),
        maximum=parsed.maximum if parsed.maximum is None else _real(parsed.maximum),
        unit=parsed.unit or "",
        choices={int(raw): str(text) for raw, text in (parsed.choices or {}).items()},
        start_raw=int(start) if not parsed.is_float and float(start).is_integer() else start,
        not_available=_not_available(parsed, place),
        multiplexer_ids=tuple(parsed.multiplexer_ids or ()),
        is_multiplexer=parsed.is_multiplexer,
        comment=parsed.comment or "",
    )


def _real(number: float | int) -> float | int:
    """Return a number of the file: infinity for an integer beyond all doubles."""
    if isinstance(number, int) and abs(number) > sys.float_info.max:
        return math.inf if number > 0 else -math.inf
    return number


def _number(value: Any, place: str) -> float | int:
    """Return the value of an attribute that is a number. Raises ConfigError, which starts with `place`."""
    try:
        number: float | int = value if isinstance(value, int) else float(value)
        if math.isfinite(number):
            return number
    except (TypeError, ValueError, OverflowError):
        pass  # refused below, as infinity and NaN are
    raise ConfigError(f"{place}: a finite number is needed, not {str(value)[:40]!r}")


def _not_available(parsed: Any, place: str) -> int | None:
    """Return the raw code of "not available", by GenSigSNA or a description such as "SNA"; None: no code."""
    if parsed.is_float:
        return None
    given = _attribute(parsed.dbc, "GenSigSNA")
    named = (raw for raw, text in (parsed.choices or {}).items() if _says_not_available(str(text)))
    if given is None and (given := next(named, None)) is None:
        return None
    code = int(_number(given, f"{place}: GenSigSNA"))
    if parsed.is_signed and code >= 1 << parsed.length - 1:  # written as a bit pattern
        code -= 1 << parsed.length
    return code


def _says_not_available(text: str) -> bool:
    return re.sub(r"[\s_-]", "", text).casefold() in _NOT_AVAILABLE


def _attribute(specifics: Any, name: str, default: bool = False) -> Any:
    """Return an attribute's own value; without one, with `default`, the file's default for it; else None."""
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
    """Return a sentence on the first signal that does not fit, or the first two that overlap; "": none."""
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
