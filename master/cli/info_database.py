"""The report of `evcosim info` on a CAN database: messages, signals, what cannot be used and why, load."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...cosim.can.as_sent import as_sent
from ...cosim.can.bus_settings import BusSettings
from ...cosim.can.database import Database, Message, Signal
from ...cosim.can.formats import load_database
from ...cosim.can.limits import limits_note
from ...cosim.can.message_settings import MessageSettings
from ...cosim.can.send_types import send_type_of
from ...cosim.can.timing.lengths import frame_times
from ...cosim.errors import ConfigError, counted
from ...cosim.units.definition import defined
from ...cosim.units.measure import UnknownUnitError
from ...cosim.writing import finite
from .console import number, print_fields, print_paragraph, print_table, print_title

_BUS = BusSettings()  # as a bus is without any
_MOST_NOTES = 20


def described(
    path: Path, message: str | None = None, bitrate: int | None = None, data_bitrate: int | None = None
) -> dict[str, Any]:
    """Return the report on a database, with one message or all.

    With a `bitrate` [bit/s] it has the load of the bus, of frames without and with all stuff bits that they
    can have; CAN FD frames switch to `data_bitrate`. Raises ConfigError for no such file or message.
    """
    database = load_database(path)
    chosen = list(database.messages.values()) if message is None else [database.require(message)]
    messages = [_message(m, bitrate, data_bitrate) for m in chosen]
    return {
        "file": str(path),
        "nodes": list(database.nodes),
        "bitrate": bitrate,
        "data_bitrate": data_bitrate,
        "load": None if bitrate is None else [_sum(messages, i) for i in (0, 1)],
        "messages": messages,
        "flaws": list(database.warnings if message is None else _flaws_of(database, chosen[0])),
    }


def _flaws_of(database: Database, message: Message) -> list[str]:
    """Return the flaws that name a message, or are about its lines or those of its signals."""
    lines = {f"line {n}: " for n in (message.line, *(signal.line for signal in message.signals.values()))}
    starts = tuple(f"{database.path}: {text}" for text in (*lines, *message.unread.values()))
    named = f": message '{message.name}': "
    return [said for said in database.warnings if said.startswith(starts) or named in said]


def _sum(messages: list[dict[str, Any]], i: int) -> float:
    return sum((float(m["load"][i]) for m in messages if m["load"] is not None), 0.0)


def _message(written: Message, bitrate: int | None, data_bitrate: int | None) -> dict[str, Any]:
    message = as_sent(written, BusSettings())
    return {
        "name": message.name,
        "id": message.frame_id,
        "extended": message.extended,
        "length": written.length,
        "frame_length": message.length,
        "fd": message.fd,
        "j1939": message.j1939,
        "cycle_time": message.cycle_time,
        "start_delay": message.start_delay,
        "send_type": message.send_type,
        "sent": send_type_of(message, MessageSettings())[0],
        "min_interval": message.min_interval,
        "senders": list(message.senders),
        "load": _load(message, bitrate, data_bitrate),
        "comment": message.comment,
        "signals": [_signal(message, s) for s in message.signals.values()],
        "unread": dict(message.unread),
    }


def _load(message: Message, bitrate: int | None, data_bitrate: int | None) -> list[float] | None:
    """Return the least and the greatest part of the time that the bus is busy; None where it is not known."""
    if bitrate is None or not message.cycle_time or message.problem or message.length > 64:
        return None
    kind = message.extended, message.frame_length, message.fd
    return [time * 1e-12 / message.cycle_time for time in frame_times(*kind, bitrate, data_bitrate)]


def _signal(message: Message, signal: Signal) -> dict[str, Any]:
    refused = _refusal(message, signal.name)
    return {
        "name": signal.name,
        "start": signal.start,
        "length": signal.length,
        "little_endian": signal.little_endian,
        "signed": signal.signed,
        "float": signal.is_float,
        "scale": finite(signal.scale),
        "offset": finite(signal.offset),
        "minimum": finite(signal.minimum),
        "maximum": finite(signal.maximum),
        "unit": signal.unit,
        "unit_known": _is_known(signal.unit),
        "choices": {str(raw): text for raw, text in signal.choices.items()},
        "not_available": signal.not_available,
        "is_multiplexer": signal.is_multiplexer,
        "multiplexer": signal.multiplexer,
        "multiplexer_ranges": [list(ends) for ends in signal.multiplexer_ranges],
        "receivers": list(signal.receivers),
        "comment": signal.comment,
        "note": "; ".join(filter(None, (signal.note, "" if refused else limits_note(signal, _BUS)))),
        "refused": refused,
    }


def _is_known(unit: str) -> bool:
    try:
        defined(unit)
    except UnknownUnitError:
        return False
    return True


def _refusal(message: Message, name: str) -> str:
    """Return why a connection could not use a signal; "" where it could."""
    try:
        message.require(name)
    except ConfigError as error:
        return str(error).removeprefix(f"{message.file}: ")
    return ""


# ---- as text


def show(about: dict[str, Any]) -> None:
    """Print the report that `described` returned."""
    messages = about["messages"]
    signals = [signal for message in messages for signal in message["signals"]]
    usable = sum(not signal["refused"] for signal in signals)
    silent = sum(message["cycle_time"] is None for message in messages)
    unknown = sorted({s["unit"] for s in signals if not s["unit_known"]})
    fields = [
        ("database", about["file"]),
        ("nodes", ", ".join(about["nodes"])),
        (
            "messages",
            f"{len(messages)}, {silent} of them without a cycle time" if silent else f"{len(messages)}",
        ),
        ("signals", f"{len(signals)}, of which {usable} can be used"),
        ("load", _load_text(about, silent)),
        (
            "units",
            f"not known: {', '.join(unknown)}; [buses.NAME.units] can say what they are" if unknown else "",
        ),
    ]
    print_fields([(name, value) for name, value in fields if value])
    print_title("Messages")
    print_table(_HEADERS, [_row(message) for message in messages])
    if len(messages) == 1:
        _show_signals(messages[0])
    else:
        _show_notes(messages)
    if about["flaws"]:
        print_title(counted(len(about["flaws"]), "flaw"))
        for flaw in about["flaws"]:
            print_paragraph(flaw.removeprefix(f"{about['file']}: "))
    print()
    print_paragraph(_next(about))


_HEADERS = ("message", "id", "bytes", "frame", "every [s]", "sender", "signals", "load [%]")


def _load_text(about: dict[str, Any], silent: int) -> str:
    if about["load"] is None:
        return ""
    if silent == len(about["messages"]):
        return "not known, since no message has a cycle time"
    least, most = (f"{100 * part:.1f} %" for part in about["load"])
    left = f", without the {silent} that have no cycle time" if silent else ""
    return f"{least} to {most} at {about['bitrate']} bit/s, by the stuff bits{left}"


def _row(m: dict[str, Any]) -> tuple[str, ...]:
    usable = sum(not s["refused"] for s in m["signals"])
    count = f"{usable}" if usable == len(m["signals"]) else f"{usable} of {len(m['signals'])}"
    kind = "CAN FD" if m["fd"] else "J1939" if m["j1939"] else "extended" if m["extended"] else ""
    size = f"{m['length']}" if m["length"] == m["frame_length"] else f"{m['length']} in {m['frame_length']}"
    cycle = "" if m["cycle_time"] is None else f"{m['cycle_time']:g}"
    if m["sent"] != "cyclic":
        least = f", >= {m['min_interval']:g}" if m["min_interval"] else ""
        cycle = f"{m['sent']} {cycle}".rstrip() + least
    load = "" if m["load"] is None else f"{100 * m['load'][1]:.2f}"
    return (m["name"], f"0x{m['id']:X}", size, kind, cycle, ", ".join(m["senders"]), count, load)


def _show_signals(message: dict[str, Any]) -> None:
    print_title(f"Signals of {message['name']}")
    headers = ("signal", "bits", "step", "range", "unit", "page", "receivers")
    print_table(headers, [_signal_row(signal) for signal in message["signals"]])
    for signal in message["signals"]:
        for word, said in (("refused", signal["refused"]), ("note", signal["note"])):
            if said:
                print_paragraph(f"{word}: {signal['name']}: {said}")


def _show_notes(messages: list[dict[str, Any]]) -> None:
    """Print the notes on the signals of all messages, the first ones."""
    notes = [(m["name"], s["name"], s["note"]) for m in messages for s in m["signals"] if s["note"]]
    if notes:
        print_title(counted(len(notes), "note"))
    for message, signal, note in notes[:_MOST_NOTES]:
        print_paragraph(f"{message}.{signal}: {note}")
    if len(notes) > _MOST_NOTES:
        more = len(notes) - _MOST_NOTES
        print_paragraph(f"and {more} more: 'evcosim info FILE MESSAGE' has those of a message, --json all")


def _signal_row(s: dict[str, Any]) -> tuple[str, ...]:
    order, sign = "" if s["little_endian"] else " Motorola", " signed" if s["signed"] else ""
    offset = f" {'+' if s['offset'] > 0 else '-'} {number(abs(s['offset']))}" if s["offset"] else ""
    step = "float" if s["float"] else f"{number(s['scale'] or 0)}{offset}"
    ends = [
        ("-inf", "inf")[i] if s[k] is None else number(s[k]) for i, k in enumerate(("minimum", "maximum"))
    ]
    ranges = ", ".join(
        f"{low}" if low == high else f"{low} to {high}" for low, high in s["multiplexer_ranges"]
    )
    page = f"{s['multiplexer']} {ranges}" if s["multiplexer"] else "selects" if s["is_multiplexer"] else ""
    return (
        s["name"],
        f"{s['start']}|{s['length']}{order}{sign}",
        step,
        f"[{', '.join(ends)}]",
        s["unit"] + ("" if s["unit_known"] else " (?)"),
        page,
        ", ".join(s["receivers"]),
    )


def _next(about: dict[str, Any]) -> str:
    """Return a sentence on what to do with the database."""
    if len(about["messages"]) == 1:
        message = about["messages"][0]
        signals = sorted(message["signals"], key=lambda s: bool(s["is_multiplexer"]))
        signal = next((s["name"] for s in signals if not s["refused"]), None)
        if signal is None:
            return "No connection can use a signal of it."
        return f'A connection uses a signal by `via = "can0.{message["name"]}.{signal}"` in a system file.'
    file = about["file"]
    return (
        f"'evcosim info {file} MESSAGE' shows its signals, '--bitrate 500000' the load; a system file names "
        f'the database: `dbc = "{Path(file).name}"` in [buses.can0].'
    )
