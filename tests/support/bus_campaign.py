"""Simulated latencies against the bounds of the response-time analysis, over many seeds.

    .venv/bin/python tests/support/bus_campaign.py            # the table of docs/bus.md

Three sets of messages (the DBC of the project; random ones with jitter; CAN FD and extended), three bit
rates, 60 seeds each. A seed draws when each message starts; in every third all start at once. Payloads are
random, or for odd seeds those with the most stuff bits of some patterns.
"""

from __future__ import annotations

import dataclasses
import random
import sys
from collections.abc import Sequence

import numpy as np

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel
from evcosim.cosim.can.database import Message
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.framing import framing_of
from evcosim.cosim.can.timing.lengths import classic_bits, fd_bits
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.bus_load import bus_loads
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.schedule import Action
from evcosim.master.engine.sender import Sender

if __name__ == "__main__":
    sys.path.insert(0, str(__import__("pathlib").Path(__file__).parents[1]))
from support.databases import EV

STEP, STEPS, SEEDS = 1e-3, 300, 60
RATES = (250_000, 500_000, 1_000_000)
SETS = ("the project's DBC", "random, with jitter", "CAN FD and extended")
_PATTERNS = (0x00, 0xFF, 0x0F, 0x1E, 0x3C, 0x78, 0xF0, 0xE1, 0xC3, 0x87)


@dataclasses.dataclass(frozen=True)
class Traffic:
    """Messages with their cycles in steps, and the settings of their bus."""

    messages: tuple[Message, ...]
    cycles: tuple[int, ...]
    use: BusSettings


def traffic(name: str, rate: int) -> Traffic:
    """Return a set of messages on a bus of a bit rate."""
    chance = random.Random(name)
    if name == SETS[0]:
        messages = tuple(m for m in load_dbc(EV).messages.values() if m.cycle_time)
        cycles = tuple(round((m.cycle_time or 0.0) / STEP) for m in messages)
        return Traffic(messages, cycles, BusSettings(timing="frame", bitrate=rate))
    fd = name == SETS[2]
    numbers = chance.sample(range(0x10, 0x7F0), 12)
    messages = tuple(
        Message(
            "campaign", f"M{i}", number << 18 | i if fd and i % 2 else number, bool(fd and i % 2),
            chance.choice((8, 12, 16, 24, 32, 64) if fd and i % 3 else (2, 4, 8)), fd=bool(fd and i % 3),
            senders=("N",),
        )
        for i, number in enumerate(numbers)
    )  # fmt: skip # fields of a message
    cycles = tuple(chance.choice((10, 20, 20, 50)) for _ in messages)
    use = BusSettings(
        timing="frame", bitrate=rate, data_bitrate=2_000_000 if fd else None, jitter=0.0 if fd else 1.3e-3
    )
    return Traffic(messages, cycles, use)


def ratios(about: Traffic, seed: int, steps: int = STEPS) -> dict[str, float]:
    """Return the greatest latency of each message in a run, as a part of its bound."""
    chance = random.Random(seed)
    use = about.use.model_copy(update={"seed": seed})
    plans = [
        MessagePlan("can0", m, use, (), {}, every, 0 if seed % 3 == 0 else chance.randrange(every), None,
                    framing=framing_of(m, use))
        for m, every in zip(about.messages, about.cycles, strict=True)
    ]  # fmt: skip # one call
    senders = [
        Sender(plan, MessageChannel(plan.message, ()), memoryview(np.zeros(1)), None) for plan in plans
    ]
    path = FramePath(senders, np.zeros(1), STEP, logs=False)
    for row, sender in enumerate(path.senders):
        message = sender.plan.message
        size = message.frame_length
        payload = longest(message, use) if seed % 2 else list(chance.randbytes(size))
        path.arrays["base"][row, :size] = payload
    for k in range(steps):
        path.act(*path.operation(Action("arrive", 0)), k)
        for i, plan in enumerate(plans):
            if k >= plan.first and (k - plan.first) % plan.every == 0:
                path.act(*path.operation(Action("send", i)), k)
        path.act(*path.operation(Action("contend", 0)), k)
    bounds = {m.name: m.response for m in bus_loads(plans, STEP)["can0"].messages}
    found = {}
    for row, sender in zip(path.arrays["messages"].tolist(), path.senders, strict=False):
        bound = bounds[sender.plan.message.name]
        assert bound is not None
        found[sender.plan.message.name] = row[T.LATENCY_MOST] * 1e-12 / bound
    return found


def longest(message: Message, use: BusSettings) -> list[int]:
    """Return the payload of those that repeat a byte whose frame takes the most bits."""
    size = message.frame_length

    def bits(byte: int) -> int:
        of = message.frame_id, message.extended, [byte] * size, 0, size
        return sum(fd_bits(*of, use.data_bitrate is not None)) if message.fd else classic_bits(*of)

    return [max(_PATTERNS, key=bits)] * size


def best(about: Traffic, seeds: Sequence[int], steps: int = STEPS) -> dict[str, float]:
    """Return the greatest ratio of each message over the seeds."""
    runs = [ratios(about, seed, steps) for seed in seeds]
    return {name: max(run[name] for run in runs) for name in runs[0]}


def main() -> None:
    """Print the table: worst load, and of the messages' greatest ratios the greatest, middle and least."""
    print("| messages | bit/s | load at most | greatest part of the bound | middle message | least |")
    print("| --- | --: | --: | --: | --: | --: |")
    for name in SETS:
        for rate in RATES:
            about = traffic(name, rate)
            plans = [
                MessagePlan("can0", m, about.use, (), {}, every, 0, None, framing=framing_of(m, about.use))
                for m, every in zip(about.messages, about.cycles, strict=True)
            ]
            load = bus_loads(plans, STEP)["can0"].most
            found = sorted(best(about, range(SEEDS)).values())
            cells = [f"{load:.1%}", *(f"{x:.1%}" for x in (found[-1], found[len(found) // 2], found[0]))]
            print(f"| {name} | {rate} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
