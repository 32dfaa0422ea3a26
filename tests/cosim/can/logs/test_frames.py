"""The frames of a run in the order of time, and their bytes."""

from __future__ import annotations

from typing import Any

import pytest

from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs.frames import BusLog, frames
from evcosim.cosim.clock import Clock
from evcosim.cosim.units.measure import Affine

CLOCK = Clock.counted(0.0, 0.01, 0)


def test_frames_of_one_instant_stand_in_the_order_of_arbitration() -> None:
    def one(name: str, frame_id: int, extended: bool = False) -> Any:
        signal = Signal("S", 0, 8)
        message = Message("f", name, frame_id, extended, signals={"S": signal})
        channel = MessageChannel(message, [SignalRoute(signal, 0, Affine(), ())], log_raw=True)
        for k in range(2):
            channel.transmit([0.0], k)
        return channel.log

    logs = [BusLog("can0", [one("C", 0x100 << 18, True), one("D", 0x101), one("B", 0x100), one("A", 1)])]
    assert [f.message.name for f in frames(logs, CLOCK)] == ["A", "B", "C", "D"] * 2


@pytest.mark.parametrize(("length", "padded"), [(3, 3), (8, 8), (9, 12), (12, 12), (33, 48), (64, 64)])
def test_frames_of_can_fd_have_one_of_its_lengths(length: int, padded: int) -> None:
    signal = Signal("S", 8 * length - 8, 8)
    message = Message("f", "M", 1, length=length, signals={"S": signal}, fd=True)
    channel = MessageChannel(message, [SignalRoute(signal, 0, Affine(), ())], log_raw=True)
    channel.transmit([171.0], 0)
    for switch in (False, True):
        (frame,) = frames([BusLog("can0", [channel.log], switch=switch)], CLOCK)
        assert frame.data == b"\0" * (length - 1) + b"\xab" + b"\0" * (padded - length)
        assert frame.fd and frame.switch == switch
