"""The entries of a DBC file as it writes them: numbers and texts, by frame id and signal name.

A statement that cannot be read, or is about a message or a signal that there is not, is left out and noted
with its line. It stops nobody, but where it says how a signal is coded: `broken` has these.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterable, Sequence

from .dbc_statements import NUMBER, STRING, Statement

_DIGITS = 400  # of a number; a double has 309 at most
_HUGE = re.compile(rf"(?<![\w.\"])[-+]?(?:\d{{{_DIGITS},}}|\d+(?:\.\d*)?[eE][+-]?0*[1-9]\d{{3,}})")
_VALUE = rf"({NUMBER}|{STRING})"
_ABOUT = r"(?:BO_\s+(?P<message>\d+)|SG_\s+(?P<of>\d+)\s+(?P<signal>\w+)|(?:BU_|EV_)\s+(?P<other>\w+))?\s*"
_UNASSIGNED = "VECTOR__INDEPENDENT_SIG_MSG"  # CANdb++ keeps the signals of no message there
_NOBODY = "Vector__XXX"

_PATTERNS = {
    "BO_": r"BO_\s+(\d+)\s+(\w+)\s*:\s*(\d+)\s*(\w*)",
    "SG_": rf"SG_\s+(\w+)\s*(?:\s(\w+)\s*)?:\s*({NUMBER})\s*\|\s*({NUMBER})\s*@\s*(\d)\s*([-+])\s*"
    rf"\(\s*({NUMBER})\s*,\s*({NUMBER})\s*\)\s*\[\s*({NUMBER})\s*\|\s*({NUMBER})\s*\]\s*({STRING})([\w,\s]*)",
    "BU_": r"BU_\s*:([\w,\s]*)",
    "BA_DEF_": rf"BA_DEF_\s*(?:(SG_|BO_|EV_|BU_)\s*)?({STRING})\s*(\w+)(.*)",
    "BA_DEF_DEF_": rf"BA_DEF_DEF_\s*({STRING})\s*{_VALUE}",
    "BA_": rf"BA_\s*(?P<name>{STRING})\s*{_ABOUT}(?P<value>{_VALUE})",
    "CM_": rf"CM_\s*{_ABOUT}(?P<value>{STRING})",
    "VAL_": rf"VAL_\s+(\d+)\s+(\w+)((?:\s*{NUMBER}\s*{STRING})*)",
    "SIG_VALTYPE_": r"SIG_VALTYPE_\s+(\d+)\s+(\w+)\s*:?\s*(\d+)",
    "SG_MUL_VAL_": r"SG_MUL_VAL_\s+(\d+)\s+(\w+)\s+(\w+)((?:[\s,]*\d+\s*-\s*\d+)+)",
    "BO_TX_BU_": r"BO_TX_BU_\s+(\d+)\s*:([\w,\s]*)",
}
_READ = {keyword: re.compile(pattern, re.DOTALL) for keyword, pattern in _PATTERNS.items()}
_OF_VARIABLE = re.compile(rf"VAL_\s+[^\W\d]\w*(?:\s*{NUMBER}\s*{STRING})*", re.DOTALL)
_PAIR = re.compile(rf"({NUMBER})\s*({STRING})", re.DOTALL)
_RANGE = re.compile(r"(\d+)\s*-\s*(\d+)")
_CODING = re.compile(r"(?:SIG_VALTYPE_|SG_MUL_VAL_)\s+(\d+)\s+(\w+)")
_OF_MESSAGE = re.compile(
    rf"(?:BA_\s+(?:{STRING})?|CM_|VAL_|SIG_VALTYPE_|SG_MUL_VAL_|BO_TX_BU_)\s*(?:BO_|SG_)?\s*(\d+)\b",
    re.DOTALL,
)
_SIGNAL_NAME = re.compile(r"SG_\s+(\w+)")


@dataclasses.dataclass(frozen=True)
class SignalEntry:
    """An `SG_`: its numbers as texts; `marker` is "", "M", "m3" or "m3M", `order` "0" for Motorola."""

    line: int
    name: str
    marker: str
    start: str
    length: str
    order: str
    sign: str
    scale: str
    offset: str
    minimum: str
    maximum: str
    unit: str
    receivers: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class MessageEntry:
    """A `BO_` with its signals; `unread` are the names of signals that cannot be read, with the reason."""

    line: int
    dbc_id: int
    name: str
    length: int
    sender: str
    signals: list[SignalEntry] = dataclasses.field(default_factory=list)
    unread: dict[str, str] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class Definition:
    """The kind of an attribute: "INT", "FLOAT", "HEX", "ENUM" with its `choices`, or "STRING"."""

    kind: str
    choices: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Attribute:
    """The value of an attribute, a number's text or (`quoted`) a text, and its line (0: the default's)."""

    value: str
    line: int = 0
    quoted: bool = False

    def index(self, choices: Sequence[str]) -> int | None:
        """Return the index of its choice, by text or by number, which may be beyond them; None: none."""
        if self.quoted and self.value in choices:
            return choices.index(self.value)
        return whole(self.value)


Key = tuple[int, str]
"""A frame id as the DBC has it, with bit 31 for an extended one, and a signal's name ("": the message)."""


