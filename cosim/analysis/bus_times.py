"""Times that frames waited and took on a bus in a run, beside those that they can at most."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from ..can.bus_settings import BusSettings
from ..can.logs.frames import BusLog
from ..can.timing.lengths import INTERFRAME, classic_bits, fd_bits
from ..clock import Clock
from ..plan.bus_load import BusLoad

_MOST = 40  # frames of a busy period that are shown
_PICOSECOND = 1e-12
_HEADERS = ("message", "id", "every [ms]", "bytes", "load", "least [ms]", "mean", "most", "bound")


@dataclasses.dataclass(frozen=True)
class Carried:
    """A frame on the bus: the times [s] of the sampling of its message, of its start and of its end."""

    name: str
    sampled: float
    start: float
    end: float


@dataclasses.dataclass(frozen=True)
class BusTimes:
    """A bus in a run: its load before the run, and what was counted (`frames` of run.json).

    `delays` are the effective delays of each message's receivers (`effective_delays` of run.json).
    `period` are the frames of one busy period, in which nobody waits longer than in any other: between two of
    them there is the interframe space alone.
    """

    load: BusLoad
    counted: Mapping[str, Any]
    period: tuple[Carried, ...]
    delays: Mapping[str, Any] = dataclasses.field(default_factory=dict)

    def rows(self) -> list[tuple[str, ...]]:
        """Return a row of texts for each message in the order of arbitration, below `headers`."""
        found = []
        for message in self.load.messages:
            identifier = f"0x{message.identifier:X}"
            latency = self.latency(message.name)
            times = [f"{1e3 * latency[key]:.3f}" if latency else "-" for key in ("min", "mean", "max")]
            bound = "none" if message.response is None else f"{1e3 * message.response:.3f}"
            share = f"{message.least:.1%} to {message.most:.1%}"
            head = (message.name, identifier, message.every, str(message.length))
            found.append((*head, share, *times, bound))
        return found

    def delay_rows(self) -> list[tuple[str, ...]]:
        """Return a row of texts for each message and receiver, below message, receiver and times in ms."""
        return [
            (name, unit, *(f"{1e3 * times[key]:.3f}" if times else "-" for key in ("min", "mean", "max")))
            for name, units in self.delays.items()
            for unit, times in units.items()
        ]

    @staticmethod
    def headers() -> tuple[str, ...]:
        """Return the headers of `rows`."""
        return _HEADERS

    def latency(self, name: str) -> dict[str, float] | None:
        """Return least, mean and greatest time [s] of a message from sampling to the end of its frame.

        None where no frame of it was carried. Pages of a multiplexed message count together.
        """
        pages = [about for page, about in self.counted["messages"].items() if page.split(" ")[0] == name]
        pages = [page for page in pages if page["latency"]]
        if not pages:
            return None
        times = [page["latency"] for page in pages]
        if len(times) == 1:
            return dict(times[0])
        total = sum(page["carried"] * time["mean"] for page, time in zip(pages, times, strict=True))
        mean = total / sum(page["carried"] for page in pages)
        return {"min": min(t["min"] for t in times), "mean": mean, "max": max(t["max"] for t in times)}

    def as_data(self) -> dict[str, Any]:
        """Return all of it for JSON."""
        return {
            **self.load.as_data(),
            "counted": dict(self.counted),
            "effective_delays": dict(self.delays),
            "period": [dataclasses.asdict(frame) for frame in self.period],
        }


def carried(log: BusLog, clock: Clock, settings: BusSettings) -> list[Carried]:
    """Return the frames of a bus on which they take time, in the order of their ends, on the run's clock."""
    found = []
    for step, end, message, data in (frame for part in log.frames if part.sent for frame in part.frames()):
        payload = data.ljust(message.frame_length, b"\0")
        arguments = (message.frame_id, int(message.extended), payload, 0, len(payload))
        if message.fd:
            nominal, fast = fd_bits(*arguments, int(log.switch))
        else:
            nominal, fast = classic_bits(*arguments), 0
        time = nominal / settings.bitrate + fast / (settings.data_bitrate or settings.bitrate)
        ended = clock.start + end * _PICOSECOND
        found.append(Carried(message.name, clock.at(step), ended - time, ended))
    return found


def longest_wait(frames: Sequence[Carried], bitrate: int) -> tuple[Carried, ...]:
    """Return the frames of the busy period in which one took longest from its sampling on, 40 at most."""
    if not frames:
        return ()
    gap = (INTERFRAME + 0.5) / bitrate
    follows = [False] + [b.start - a.end <= gap for a, b in itertools.pairwise(frames)]
    worst = max(range(len(frames)), key=lambda i: frames[i].end - frames[i].sampled)
    first = last = worst
    while follows[first] and worst - first < _MOST // 2:
        first -= 1
    while last + 1 < len(frames) and follows[last + 1] and last - first < _MOST - 1:
        last += 1
    return tuple(frames[first : last + 1])
