"""The flaws of a CAN database: which of its messages and signals cannot be used, and why.

A database of a real car has some. None stops a run that does not use it: a flaw is the `problem` of the
message or the signal that it makes unusable, and a warning of the database.
"""

from __future__ import annotations

import dataclasses
import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from ..errors import short
from .database import LONGEST, Database, Message, Signal, bits_text, raw_limits
from .overlaps import first_overlaps

_MOST_CODES = 8  # in a sentence
_NOT_AVAILABLE = {"sna", "notavailable", "signalnotavailable"}
GREATEST = {False: 0x7FF, True: 0x1FFFFFFF}
"""The greatest frame id, of a standard frame (False) and of an extended one."""

Notes = Iterable[tuple[int, str]]
"""Sentences, each with the line that it is about; 0: a file that has no lines."""


def database_of(
    path: Path, messages: Sequence[Message], notes: Notes = (), nodes: Iterable[str] = ()
) -> Database:
    """Return the database of the messages that a file has, with their flaws found.

    Of messages of one name the first stays, and cannot be used; so do those of one frame id.
    """
    found: dict[str, Message] = {}
    names: dict[str, list[Message]] = {}
    ids: dict[tuple[int, bool], list[Message]] = {}
    for message in messages:
        names.setdefault(message.name, []).append(message)
        ids.setdefault((message.frame_id, message.extended), []).append(message)
    for name, same in names.items():
        (first, *others) = same
        problem = _message_flaw(first)
        if others:
            problem = f"the name is given twice{_in_lines(same)}"
        elif len(of_id := ids[first.frame_id, first.extended]) > 1:
            frame_id = f"frame id {first.frame_id:#x}{' (extended)' * first.extended}"
            problem = f"{frame_id} is given twice, to {' and '.join(m.name for m in of_id)}{_in_lines(of_id)}"
        found[name] = dataclasses.replace(checked(first), problem=problem)
    said = sorted((*notes, *itertools.chain(*map(_flaws_of, found.values()))), key=lambda note: note[0])
    warnings = tuple(f"{path}: {f'line {line}: ' if line else ''}{text}" for line, text in said)
    return Database(path, found, warnings, tuple(dict.fromkeys(nodes)))


def _in_lines(messages: Sequence[Message]) -> str:
    lines = [str(m.line) for m in messages if m.line]
    return f", in the lines {' and '.join(lines)}" if lines else ""


def _message_flaw(message: Message) -> str:
    most = GREATEST[message.extended]
    if message.frame_id > most:
        kind = "an extended" if message.extended else "a standard"
        return f"frame id {message.frame_id:#x} is beyond {most:#x}, the greatest of {kind} frame"
    if message.length > LONGEST:
        return f"the message has {message.length} bytes; at most {LONGEST} are read"
    return ""


def _flaws_of(message: Message) -> Iterator[tuple[int, str]]:
    """Yield line and text of each flaw of a message."""
    if message.problem:
        yield message.line, f"message '{message.name}' cannot be used: {message.problem}"
    for signal in message.signals.values():
        if signal.problem:
            yield (
                signal.line,
                f"message '{message.name}': signal '{signal.name}' cannot be used: {signal.problem}",
            )
        elif beyond := _codes_beyond(signal):
            codes = f"{', '.join(map(str, beyond[:_MOST_CODES]))}{' ...' * (len(beyond) > _MOST_CODES)}"
            yield (
                signal.line,
                f"message '{message.name}': signal '{signal.name}' has a text for raw {codes}, which "
                f"{bits_text(signal)} do not hold",
            )


def _codes_beyond(signal: Signal) -> list[int]:
    """Return the raw values with a text that a signal cannot have, nor its bits without a sign."""
    if signal.is_float:
        return []
    low, _ = signal.raw_type_range
    return sorted(raw for raw in signal.choices if not low <= raw < 1 << signal.length)


# ---- signals


