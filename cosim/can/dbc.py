"""Reading DBC files.

A statement that nobody can read, or that contradicts another, stops who uses what it is about, and nobody
else: it is a warning of the database, and the `problem` of a message or of a signal (see `database`). Only a
file without any statement of a DBC is refused.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import sys
from fractions import Fraction
from pathlib import Path

from ..errors import ConfigError
from ..reading import content, text_of
from .database import Database, Message, Signal
from .dbc_entries import Attribute, Entries, Key, MessageEntry, SignalEntry, entries, number, whole
from .dbc_statements import statements
from .flaws import GREATEST, code_by_text, database_of
from .message_settings import SLOWEST

_MILLISECOND = Fraction(1, 1000)
_EXTENDED = 1 << 31
_FORMATS = [
    "StandardCAN",
    "ExtendedCAN",
    "reserved",
    "J1939PG",
    *["reserved"] * 10,
    "StandardCAN_FD",
    "ExtendedCAN_FD",
]
"""The choices of the attribute VFrameFormat where the file has its numbers only."""


def load_dbc(path: str | Path) -> Database:
    """Return the messages of a DBC file, in cp1252, the usual encoding, or in Unicode (`reading.text_of`).

    Raises ConfigError when the file cannot be read, or is no DBC.
    """
    path = Path(path)
    return _read(path, text_of(content(path, "the CAN database ")))


@functools.lru_cache(maxsize=8)  # a study runs one system often
def _read(path: Path, text: str) -> Database:
    found = entries(statements(text))
    if not found.valid:
        line, said = found.notes[0] if found.notes else (1, "not valid in a DBC file: ''")
        raise ConfigError(f"{path}: line {line}: {said}")
    messages = [_Reader(path, found, entry).message() for entry in found.messages]
    return database_of(path, messages, found.notes, map(found.node, found.nodes))


@dataclasses.dataclass
class _Reader:
    """The reading of one message from the entries of a file."""

    path: Path
    entries: Entries
    entry: MessageEntry

    def message(self) -> Message:
        """Return the message with all its signals, whatever is wrong with them."""
        entry, dbc_id = self.entry, self.entry.dbc_id
        frame_id, extended = dbc_id & (_EXTENDED - 1), bool(dbc_id & _EXTENDED)
        if not extended and GREATEST[False] < frame_id <= GREATEST[True]:
            said = f"the id {dbc_id} has more than 11 bits; it is taken as an extended one"
            self.entries.notes.append((entry.line, f"message '{entry.name}': {said}"))
            extended = True
        frame_format = self._choice((dbc_id, ""), "VFrameFormat", _FORMATS)
        j1939 = frame_format == "J1939PG" or (extended and self._of_file("ProtocolType") == "J1939")
        signals: dict[str, Signal] = {}
        for written in entry.signals:
            signal = self._signal(written)
            if first := signals.get(signal.name):
                lines = f"in the lines {first.line} and {written.line}"
                signal = dataclasses.replace(first, problem=f"signal {signal.name} is given twice, {lines}")
            signals[signal.name] = signal
        senders = [entry.sender, *self.entries.senders.get(dbc_id, [])]
        return Message(
            file=str(self.path),
            name=self._own((dbc_id, ""), "SystemMessageLongSymbol") or entry.name,
            frame_id=frame_id,
            extended=extended,
            length=entry.length,
            cycle_time=self._seconds("GenMsgCycleTime") or None,
            start_delay=self._seconds("GenMsgStartDelayTime") or 0.0,
            senders=tuple(dict.fromkeys(self.entries.node(sender) for sender in senders if sender)),
            signals=signals,
            fd=frame_format.endswith("CAN_FD"),
            j1939=j1939,
            comment=self.entries.comments.get((dbc_id, ""), ""),
            send_type=self._choice((dbc_id, ""), "GenMsgSendType", []),
            min_interval=self._seconds("GenMsgDelayTime") or 0.0,
            fast_cycle=self._seconds("GenMsgCycleTimeFast") or None,
            attributes={
                name: value.value for name, value in self.entries.attributes.get((dbc_id, ""), {}).items()
            },
            unread=entry.unread,
            line=entry.line,
        )

    def _signal(self, s: SignalEntry) -> Signal:
        key = (self.entry.dbc_id, s.name)
        multiplexer, ranges, problem = self._selection(s)
        kind = self.entries.floats.get(key, 0)
        is_float = kind in (1, 2)
        scale, offset = _finite(s.scale), _finite(s.offset)
        if not is_float and float(scale).is_integer() and float(offset).is_integer():
            scale, offset = int(scale), int(offset)
        unlimited = number(s.minimum) == number(s.maximum) == 0  # also as 0.0
        signal = Signal(
            name=self._name(s.name),
            start=whole(s.start) or 0,
            length=whole(s.length) or 0,
            little_endian=s.order != "0",
            signed=s.sign == "-",
            is_float=is_float,
            scale=scale,
            offset=offset,
            minimum=None if unlimited else _finite(s.minimum),
            maximum=None if unlimited else _finite(s.maximum),
            unit=s.unit,
            choices=self.entries.choices.get(key, {}),
            multiplexer=self._name(multiplexer),
            multiplexer_ranges=ranges,
            is_multiplexer=s.marker.endswith("M"),
            comment=self.entries.comments.get(key, ""),
            receivers=tuple(map(self.entries.node, s.receivers)),
            send_type=self._choice(key, "GenSigSendType", []),
            inactive_raw=self._number(key, "GenSigInactiveValue", default=False),
            line=s.line,
            problem=self.entries.broken.get(key, "") or problem,
        )
        start = self._number(key, "GenSigStartValue") or 0
        if not is_float and float(start).is_integer():
            start = int(start)
        return dataclasses.replace(signal, start_raw=start, not_available=self._code(key, signal))

    def _name(self, short: str) -> str:
        """Return the name of a signal: its long one, where an attribute has that."""
        return self._own((self.entry.dbc_id, short), "SystemSignalLongSymbol") or short

    @functools.cached_property
    def _multiplexers(self) -> tuple[list[str], list[str]]:
        """The names of all multiplexers of the message, and of those that no other one selects."""
        marked = [other for other in self.entry.signals if other.marker.endswith("M")]
        return [other.name for other in marked], [other.name for other in marked if other.marker == "M"]

    def _selection(self, s: SignalEntry) -> tuple[str, tuple[tuple[int, int], ...], str]:
        """Return the multiplexer of a signal and its raw values, "" and () for all frames; and a problem."""
        if s.marker and (found := self.entries.selectors.get((self.entry.dbc_id, s.name))):
            return *found, ""
        if s.marker in ("", "M"):
            return "", (), ""
        number_of = s.marker[1:].removesuffix("M")
        if not (s.marker.startswith("m") and number_of.isdigit()):
            return "", (), f"line {s.line}: '{s.marker}' is no multiplexer's mark: M, m3 or m3M"
        multiplexers, roots = self._multiplexers
        if s.marker.endswith("M") or len(multiplexers) != 1 or roots != multiplexers:
            said = (
                f"{' and '.join(multiplexers) or 'no signal'} could select it, and no SG_MUL_VAL_ says which"
            )
            return "", (), f"line {s.line}: '{s.marker}': {said}"
        return roots[0], ((int(number_of), int(number_of)),), ""

    def _code(self, key: Key, signal: Signal) -> int | None:
        """Return the raw code of "not available", by GenSigSNA or a description; None: no code."""
        if signal.is_float:
            return None
        code = code_by_text(signal.choices)
        if self.entries.attribute(key, "GenSigSNA") is not None:
            given = self._number(key, "GenSigSNA", default=False)
            code = code if given is None else int(given)
        if code is not None and signal.signed and 0 < signal.length <= 64 and code >= 1 << signal.length - 1:
            code -= 1 << signal.length  # written as a bit pattern
        return code

    # ---- attributes

    def _of_file(self, name: str) -> str:
        found = self.entries.of_file.get(name, self.entries.defaults.get(name))
        return found.value if found else ""

    def _own(self, key: Key, name: str) -> str:
        found = self.entries.attribute(key, name)
        return found.value if found else ""

    def _found(self, key: Key, name: str) -> Attribute | None:
        """Return an attribute's own value, else the file's default for it."""
        return self.entries.attribute(key, name) or self.entries.defaults.get(name)

    def _number(self, key: Key, name: str, default: bool = True) -> int | float | None:
        """Return an attribute that is a number; None, with a note, for what is none."""
        found = self._found(key, name) if default else self.entries.attribute(key, name)
        if found is None:
            return None
        definition = self.entries.definitions.get(name)
        text = found.value
        if definition and definition.choices and (index := found.index(definition.choices)) is not None:
            text = definition.choices[index] if 0 <= index < len(definition.choices) else text
        value = number(text)
        if value is None and found.value:
            about = f"message '{self.entry.name}'{f': signal {key[1]}' if key[1] else ''}"
            said = f'{about}: {name}: a finite number is needed, not "{text[:40]}"; it is left out'
            self.entries.notes.append((found.line or self.entry.line, said))
        return value

    def _seconds(self, name: str) -> float | None:
        milliseconds = self._number((self.entry.dbc_id, ""), name)
        if milliseconds is None:
            return None
        if not 0 <= milliseconds <= 1000.0 * SLOWEST:
            rule = f"is more than {SLOWEST:g} s" if milliseconds > 0 else "is no time"
            found = self._found((self.entry.dbc_id, ""), name)
            said = f"message '{self.entry.name}': {name}: {milliseconds:.9g} ms {rule}; it is left out"
            self.entries.notes.append((found.line if found and found.line else self.entry.line, said))
            return None
        return float(Fraction(str(milliseconds)) * _MILLISECOND)

    def _choice(self, key: Key, name: str, usual: list[str]) -> str:
        """Return the text of an attribute that is one of several: of its number or its text; "" for none."""
        found = self._found(key, name)
        if found is None:
            return ""
        definition = self.entries.definitions.get(name)
        choices = list(definition.choices) if definition and definition.choices else usual
        index = found.index(choices)
        if index is None:
            return found.value
        if definition and not definition.choices and not usual:
            about = f"message '{self.entry.name}': {name}"
            said = f"{about}: the attribute is no ENUM, so that {found.value} says nothing"
            self.entries.notes.append((found.line or self.entry.line, said))
            return ""
        if not 0 <= index < len(choices):
            said = f"message '{self.entry.name}': {name}: {found.value} is none of its {len(choices)} choices"
            self.entries.notes.append((found.line or self.entry.line, said))
            return ""
        return choices[index]


def _finite(text: str) -> int | float:
    """Return a number of the file: infinity for one beyond all doubles."""
    found = number(text)
    if found is None or abs(found) > sys.float_info.max:
        return -math.inf if text.startswith("-") else math.inf
    return found
