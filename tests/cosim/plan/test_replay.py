"""Raw values of multiplexers in the frames of a log."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.logs.frames import encoder
from evcosim.cosim.can.wire.payload import raw_value
from support.framed import layouts


@given(layouts(), st.randoms(use_true_random=False))
def test_raw_values_are_those_that_were_packed(message, draw) -> None:
    whole = {name: s for name, s in message.signals.items() if not s.is_float}
    raws = {name: draw.randint(*map(int, s.raw_type_range)) for name, s in whole.items()}
    data = encoder(message)(raws | dict.fromkeys(message.signals.keys() - whole.keys(), 0.0))
    assert {name: raw_value(s, data) for name, s in whole.items()} == raws


def test_a_signal_of_a_longer_frame() -> None:
    assert raw_value(Signal("S", 7, 4, little_endian=False), b"\xa5\x00\x00") == 10