@dataclasses.dataclass
class Entries:
    """All entries of a file that evcosim uses; `notes` are sentences with the line that each is about."""

    nodes: list[str] = dataclasses.field(default_factory=list)
    long_nodes: dict[str, str] = dataclasses.field(default_factory=dict)
    messages: list[MessageEntry] = dataclasses.field(default_factory=list)
    definitions: dict[str, Definition] = dataclasses.field(default_factory=dict)
    defaults: dict[str, Attribute] = dataclasses.field(default_factory=dict)
    attributes: dict[Key, dict[str, Attribute]] = dataclasses.field(default_factory=dict)
    of_file: dict[str, Attribute] = dataclasses.field(default_factory=dict)
    comments: dict[Key, str] = dataclasses.field(default_factory=dict)
    choices: dict[Key, dict[int, str]] = dataclasses.field(default_factory=dict)
    floats: dict[Key, int] = dataclasses.field(default_factory=dict)
    selectors: dict[Key, tuple[str, tuple[tuple[int, int], ...]]] = dataclasses.field(default_factory=dict)
    senders: dict[int, list[str]] = dataclasses.field(default_factory=dict)
    broken: dict[Key, str] = dataclasses.field(default_factory=dict)
    notes: list[tuple[int, str]] = dataclasses.field(default_factory=list)
    unread: list[tuple[int, int, str]] = dataclasses.field(default_factory=list)
    """Statements about a message that cannot be read: line, frame id of the message, reason."""
    valid: int = 0
    """The number of statements that were read and say that this is a DBC file."""

    def node(self, name: str) -> str:
        """Return the name of a node: its long one, where an attribute has that."""
        return self.long_nodes.get(name) or name

    def attribute(self, key: Key, name: str) -> Attribute | None:
        """Return the attribute of a message or a signal itself; None where it has none."""
        return self.attributes.get(key, {}).get(name)


def entries(found: Iterable[Statement]) -> Entries:
    """Return the entries of the statements of a file."""
    made, later = Entries(), []
    attached = False  # to a message that was read
    for statement in found:
        if statement.keyword not in _READ:
            _keep_other(made, statement)
            continue
        match = None if _HUGE.search(statement.text) else _READ[statement.keyword].fullmatch(statement.text)
        if statement.keyword == "BO_":
            attached = match is not None and match[2] != _UNASSIGNED and len(match[3]) < _DIGITS
        elif statement.keyword == "SG_" and not attached:
            continue  # of a message that was noted itself
        if match is None:
            _refuse(made, statement)
        elif statement.keyword in _NOW:
            made.valid += 1
            _NOW[statement.keyword](made, statement, match)
        else:
            later.append((statement, match))  # it may stand before what it is about
    known = {(m.dbc_id, name) for m in made.messages for name in ("", *_names(m))}
    names = {m.dbc_id: m.name for m in made.messages}
    made.notes += [(line, _about(names.get(dbc_id, ""), said)) for line, dbc_id, said in made.unread]
    for statement, match in later:
        made.valid += 1
        _LATER[statement.keyword](made, statement, match, known)
    return made


