"""The order in which the units of a run step, and when the output of one reaches another.

Under `gauss_seidel` units take their turns one after the other, and a receiver behind the sender has what the
sender has just computed; under `jacobi` all receive what was there before any stepped.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .manifest_facts import items_of, records_of, texts_of

AT_ONCE = "in the same step"
AT_BEGIN = "as the step begins"
LATER = "a step later"


def arrivals(manifest: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return sender, receiver, bus signal ("" for a direct connection) and arrival for each receiver."""
    order = texts_of(manifest.get("order"))
    sampled = {
        f"{unit}.{output}"
        for unit, about in items_of(manifest.get("units"))
        for output in texts_of(dict(items_of(about)).get("sampled"))
    }
    gauss_seidel = dict(items_of(manifest.get("experiment"))).get("algorithm") == "gauss_seidel"
    connections = records_of(manifest.get("connect"))
    ideal = bool(manifest.get("ideal"))
    # all signals of a message are sent together, behind the turn of the unit whose sampled output is in it
    late = {_message(c) for c in connections if str(c.get("from", "")) in sampled}
    found = []
    for connection in connections:
        sender, via = str(connection.get("from", "")), "" if ideal else str(connection.get("via") or "")
        fresh = sender in sampled or not via or _message(connection) in late
        for receiver in texts_of(connection.get("to")):
            first = _place(order, sender) < _place(order, receiver)
            if gauss_seidel and first and fresh:
                when = AT_ONCE
            else:
                when = LATER if sender in sampled or (via and _message(connection) in late) else AT_BEGIN
            found.append((sender, receiver, via, when))
    return found


def _message(connection: Mapping[str, Any]) -> str:
    return str(connection.get("via") or "").rpartition(".")[0]


def _place(order: list[str], variable: str) -> int:
    unit = variable.partition(".")[0]
    return order.index(unit) if unit in order else -1


def reasons(manifest: Mapping[str, Any]) -> dict[str, str]:
    """Return for each unit, in the order of their steps, what it receives from whom, and when."""
    said: dict[str, dict[str, list[str]]] = {unit: {} for unit in texts_of(manifest.get("order"))}
    for sender, receiver, _, when in arrivals(manifest):
        senders = said.setdefault(receiver.partition(".")[0], {}).setdefault(when, [])
        if (unit := sender.partition(".")[0]) not in senders:
            senders.append(unit)
    return {
        unit: "; ".join(f"{', '.join(senders)} ({when})" for when, senders in by_time.items())
        for unit, by_time in said.items()
    }
