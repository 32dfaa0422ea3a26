"""What receives the frames of a log; whole runs are in tests/master/test_replay.py."""

from __future__ import annotations

from types import SimpleNamespace

from evcosim.cosim.can.database import Message
from evcosim.cosim.plan.received import Received


def test_messages_that_units_send_are_known_by_identifier() -> None:
    messages = [
        SimpleNamespace(bus="a", message=Message("f", "M", 5), replayed=False),
        SimpleNamespace(bus="a", message=Message("f", "N", 6, True), replayed=True),
        SimpleNamespace(bus="b", message=Message("f", "O", 7), replayed=False),
    ]
    received = Received(None, {}, SimpleNamespace(messages=messages), None, False)
    assert received.sent("a") == {(5, False): "M"}