def _names(message: MessageEntry) -> list[str]:
    return [*(s.name for s in message.signals), *message.unread]


def _keep_other(made: Entries, statement: Statement) -> None:
    """Count a statement that evcosim needs nothing of, or note what is none."""
    if not statement.keyword:
        made.notes.append((statement.line, f"not valid in a DBC file: '{statement.shown}'"))
    elif statement.keyword != "VERSION" or '"' in statement.text:
        made.valid += 1


def _refuse(made: Entries, statement: Statement) -> None:
    """Note a statement that cannot be read, and what cannot be used for it."""
    if statement.keyword == "VAL_" and _OF_VARIABLE.fullmatch(statement.text):
        return  # of an environment variable
    if huge := _HUGE.search(statement.text):
        said = f"the number {huge[0][:40]}... is beyond all that a DBC file needs: '{statement.shown}'"
    else:
        said = f"not valid in a DBC file: '{statement.shown}'"
    if (about := _OF_MESSAGE.match(statement.text)) and len(about[1]) < _DIGITS:
        made.unread.append((statement.line, int(about[1]), said))  # its message may stand behind it
    else:
        made.notes.append((statement.line, said))
    if statement.keyword == "SG_" and made.messages and (name := _SIGNAL_NAME.match(statement.text)):
        made.messages[-1].unread.setdefault(name[1], f"line {statement.line}: {said}")
    elif (key := _CODING.match(statement.text)) and len(key[1]) < _DIGITS:
        made.broken.setdefault((int(key[1]), key[2]), f"line {statement.line}: {said}")


def _about(message: str, said: str) -> str:
    return f"message '{message}': {said}" if message else said


def text_of(string: str) -> str:
    """Return the text that a string of the file stands for."""
    return string[1:-1].replace('\\"', '"')


def number(text: str) -> int | float | None:
    """Return the finite number that a text is; None for any other."""
    try:
        found: int | float = int(text) if re.fullmatch(r"[-+]?\d+", text) else float(text)
        return found if math.isfinite(found) else None
    except (ValueError, OverflowError):  # beyond all doubles
        return None


def whole(text: str) -> int | None:
    """Return the whole number that a text is, cut where it has a fraction; None for any other."""
    found = number(text)
    return None if found is None else int(found)


def _words(text: str) -> tuple[str, ...]:
    return tuple(word for word in re.split(r"[\s,]+", text) if word and word != _NOBODY)


# ---- statements that stand for themselves


def _message(made: Entries, statement: Statement, match: re.Match[str]) -> None:
    if match[2] != _UNASSIGNED:
        sender = "" if match[4] == _NOBODY else match[4]
        made.messages.append(MessageEntry(statement.line, int(match[1]), match[2], int(match[3]), sender))


def _signal(made: Entries, statement: Statement, match: re.Match[str]) -> None:
    name, marker, start, length, order, sign, scale, offset, minimum, maximum, unit, receivers = (
        match.groups()
    )
    made.messages[-1].signals.append(
        SignalEntry(
            statement.line, name, marker or "", start, length, order, sign, scale, offset, minimum, maximum,
            text_of(unit), _words(receivers),
        )
    )  # fmt: skip # a list of numbers


def _nodes(made: Entries, statement: Statement, match: re.Match[str]) -> None:
    made.nodes += _words(match[1])


def _definition(made: Entries, statement: Statement, match: re.Match[str]) -> None:
    choices = tuple(text_of(found) for found in re.findall(STRING, match[4])) if match[3] == "ENUM" else ()
    made.definitions[text_of(match[2])] = Definition(match[3], choices)


def _default(made: Entries, statement: Statement, match: re.Match[str]) -> None:
    made.defaults[text_of(match[1])] = _value_of(match[2])


def _value_of(written: str, line: int = 0) -> Attribute:
    quoted = written.startswith('"')
    return Attribute(text_of(written) if quoted else written, line, quoted)


