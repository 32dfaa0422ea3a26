"""The buses of a system: their databases, with what is wrong in them said."""

from __future__ import annotations

from ..can.database import Database
from ..can.dbc import load_dbc
from ..system.system import System
from ..system.toml import data_file
from .unit_maps import check_texts

_MOST = 5  # flaws of one database that a run says


def open_buses(system: System, warnings: list[str]) -> dict[str, Database]:
    """Return the database of each bus by name; adds its flaws, and what does not fit it, to `warnings`.

    Raises ConfigError where a database cannot be read, or has no message that the system file gives settings.
    """
    found: dict[str, Database] = {}
    for name, entry in system.file.buses.items():
        place = f"{system.path}: buses.{name}"
        database = load_dbc(data_file(entry.dbc, system.path, f"{place}.dbc"))
        found[name] = database
        warnings += [said for said in _first(database) if said not in warnings]  # of two buses with one file
        texts = {signal.unit for message in database.messages.values() for signal in message.signals.values()}
        warnings += check_texts(entry.units, texts, f"{place}.units")
        for message in entry.messages:
            database.require(message, f"{place}.messages")
    return found


def _first(database: Database) -> list[str]:
    """Return the first flaws of a database, and how many more there are."""
    left = len(database.warnings) - _MOST
    more = f"{database.path}: {left} more of this kind; `evcosim info {database.path}` lists them"
    return [*database.warnings[:_MOST], *([more] if left > 0 else [])]
