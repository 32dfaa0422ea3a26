"""What a log brings to a run; whole runs are in tests/master/test_replay.py."""

from __future__ import annotations

from types import SimpleNamespace

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs.variants import Variant
from evcosim.cosim.plan.replay import _routed


def test_a_variant_of_a_message_has_the_routes_of_its_signals() -> None:
    message = Message("f", "M", 1, False, 8, signals={name: Signal(name, 0, 8) for name in "AB"})
    routes = [SimpleNamespace(signal=signal) for signal in message.signals.values()]
    variants = [Variant("M", ("A", "B"), {}), Variant("M", ("B",), {"P": 3})]
    (first, second) = _routed(variants, [(message, routes)])
    assert first.routes == routes and second.routes == routes[1:]
    assert (second.message, second.page) == (message, {"P": 3})