_NOW = {
    "BO_": _message, "SG_": _signal, "BU_": _nodes, "BA_DEF_": _definition, "BA_DEF_DEF_": _default,
}  # fmt: skip # a table


# ---- statements about a message or a signal, which must be there


def _key(made: Entries, statement: Statement, number: str, signal: str, known: set[Key]) -> Key | None:
    """Return what a statement is about; None, with a note, where there is no such thing."""
    key = (int(number), signal)
    if key in known:
        return key
    if key[0] == 0xC0000000:  # the signals of no message
        return None
    about = f"signal '{signal}'" if signal and (key[0], "") in known else f"message with the id {key[0]}"
    in_message = next((f" in message '{m.name}'" for m in made.messages if m.dbc_id == key[0]), "")
    note = f"{statement.keyword} for a {about}{in_message}, which there is not: '{statement.shown}'"
    made.notes.append((statement.line, note))
    return None


def _attribute(made: Entries, statement: Statement, match: re.Match[str], known: set[Key]) -> None:
    name, value = text_of(match["name"]), _value_of(match["value"], statement.line)
    if name not in made.definitions:
        made.notes.append((statement.line, f"the attribute \"{name}\" is not defined: '{statement.shown}'"))
    if match["other"]:
        if name == "SystemNodeLongSymbol":
            made.long_nodes[match["other"]] = value.value
        return
    number = match["message"] or match["of"]
    if number is None:
        made.of_file[name] = value
    elif key := _key(made, statement, number, match["signal"] or "", known):
        own = made.attributes.setdefault(key, {})
        if name in own and own[name].value != value.value:
            said = f"the attribute \"{name}\" is given a second time; this one counts: '{statement.shown}'"
            made.notes.append((statement.line, said))
        own[name] = value


def _comment(made: Entries, statement: Statement, match: re.Match[str], known: set[Key]) -> None:
    number = match["message"] or match["of"]
    if number is not None and (key := _key(made, statement, number, match["signal"] or "", known)):
        made.comments[key] = text_of(match["value"])


def _choices(made: Entries, statement: Statement, match: re.Match[str], known: set[Key]) -> None:
    if key := _key(made, statement, match[1], match[2], known):
        found: dict[int, str] = {}
        made.choices[key] = found
        for written, text in _PAIR.findall(match[3]):
            raw = whole(written)
            if raw is None:
                continue
            if found.setdefault(raw, text_of(text)) != text_of(text):
                said = f"VAL_ of signal '{match[2]}' has two texts for {raw}; the last counts"
                made.notes.append((statement.line, said))
                found[raw] = text_of(text)


def _value_type(made: Entries, statement: Statement, match: re.Match[str], known: set[Key]) -> None:
    if key := _key(made, statement, match[1], match[2], known):
        made.floats[key] = kind = int(match[3])
        if kind > 2:
            said = f"line {statement.line}: {kind} is no type of value: 0 an integer, 1 a float, 2 a double"
            made.broken.setdefault(key, said)


def _selector(made: Entries, statement: Statement, match: re.Match[str], known: set[Key]) -> None:
    if key := _key(made, statement, match[1], match[2], known):
        ranges = tuple((int(low), int(high)) for low, high in _RANGE.findall(match[4]))
        if turned := [f"{low}-{high}" for low, high in ranges if low > high]:
            said = f"line {statement.line}: the range {turned[0]} ends before it begins: '{statement.shown}'"
            made.broken.setdefault(key, said)
        made.selectors[key] = (match[3], ranges)


def _senders(made: Entries, statement: Statement, match: re.Match[str], known: set[Key]) -> None:
    if key := _key(made, statement, match[1], "", known):
        made.senders.setdefault(key[0], []).extend(_words(match[2]))


_LATER = {
    "BA_": _attribute, "CM_": _comment, "VAL_": _choices, "SIG_VALTYPE_": _value_type,
    "SG_MUL_VAL_": _selector, "BO_TX_BU_": _senders,
}  # fmt: skip # a table
