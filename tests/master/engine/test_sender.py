"""A message in the schedule: what it sends arrives with its delay, and its errors name both ends."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.can.quantization import ChannelError
from evcosim.cosim.errors import RunError
from evcosim.master.engine.schedule import Waiting
from evcosim.master.engine.sender import Sender
from evcosim.master.unit import floats


class Copying:
    """A channel that copies slot 0 to slot 1, and refuses numbers below 0."""

    def transmit(self, memory: Any, k: int) -> None:
        if memory[0] < 0.0:
            raise ChannelError("Speed", memory[0], "is below its range")
        memory[1] = memory[0]


def sender(memory: Any, waiting: Waiting | None) -> Sender:
    plan: Any = SimpleNamespace(
        bus="can0", message=SimpleNamespace(name="Status"), senders={"Speed": "vehicle.speed"}, first=0,
        every=2, delay=4, arrivals=((1, 2),),
    )  # fmt: skip # keywords
    channel: Any = Copying()
    return Sender(plan, channel, floats(memory), waiting)


def test_values_arrive_after_the_delay() -> None:
    memory = np.zeros(6)
    made = sender(memory, Waiting(3, 2, 1))
    for k, value in ((0, 1.0), (2, 2.0)):
        memory[0] = value
        made.send(k)
    assert memory[2] == 0.0
    made.deliver(4)
    assert memory[2] == 1.0
    made.deliver(6)
    assert memory[2] == 2.0


def test_a_value_that_cannot_be_sent_is_named() -> None:
    memory = np.array([-1.0, 0.0])
    with pytest.raises(RunError, match=r"^vehicle.speed via can0.Status.Speed: is below its range$"):
        sender(memory, None).send(0)
