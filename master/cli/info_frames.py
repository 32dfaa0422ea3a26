"""The part of `evcosim info` on frames: protection, timeouts, and signals that nothing fills."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from .console import print_table, print_title

if TYPE_CHECKING:
    from ...cosim.plan.plan import MessagePlan


def protection_of(plan: MessagePlan) -> dict[str, Any] | None:
    """Return what guards the frames of a message; None for nothing, also where a bus makes no frames."""
    own = plan.settings.of_message(plan.message.name)
    guarded = own.e2e is not None or own.checksum is not None or own.timeout is not None
    if plan.framing is None or not guarded:
        return None
    found = plan.framing.protection
    return {
        "profile": own.e2e.profile if own.e2e is not None else None,
        "function": own.checksum,
        "checksum": found.crc.name if found is not None else None,
        "counter": found.counter.name if found is not None and found.counter is not None else None,
        "timeout": own.timeout,
        "on_timeout": own.on_timeout,
        "status": list(own.status),
    }


def unfilled_of(plan: MessagePlan) -> list[dict[str, Any]]:
    """Return the signals of a message that nothing fills; none where a bus makes no frames."""
    from ...cosim.can.unfilled import unfilled

    if plan.settings.resolution == "ideal":
        return []
    return [
        {"name": each.signal.name, "raw": each.raw, "sent": each.reason}
        for each in unfilled(plan.message, plan.senders, plan.framing)
    ]


def show_frames(messages: list[dict[str, Any]]) -> None:
    """Print what guards the messages, and the signals that nothing fills."""
    if guarded := [message for message in messages if message["protection"]]:
        print_title("Protection and timeouts")
        headers = ("message", "by", "fills", "timeout", "status to")
        print_table(headers, [row for message in guarded for row in _guarded_rows(message)])
    if rows := [row for message in messages for row in _unfilled_rows(message)]:
        print_title("Signals that nothing fills")
        print_table(("message", "signal", "sent as", "raw"), rows, right=("raw",))


def name_of(message: dict[str, Any]) -> str:
    """Return the name of a message, with the page that it is."""
    page = ", ".join(f"{name} {raw}" for name, raw in message["page"].items())
    return f"{message['bus']}.{message['name']}{f' ({page})' if page else ''}"


def _guarded_rows(message: dict[str, Any]) -> list[tuple[str, ...]]:
    own = message["protection"]
    by = f"E2E {own['profile']}" if own["profile"] else own["function"] or ""
    timeout = f"{own['timeout']} cycles, then {own['on_timeout']}" if own["timeout"] else ""
    fills = [name for name in (own["checksum"], own["counter"]) if name]
    pairs = itertools.zip_longest(fills or [""], own["status"], fillvalue="")
    heads = itertools.chain([(name_of(message), by, timeout)], itertools.repeat(("", "", "")))
    return [
        (name, kind, signal, after, status)
        for (name, kind, after), (signal, status) in zip(heads, pairs, strict=False)
    ]


def _unfilled_rows(message: dict[str, Any]) -> list[tuple[str, ...]]:
    return [
        (name_of(message) if i == 0 else "", each["name"], each["sent"], f"{each['raw']:.10g}")
        for i, each in enumerate(message["unfilled"])
    ]
