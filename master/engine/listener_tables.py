"""The receivers of messages that hear and judge frames alike, as tables (`cosim.can.wire.tables`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cosim.can.protection.counters import NO_NEW_DATA, STATUSES, taken
from ...cosim.can.wire import tables as T
from ...cosim.plan.plan import MessagePlan
from ...cosim.plan.readers import Reader
from .fault_tables import Arrays, nodes_of, owner_of

Rows = dict[int, int]
"""The rows of listeners of a message by the mailboxes of its receivers."""


def add_listeners(
    made: Arrays, plans: Sequence[MessagePlan], receiving: Mapping[int, tuple[str, str]]
) -> list[Rows]:
    """Add the table of the listeners of messages, and of their verdicts; return the rows of each message.

    A message has one for each node that can be off the bus, by `receiving`, and one for all other receivers,
    which hear the same. The pages of a multiplexed message have them together.
    """
    nodes, messages = nodes_of(plans), made["messages"]
    mailboxes: dict[tuple[str, object], list[int]] = {}
    for plan in plans:
        mailboxes.setdefault(_key(plan), []).extend(_mailboxes(plan))
    table: list[list[int]] = []
    rows: dict[tuple[str, object], tuple[int, dict[int, int]]] = {}
    for key, slots in mailboxes.items():
        owners = list(dict.fromkeys(owner_of(slot, nodes, receiving) for slot in slots)) or [-1]
        rows[key] = len(table), {owner: len(table) + i for i, owner in enumerate(owners)}
        table += [[owner, *[0] * (T.LISTENING - 1)] for owner in owners]
    made["listeners"] = np.array(table or [[-1, *[0] * (T.LISTENING - 1)]], dtype=np.int64)
    made["listeners"][:, T.LAST] = -1
    verdicts, found = 0, []
    for i, plan in enumerate(plans):
        first, of_owner = rows[_key(plan)]
        messages[i, [T.FIRST_LISTENER, T.LISTENERS, T.FIRST_VERDICT]] = first, len(of_owner), verdicts
        messages[i, T.OWNED] = max(of_owner) >= 0
        verdicts += len(of_owner)
        if plan.framing is not None and plan.framing.protection is not None:
            made["listeners"][first : first + len(of_owner), T.GAP] = plan.framing.protection.max_delta
        found.append({slot: of_owner[owner_of(slot, nodes, receiving)] for slot in _mailboxes(plan)})
    made["verdicts"] = np.zeros((max(1, verdicts), T.VERDICTS), dtype=np.int64)
    return found


def _key(plan: MessagePlan) -> tuple[str, object]:
    return plan.bus, plan.message.priority


def _mailboxes(plan: MessagePlan) -> list[int]:
    status = plan.framing.status if plan.framing is not None else ()
    return [*(slot for route in plan.routes for slot, _ in route.sinks), *status]


def judgments(made: Arrays, row: int) -> list[dict[str, Any]]:
    """Return for each listener of the message in a row the counts of timeouts, and of statuses by name.

    With them come the frames that were not taken.
    """
    message = made["messages"][row]
    found = []
    for i in range(int(message[T.LISTENERS])):
        timeouts = int(made["listeners"][message[T.FIRST_LISTENER] + i, T.TIMEOUTS])
        counts = made["verdicts"][message[T.FIRST_VERDICT] + i]
        found.append(_counted(message, timeouts if message[T.PAGE] == 0 else 0, counts))
    return found


def _counted(message: NDArray[np.int64], timeouts: int, verdicts: NDArray[np.int64]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if message[T.TIMEOUT]:
        found["timeouts"] = timeouts
    if message[T.PROFILE]:
        refused = [code for code in STATUSES if code != NO_NEW_DATA and not taken(code)]
        found["rejected"] = int(verdicts[refused].sum())
        found["statuses"] = {name: int(verdicts[code]) for code, name in STATUSES.items() if verdicts[code]}
    return found


def by_receiver(made: Arrays, row: int, nodes: Sequence[tuple[str, str]]) -> dict[str, Any]:
    """Return the counts of `judgments` of the message in a row; where they differ, under `receivers`.

    They have the names of their `nodes`, those that cannot be off the bus "others".
    """
    found = judgments(made, row)
    if all(each == found[0] for each in found):
        return found[0]
    first = int(made["messages"][row, T.FIRST_LISTENER])
    owners = made["listeners"][first : first + len(found), T.OWNER].tolist()
    names = [nodes[owner][1] if owner >= 0 else "others" for owner in owners]
    return {"receivers": dict(zip(names, found, strict=True))}


def add_uses(made: Arrays, receivers: Sequence[Sequence[Reader]]) -> None:
    """Add the table of uses to those of the frame path; `receivers` are those of its rows of messages."""
    table: list[list[int]] = []
    for i, own in enumerate(receivers):
        rows = _of_sinks(made, i)
        made["messages"][i, [T.FIRST_USE, T.USES]] = len(table), len(own)
        table += [[r.every, r.first, r.later, rows[r.mailbox], -1, *[0] * (T.USE - 5)] for r in own]
    made["uses"] = np.array(table or [[1] + [0] * (T.USE - 1)], dtype=np.int64)


def _of_sinks(made: Arrays, row: int) -> Rows:
    """Return the rows of listeners of the message in a row, by the mailboxes of its signals' receivers."""
    first, count = made["messages"][row, [T.FIRST_SIGNAL, T.SIGNALS]].tolist()
    ends = made["signals"][first : first + count, [T.FIRST_SINK, T.SINKS]].tolist()
    sinks = [made["sinks"][i].tolist() for begin, number in ends for i in range(begin, begin + number)]
    return {sink[T.SLOT]: sink[T.LISTENER] for sink in sinks}
