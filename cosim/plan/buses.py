"""The buses of a system: their databases, with what is wrong in them said."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..can.database import Database, Message
from ..can.formats import load_database
from ..errors import ConfigError, nearest
from ..system.system import System
from ..system.toml import data_file
from .plan import MessagePlan
from .unit_maps import check_texts

_MOST = 5  # flaws of one database that a run says


def open_buses(system: System, warnings: list[str]) -> dict[str, Database]:
    """Return the database of each bus by name; adds its flaws, and what does not fit it, to `warnings`.

    Raises ConfigError where a database cannot be read, or has no message that the system file gives settings.
    """
    found: dict[str, Database] = {}
    for name, entry in system.file.buses.items():
        place = f"{system.path}: buses.{name}"
        database = load_database(data_file(entry.dbc, system.path, f"{place}.dbc"))
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


def check_one_sender(
    system: System, message: Message, units: tuple[str, str], signals: tuple[str, str], place: str
) -> None:
    """Raise ConfigError, which starts with `place`, where two units send signals of one message.

    Two units that both are its node, by their `nodes`, may: they are parts of one control unit.
    """
    one, other = (set(system.file.units[unit].nodes) for unit in units)
    if units[0] == units[1] or one & other & set(message.senders):
        return
    node = message.senders[0] if message.senders else "NODE"
    raise ConfigError(
        f"{place}: {message.name}.{signals[0]} is sent by unit '{units[0]}', and {message.name}.{signals[1]} "
        f"by '{units[1]}': one node sends a message; where both units are parts of it, say so in both: "
        f'nodes = ["{node}"]'
    )


def foreign_senders(
    messages: Iterable[MessagePlan], system: System, databases: Mapping[str, Database]
) -> list[str]:
    """Return a warning for each message whose sender is another node than the database says.

    A unit is the nodes that its `nodes` name. One without them is the node of its name, whatever the case,
    or else one node, which has all the messages that it sends. Raises ConfigError for a node that there is
    not in `databases`.
    """
    warnings: list[str] = []
    units = system.file.units
    known = {node for database in databases.values() for node in database.nodes}
    for unit, entry in units.items():
        for node in entry.nodes:
            if node not in known:
                raise ConfigError(
                    f"{system.keys_of(unit)}nodes: no CAN database has a node '{node}'{nearest(node, known)}"
                )
    by_name = {unit.casefold(): unit for unit in units}
    first: dict[tuple[str, str], MessagePlan] = {}
    for plan in messages:
        declared = plan.message.senders
        if not declared or not plan.senders:
            continue
        unit = next(iter(plan.senders.values())).split(".")[0]
        named = [by_name[node.casefold()] for node in declared if node.casefold() in by_name]
        before = first.setdefault((plan.bus, unit), plan).message
        if units[unit].nodes:
            other = "" if set(units[unit].nodes) & set(declared) else f"which is {_and(units[unit].nodes)}"
        elif named:
            other = "" if unit in named else f"and not {_and(named)}"
        else:
            other = (
                "" if set(before.senders) & set(declared) else f"and {before.name} of {_and(before.senders)}"
            )
        if other:
            where = f"{plan.message.file}: {plan.bus}.{plan.message.name} is a message of {_and(declared)}"
            warnings.append(
                f"{where}, but unit '{unit}' sends it, {other}; `nodes` of the unit can name its nodes"
            )
    return list(dict.fromkeys(warnings))


def _and(names: Iterable[str]) -> str:
    return " and ".join(names)
