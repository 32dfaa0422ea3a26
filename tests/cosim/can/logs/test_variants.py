"""Raw values of multiplexers in the frames of a log, and what the frames hold."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs.frames import encoder
from evcosim.cosim.can.logs.variants import Variants, key_of
from evcosim.cosim.can.wire.payload import raw_value
from support.framed import layouts

PAGED = Message(
    "f",
    "M",
    0x10,
    False,
    3,
    signals={
        "P": Signal("P", 4, 3),
        "Q": Signal("Q", 15, 4, little_endian=False, multiplexer="P", multiplexer_ranges=((1, 2),)),
        "A": Signal("A", 16, 8, multiplexer="P", multiplexer_ranges=((0, 1), (5, 5))),
        "B": Signal("B", 16, 4, multiplexer="Q", multiplexer_ranges=((3, 7),)),
        "C": Signal("C", 0, 4),
    },
)


@given(layouts(), st.randoms(use_true_random=False))
def test_raw_values_are_those_that_were_packed(message, draw) -> None:
    whole = {name: s for name, s in message.signals.items() if not s.is_float}
    raws = {name: draw.randint(*map(int, s.raw_type_range)) for name, s in whole.items()}
    data = encoder(message)(raws | dict.fromkeys(message.signals.keys() - whole.keys(), 0.0))
    assert {name: raw_value(s, data) for name, s in whole.items()} == raws


def test_a_signal_of_a_longer_frame() -> None:
    assert raw_value(Signal("S", 7, 4, little_endian=False), b"\xa5\x00\x00") == 10


@given(
    st.lists(st.lists(st.binary(min_size=3, max_size=3), min_size=1, max_size=9), max_size=4),
    st.sets(st.sampled_from("ABC"), min_size=1),
)
def test_frames_are_of_one_variant_where_they_hold_the_same(
    blocks: list[list[bytes]], names: set[str]
) -> None:
    wanted = sorted(names)
    variants, found, frames = Variants([(PAGED, wanted)]), [], []
    for block in blocks:
        data = np.zeros((len(block), 64), dtype=np.uint8)
        data[:, :3] = np.frombuffer(b"".join(block), dtype=np.uint8).reshape(-1, 3)
        found += variants.numbers(key_of(PAGED), data).tolist()
        frames += block
    for number, frame in zip(found, frames, strict=True):
        page, sub = (raw_value(PAGED.signals[name], frame) for name in "PQ")
        held = {"A": page in (0, 1, 5), "B": page in (1, 2) and 3 <= sub <= 7, "C": True}
        expected = tuple(name for name in wanted if held[name])
        assert number == -1 if not expected else variants.found[number].names == expected
    assert len({variant.names for variant in variants.found}) == len(variants.found)
    in_use = list(dict.fromkeys(number for number in found if number >= 0))
    assert in_use == sorted(in_use)