def checked(message: Message) -> Message:
    """Return the message with the `problem` of each signal that has one, and the others `clipped`."""
    signals = dict(message.signals)

    def note(name: str, problem: str) -> None:
        if problem and not signals[name].problem:
            signals[name] = dataclasses.replace(signals[name], problem=problem)

    for name, signal in signals.items():
        note(name, _own_flaw(message, signal))
    for name in signals:
        note(name, _chain_flaw(signals, name))
    for name, (one, other) in first_overlaps(signals).items():
        shared = sorted(set(signals[one].bits) & set(signals[other].bits))
        bits = f"bits {shared[0]} to {shared[-1]}" if len(shared) > 1 else f"bit {shared[0]}"
        note(name, f"'{one}' and '{other}' overlap in {bits}")
    for name in signals:
        note(name, _chain_flaw(signals, name))  # by an overlap of its multiplexer
    signals = {name: signal if signal.problem else clipped(signal) for name, signal in signals.items()}
    return dataclasses.replace(message, signals=signals)


def _own_flaw(message: Message, signal: Signal) -> str:
    low, high = signal.start, signal.start + signal.length
    if not (0 < signal.length <= 8 * LONGEST and 0 <= low <= high <= 16 * LONGEST):
        return f"{signal.length} bits from bit {signal.start} on are no signal"
    if any(not 0 <= bit < 8 * message.length for bit in signal.bits):
        return f"start bit {signal.start}, {signal.length} bits: it does not fit into {message.length} bytes"
    if signal.is_float and signal.length not in (32, 64):
        return ""  # said when it is used, with the lengths that a float has
    first, last = signal.raw_type_range
    start = signal.start_raw
    if not first <= start <= last or (not signal.is_float and start != int(start)):
        return f"the start value {short(start)} is no raw value of {bits_text(signal)}"
    return ""


def _chain_flaw(signals: Mapping[str, Signal], name: str) -> str:
    """Return what is wrong with the multiplexers that select a signal; "" for nothing."""
    seen = [name]
    while multiplexer := signals[seen[-1]].multiplexer:
        if multiplexer in seen:
            return f"it selects itself: {' <- '.join([*seen, multiplexer])}"
        if multiplexer not in signals or signals[multiplexer].problem:
            return f"its multiplexer '{multiplexer}' is no signal that can be used"
        low, high = signals[multiplexer].raw_type_range
        if not any(low <= first <= high for first, _ in signals[seen[-1]].multiplexer_ranges):
            kind = bits_text(signals[multiplexer])
            return f"no value of its multiplexer '{multiplexer}' that selects it is one of {kind}"
        seen.append(multiplexer)
    return ""


# ---- the code of "not available"


def code_by_text(choices: Mapping[int, str]) -> int | None:
    """Return the raw value whose description says that there is no value, as "SNA"; None: there is none."""
    return next((raw for raw, text in choices.items() if _says_not_available(text)), None)


def _says_not_available(text: str) -> bool:
    return re.sub(r"[\s_-]", "", text).casefold() in _NOT_AVAILABLE


def clipped(signal: Signal) -> Signal:
    """Return the signal with a range that ends one short of its code for "not available", and a note of it.

    That is where the code is the least or the greatest raw value of the range that is written. One in the
    middle stays there, and stops who uses the signal.
    """
    code = signal.not_available
    if code is None or signal.is_float or not signal.has_steps:
        return signal
    low, high, least, greatest = raw_limits(signal)
    if not (low < high and code in (low, high)) or (least if code == low else greatest) is None:
        return signal
    first, last = (low + 1, high) if code == low else (low, high - 1)
    side = "minimum" if (code == low) == (signal.scale > 0) else "maximum"
    written = signal.minimum if side == "minimum" else signal.maximum
    nearest = first if code == low else last
    note = (
        f"its {side} {written} would be sent as raw {code}, which means not available; "
        f"{nearest * signal.scale + signal.offset:g} (raw {nearest}) is the last value that is sent"
    )
    limit = nearest * signal.scale + signal.offset
    if side == "minimum":
        return dataclasses.replace(signal, minimum=limit, note=note)
    return dataclasses.replace(signal, maximum=limit, note=note)
