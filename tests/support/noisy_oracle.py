"""A noisy CAN bus, classic and FD, as events and plain objects, written without the code of the frame path.

Frames are texts of bits, each with its own time. Nodes count errors by the fault confinement of ISO 11898-1,
as far as docs/bus.md says that it is modelled. Times are in picoseconds.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping

from .bus_oracle import Frame, Off, Sent, classic_length

_DLC = {12: 9, 16: 10, 20: 11, 24: 12, 32: 13, 48: 14, 64: 15}


@dataclasses.dataclass
class Node:
    """A node: its error counters as sender and as receiver, and from when on it may send."""

    tec: int = 0
    rec: int = 0
    ready: int = 0
    off: Off | None = None
    offs: int = 0

    @property
    def passive(self) -> bool:
        """True beyond the limit of 127 of either counter."""
        return self.tec > 127 or self.rec > 127


@dataclasses.dataclass
class Rates:
    """The times of a bit of the arbitration, and of the data where a frame switches."""

    bit: int
    data: int
    switch: bool


def fd_times(message: Sent, payload: bytes, rates: Rates) -> list[int]:
    """Return the time of each bit of a CAN FD frame, from start of frame to end of frame."""
    identifier = f"{message.identifier:0{29 if message.extended else 11}b}"
    arbitration = f"0{identifier[:11]}11{identifier[11:]}0" if message.extended else f"0{identifier}00"
    head = arbitration + "10" + ("1" if rates.switch else "0")  # FDF, reserved, BRS
    content = head + "0" + f"{_DLC.get(len(payload), len(payload)):04b}"  # ESI: active
    content += "".join(f"{byte:08b}" for byte in payload)
    fast = rates.data if rates.switch else rates.bit
    times, last, run = [], "", 0
    for place, symbol in enumerate(content):
        time = rates.bit if place < len(head) else fast
        if run == 5:  # a stuff bit is the first of the next run; after BRS it has the rate of the data
            times.append(time)
            last, run = ("0" if last == "1" else "1"), 1
        times.append(time)
        last, run = symbol, (run + 1 if symbol == last else 1)
    checked = 4 + (17 if len(payload) <= 16 else 21)  # stuff count and CRC
    fixed = sum(1 for place in range(checked) if place % 4 == 0)
    times += [fast] * (checked + fixed) + [fast]  # the delimiter still has that rate
    return times + [rates.bit] * (2 + 7)


def times_of(message: Sent, payload: bytes, rates: Rates) -> list[int]:
    """Return the time of each bit of a frame."""
    if message.fd:
        return fd_times(message, payload, rates)
    return [rates.bit] * classic_length(message, payload)


@dataclasses.dataclass
class NoisyBus:
    """A bus whose bits are wrong with the probability `chance`.

    `drawn` gives a number in [0, 1) for a message's n-th attempt from 0 on; the frame is right if that is
    beyond the probability that one of its bits is wrong, else its first wrong bit is the one at which that
    probability passes it. `late` gives the share of the jitter of its n-th frame from 1 on.
    """

    messages: list[Sent]
    rates: Rates
    chance: float
    drawn: Callable[[Sent, int], float]
    late: Callable[[Sent, int], float]
    nodes: dict[str, Node] = dataclasses.field(default_factory=dict)
    on_air: list[Frame] = dataclasses.field(default_factory=list)
    attempts: dict[str, int] = dataclasses.field(default_factory=dict)

    def carried(self, payloads: Mapping[tuple[str, int], bytes], steps: int, step: int) -> list[Frame]:
        """Return the frames that were carried, in their order, of those that start before the end."""
        self.nodes = {message.node: Node() for message in self.messages}
        self.attempts = {message.name: 0 for message in self.messages}
        samplings = sorted(
            ((k * step, place) for place, m in enumerate(self.messages)
             for k in range(m.first, steps, m.cycle)),
        )  # fmt: skip # one call
        found: list[Frame] = []
        broken: Frame | None = None  # the frame that was ended by an error, until the bus is free
        now = free = 0
        while now < steps * step:
            if broken is not None and free <= now:
                if broken.message.waiting is None:
                    broken.message.waiting = broken
                else:
                    broken.message.replaced += 1
                broken = None
            while samplings and samplings[0][0] <= now:
                moment, place = samplings.pop(0)
                message = self.messages[place]
                number = (moment // step - message.first) // message.cycle + 1
                ready = moment + int(self.late(message, number) * message.jitter)
                message.sampled.append(Frame(message, payloads[message.name, moment // step], moment, ready))
            for message in self.messages:
                message.queue(now)
            able = [m for m in self.messages if m.waiting and self._may_send(m, now)]
            if free <= now and able:
                frame = min(able, key=lambda m: m.field).waiting
                assert frame is not None
                frame.message.waiting = None
                good = self._send(frame, now)
                free = frame.end + 3 * self.rates.bit
                self._wait(frame, free)
                if good:
                    found.append(frame)
                else:
                    broken = frame
            moments = [free, *(s[0] for s in samplings[:1]), *(n.ready for n in self.nodes.values())]
            moments += [frame.ready for m in self.messages for frame in m.sampled]
            moments += [n.off.back(self.on_air, self.rates.bit) for n in self.nodes.values() if n.off]
            now = min((moment for moment in moments if moment > now), default=steps * step)
        if broken is not None:  # what has begun before the end is counted to its end
            broken.message.replaced += broken.message.waiting is not None
        return found

    def _may_send(self, message: Sent, now: int) -> bool:
        node = self.nodes[message.node]
        if node.off is not None and now >= node.off.back(self.on_air, self.rates.bit):
            node.off = None
        return node.off is None and node.ready <= now

    def _send(self, frame: Frame, now: int) -> bool:
        """Put a frame on the bus; return True if all its bits are right."""
        message = frame.message
        times = times_of(message, frame.payload, self.rates)
        draw = self.drawn(message, self.attempts[message.name])
        self.attempts[message.name] += 1
        wrong = next((n for n in range(len(times)) if draw < 1 - (1 - self.chance) ** (n + 1)), None)
        bits = times if wrong is None else times[: wrong + 1] + [self.rates.bit] * (6 + 6 + 8)
        frame.start, frame.end = now, now + sum(bits)
        for name, node in self.nodes.items():
            if node.off is not None and now < node.off.back(self.on_air, self.rates.bit):
                continue
            if name == message.node:
                node.tec = node.tec + 8 if wrong is not None else max(0, node.tec - 1)
            elif wrong is not None:
                node.rec += 1
            else:
                node.rec = max(0, min(node.rec, 128) - 1)
        self.on_air.append(dataclasses.replace(frame))
        return wrong is None

    def _wait(self, frame: Frame, free: int) -> None:
        """Let a sender that is error passive suspend its transmission, and one beyond 255 be bus-off."""
        node = self.nodes[frame.message.node]
        if node.tec > 255:
            node.tec = node.rec = 0
            node.off, node.offs = Off(frame.message.node, free, free), node.offs + 1
        elif node.passive:
            node.ready = free + 8 * self.rates.bit
