"""A CAN bus as events and plain objects: what the frame path must give, written without its code.

Frames are strings of bits that are stuffed by search and replace. Times are in picoseconds.
"""

from __future__ import annotations

import bisect
import dataclasses
import re
from collections.abc import Callable, Mapping, Sequence


@dataclasses.dataclass
class Sent:
    """A message of the oracle: who wins is decided by comparing arbitration fields as texts of bits."""

    name: str
    identifier: int
    extended: bool
    cycle: int
    first: int
    jitter: int
    node: str = ""
    waiting: Frame | None = None
    sampled: list[Frame] = dataclasses.field(default_factory=list)
    replaced: int = 0
    kind: str = "cyclic"
    interval: int = 0
    fd: bool = False

    @property
    def field(self) -> str:
        """The bits that are compared: recessive RTR and IDE of an extended frame lose."""
        if self.extended:
            return f"{self.identifier:029b}"[:11] + "11" + f"{self.identifier:029b}"[11:] + "0"
        return f"{self.identifier:011b}00"

    def queue(self, now: int) -> None:
        """Let each sampled frame whose time has come take the place of one that waits."""
        while self.sampled and self.sampled[0].ready <= now:
            self.replaced += self.waiting is not None
            self.waiting = self.sampled.pop(0)


@dataclasses.dataclass
class Frame:
    """A frame that was sampled, and when it may start and ended."""

    message: Sent
    payload: bytes
    sampled: int
    ready: int
    end: int = -1
    start: int = -1


@dataclasses.dataclass
class Babbler:
    """A message of zeros that is there from `since` to before `until`, at a period or (0) always."""

    message: Sent
    length: int
    since: int
    until: int
    period: int


@dataclasses.dataclass
class Off:
    """A node that is forced off the bus from `since` to before `until`, and recovers then."""

    node: str
    since: int
    until: int

    def back(self, frames: list[Frame], bit: int) -> int:
        """Return when it is back if the bus, which carried these frames, stays idle after the last one.

        Each stretch of recessive bits counts as many rows of 11 as are in it: those from the delimiter of a
        frame's acknowledgment (8 bits before its end) to the next frame's start.
        """
        later = bisect.bisect_right(frames, self.until, key=lambda frame: frame.start)  # no row is before it
        begin = frames[later - 1].end - 8 * bit if later else 0
        left = 128
        for place in range(later, len(frames) + 1):
            begin = max(begin, self.until)
            end = frames[place].start if place < len(frames) else 10**18
            rows = max(0, end - begin) // (11 * bit)
            if rows >= left:
                return begin + left * 11 * bit
            left -= rows
            begin = frames[place].end - 8 * bit
        raise AssertionError("the last stretch has no end")


def requested(message: Sent, values: Sequence[int], idle: int) -> list[int]:
    """Return the steps at which a message is sent whose payload, as a number, is that of `values` in each.

    Written as a list of requests that wait for the end of the interval after the frame before.
    """
    cyclic = {k for k in range(message.first, len(values)) if (k - message.first) % message.cycle == 0}
    looks = range(message.first, len(values))
    changes = {k for k in looks if k == message.first or values[k] != values[k - 1]}
    if message.kind == "cyclic":
        return sorted(cyclic)
    if message.kind == "on_change":
        requests = changes
    elif message.kind == "cyclic_and_on_change":
        requests = cyclic | changes
    elif message.kind == "on_write":
        requests = set(looks)
    else:
        requests, since = set(), None
        for k in looks:
            if values[k] == idle:
                requests |= {k} if since is not None else set()
                since = None
            else:
                since = k if since is None else since
                requests |= {k} if (k - since) % message.cycle == 0 else set()
    sent: list[int] = []
    for k in looks:
        if any(r <= k and (not sent or r > sent[-1]) for r in requests) and (
            not sent or k - sent[-1] >= message.interval
        ):
            sent.append(k)
    return sent


def struck(
    times: Sequence[int],
    since: int,
    until: int,
    every: int,
    count: int | None,
    by_chance: Callable[[int], bool],
) -> list[int]:
    """Return those of the frames sampled at `times` that a fault hits, whatever others do to them.

    `by_chance` says of the n-th frame in its time, from 1 on, if the draw is for the fault.
    """
    met = [time for time in times if since <= time < until]
    return [time for n, time in enumerate(met) if n % every == 0 and by_chance(n + 1)][:count]


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
    offs: Sequence[Off] = (),
    babblers: Sequence[Babbler] = (),
    sent_at: Mapping[str, Sequence[int]] | None = None,
) -> list[Frame]:
    """Return the frames in the order in which the bus carried them, of those that start before the end.

    `payloads` are by message and step; `drawn` gives the share of the jitter of a message's n-th frame;
    `sent_at` are the steps of each message where it is not sent at each cycle.
    """
    end = steps * step
    samplings = [
        (k * step, message, payloads[message.name, k])
        for message in messages
        for k in (sent_at or {}).get(message.name, range(message.first, steps, message.cycle))
    ]
    for babbler in babblers:
        until = min(babbler.until, end)
        times = range(babbler.since, until, babbler.period) if babbler.period else ()
        samplings += [(time, babbler.message, bytes(babbler.length)) for time in times]
    samplings.sort(key=lambda s: s[0])
    all_of_them = messages + [babbler.message for babbler in babblers]
    counts = {message.name: 0 for message in all_of_them}
    found: list[Frame] = []
    now, free = 0, 0
    while True:
        while samplings and samplings[0][0] <= now:
            moment, message, payload = samplings.pop(0)
            counts[message.name] += 1
            ready = moment + int(drawn(message, counts[message.name]) * message.jitter)
            message.sampled.append(Frame(message, payload, moment, ready))
        for message in all_of_them:
            message.queue(now)
        for babbler in babblers:
            if not babbler.period and babbler.since <= now:
                babbler.message.waiting = Frame(babbler.message, bytes(babbler.length), now, now)
            if now >= babbler.until:
                babbler.message.waiting = None
        backs = [(off, off.back(found, bit)) for off in offs]
        away = {off.node for off, back in backs if off.since <= now < back}
        able = [m for m in all_of_them if m.waiting and m.node not in away]
        if free <= now and able:
            winner = min(able, key=lambda m: m.field)
            frame, winner.waiting = winner.waiting, None
            assert frame is not None
            frame.start, frame.end = now, now + classic_length(winner, frame.payload) * bit
            free = frame.end + 3 * bit
            found.append(frame)
            continue
        moments = [free, *(s[0] for s in samplings), *(b.since for b in babblers), *(b for _, b in backs)]
        moments += [frame.ready for m in all_of_them for frame in m.sampled]
        later = [moment for moment in moments if moment > now]
        if not later or min(later) >= end:
            return found
        now = int(min(later))
