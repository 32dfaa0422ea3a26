"""A CAN bus as events and plain objects: what the frame path must give, written without its code.

Frames are strings of bits that are stuffed by search and replace. Times are in picoseconds.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Mapping


@dataclasses.dataclass
class Sent:
    """A message of the oracle: who wins is decided by comparing arbitration fields as texts of bits."""

    name: str
    identifier: int
    extended: bool
    cycle: int
    first: int
    jitter: int
    waiting: Frame | None = None
    replaced: int = 0

    @property
    def field(self) -> str:
        """The bits that are compared: recessive RTR and IDE of an extended frame lose."""
        if self.extended:
            return f"{self.identifier:029b}"[:11] + "11" + f"{self.identifier:029b}"[11:] + "0"
        return f"{self.identifier:011b}00"


@dataclasses.dataclass
class Frame:
    """A frame that was sampled, and when it may start and ended."""

    message: Sent
    payload: bytes
    sampled: int
    ready: int
    end: int = -1


def stuffed_length(bits: str) -> int:
    """Return the number of bits of a text with a stuff bit after each five equal ones."""
    out = ""
    for bit in bits:
        out += bit
        if re.search(r"(0{5}|1{5})$", out):
            out += "0" if bit == "1" else "1"
    return len(out)


def crc15(bits: str) -> str:
    """Return the remainder of the polynomial of classic CAN, by long division."""
    number = int(bits + "0" * 15, 2)
    for place in range(len(bits) - 1, -1, -1):
        if number >> (place + 15) & 1:
            number ^= 0xC599 << place
    return f"{number:015b}"


def classic_length(message: Sent, payload: bytes) -> int:
    """Return the bits of a classic frame from start of frame to end of frame."""
    data = "".join(f"{byte:08b}" for byte in payload)
    control = ("00" if message.extended else "0") + f"{len(payload):04b}"
    content = "0" + message.field + control + data
    return stuffed_length(content + crc15(content)) + 1 + 2 + 7


def carried(
    messages: list[Sent],
    payloads: Mapping[tuple[str, int], bytes],
    steps: int,
    step: int,
    bit: int,
    drawn: Callable[[Sent, int], float],
) -> list[Frame]:
    """Return the frames in the order in which the bus carried them, of those that start before the end.

    `payloads` are by message and step; `drawn` gives the share of the jitter of a message's n-th frame.
    """
    samplings = sorted(
        (k * step, k, message.name)
        for message in messages
        for k in range(message.first, steps, message.cycle)
    )
    by_name = {message.name: message for message in messages}
    counts = dict.fromkeys(by_name, 0)
    found: list[Frame] = []
    now, free = 0, 0
    while True:
        for moment, k, name in [s for s in samplings if s[0] <= now]:
            message = by_name[name]
            counts[name] += 1
            message.replaced += message.waiting is not None
            ready = moment + int(drawn(message, counts[name]) * message.jitter)
            message.waiting = Frame(message, payloads[name, k], moment, ready)
            samplings.remove((moment, k, name))
        ready = [m for m in messages if m.waiting is not None and m.waiting.ready <= now]
        if free <= now and ready:
            winner = min(ready, key=lambda m: m.field)
            frame, winner.waiting = winner.waiting, None
            assert frame is not None
            frame.end = now + classic_length(winner, frame.payload) * bit
            free = frame.end + 3 * bit
            found.append(frame)
        moments = [free, *(s[0] for s in samplings), *(m.waiting.ready for m in messages if m.waiting)]
        later = [moment for moment in moments if moment > now]
        if not later or min(later) >= steps * step:
            return found
        now = min(later)
