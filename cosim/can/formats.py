"""Reading CAN databases: DBC by evcosim, KCD, SYM (6.0) and ARXML by cantools.

The same content makes the same records, whatever the format; what a format cannot say, as SYM the sender
of a message, is as in a DBC without it. Tables (XLSX, XLS) and DBF are refused: canmatrix (1.2), the one
library that reads them, cannot read back the XLSX and the DBF that it has written of `ev.dbc`, and its XLS
has lost lengths of messages, signs, ranges and codes, so that values would be others.
"""

from __future__ import annotations

import dataclasses
import math
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import ConfigError
from ..reading import content, text_of
from .database import Database, Message, Signal
from .dbc import load_dbc
from .flaws import code_by_text, database_of

_BY_CANTOOLS = (".kcd", ".sym", ".arxml")
SUFFIXES = (".dbc", *_BY_CANTOOLS)
"""The suffixes of the files that are read as CAN databases."""
REFUSED = (".xlsx", ".xls", ".dbf")
"""The suffixes of CAN databases that no library reads as they were written."""


def load_database(path: str | Path) -> Database:
    """Return the messages of a CAN database; a file of another suffix than SUFFIXES is read as DBC.

    Raises ConfigError when the file cannot be read or is not of its format.
    """
    path = Path(path)
    if path.suffix.lower() in REFUSED:
        raise ConfigError(
            f"{path}: {_name(path)} is not read as a CAN database: libraries for it lose lengths, signs, "
            "ranges and codes, or fail. Export a DBC, KCD or ARXML file from the tool that has the database; "
            "a file that was converted (as by canconvert) needs a look at all of these by `evcosim info`"
        )
    if path.suffix.lower() in _BY_CANTOOLS:
        return _by_cantools(path)
    return load_dbc(path)


def _name(path: Path) -> str:
    return path.suffix[1:].upper()


# ---- cantools


def _by_cantools(path: Path) -> Database:
    import cantools.database  # 0.2 s, and only these formats need it

    text = text_of(content(path, "the CAN database "))
    try:
        found: Any = cantools.database.load_string(text, path.suffix[1:].lower(), strict=False)
    except Exception as error:  # cantools raises all kinds for what is not of the format
        said = " ".join(str(error).split())[:300]
        raise ConfigError(
            f"{path}: not a valid {_name(path)} file: {type(error).__name__}: {said}"
        ) from error
    if not hasattr(found, "messages"):
        raise ConfigError(f"{path}: has no messages, but diagnostic data")
    messages = [_message(path, m) for m in found.messages]
    if path.suffix.lower() == ".sym":  # it has no nodes; cantools names some
        return database_of(path, [dataclasses.replace(m, senders=()) for m in messages])
    return database_of(path, messages, (), (node.name for node in found.nodes))


def _message(path: Path, m: Any) -> Message:
    return Message(
        file=str(path),
        name=m.name,
        frame_id=m.frame_id,
        extended=m.is_extended_frame,
        length=m.length,
        cycle_time=float(Fraction(str(m.cycle_time)) / 1000) if m.cycle_time else None,
        senders=tuple(m.senders),
        signals={s.name: _signal(s) for s in m.signals},
        fd=bool(m.is_fd),
        j1939=m.protocol == "j1939",
        comment=m.comment or "",
        send_type=m.send_type or "",
        problem="it is a container of others, which is not supported" if m.is_container else "",
    )


def _signal(s: Any) -> Signal:
    is_float = s.conversion.is_float
    scale, offset = _real(s.conversion.scale), _real(s.conversion.offset)
    if not is_float and float(scale).is_integer() and float(offset).is_integer():
        scale, offset = int(scale), int(offset)
    choices = {int(raw): str(text) for raw, text in (s.choices or {}).items()}
    start = _real(s.raw_initial or 0)
    ranges = tuple((value, value) for value in sorted(s.multiplexer_ids or ()))
    return Signal(
        name=s.name,
        start=s.start,
        length=s.length,
        little_endian=s.byte_order == "little_endian",
        signed=s.is_signed,
        is_float=is_float,
        scale=scale,
        offset=offset,
        minimum=None if s.minimum is None else _real(s.minimum),
        maximum=None if s.maximum is None else _real(s.maximum),
        unit=s.unit or "",
        choices=choices,
        start_raw=int(start) if not is_float and float(start).is_integer() else start,
        not_available=None if is_float else code_by_text(choices),
        multiplexer=(s.multiplexer_signal or "") if ranges else "",
        multiplexer_ranges=ranges,
        is_multiplexer=s.is_multiplexer,
        comment=s.comment or "",
        receivers=tuple(s.receivers),
        problem="" if hasattr(s.conversion, "scale") else "its conversion is not linear",
    )


def _real(value: Any) -> int | float:
    """Return a number of cantools, which has decimals too: infinity for one beyond all doubles."""
    if isinstance(value, int):
        return value if abs(value) <= sys.float_info.max else math.copysign(math.inf, value)
    return float(value)
