"""Raw values in the bytes of a frame, against cantools' codec."""

from __future__ import annotations

import struct

from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs.frames import encoder
from evcosim.cosim.can.wire.payload import high_bits, low_bits, place_of, put, raw_value, whole, words
from support.framed import layouts


def place(signal: Signal) -> tuple[int, int, int]:
    start, little = place_of(signal)
    return little, start, signal.length


def pattern(signal: Signal, raw: float | int) -> int:
    """The bits of a raw value as a whole number."""
    if not signal.is_float:
        return int(raw)
    kind = "<f" if signal.length == 32 else "<d"
    return int.from_bytes(struct.pack(kind, raw), "little")


def packed(message: Message, raws: dict[str, float | int]) -> list[int]:
    frame = [0] * message.length
    for name, raw in raws.items():
        signal = message.signals[name]
        put(frame, *place(signal), *words(pattern(signal, raw)))
    return frame


@settings(deadline=None, max_examples=300)
@given(layouts(), st.data())
def test_bytes_are_those_of_cantools_and_come_back(message, data):
    raws = {}
    for signal in message.signals.values():
        if signal.is_float:
            raws[signal.name] = data.draw(st.floats(width=signal.length, allow_nan=False))
        else:
            raws[signal.name] = data.draw(st.integers(*map(int, signal.raw_type_range)))
    frame = packed(message, raws)
    assert bytes(frame) == encoder(message)(raws)
    for name, raw in raws.items():
        signal = message.signals[name]
        low, high = low_bits(frame, *place(signal)), high_bits(frame, *place(signal))
        assert low | high << 32 == pattern(signal, raw) & ((1 << signal.length) - 1)
        assert signal.is_float or raw_value(signal, bytes(frame)) == raw


def test_every_length_start_and_order():
    for little in (True, False):
        for length in range(1, 65):
            for start in range(128 - length):
                signal = Signal("S", start, length, little_endian=little)
                if max(signal.bits) >= 128:
                    continue
                value = 0x9E3779B97F4A7C15 & ((1 << length) - 1)
                frame = [0] * 16
                put(frame, *place(signal), *words(value))
                bits = [frame[b // 8] >> b % 8 & 1 for b in signal.bits]
                assert sum(bit << i for i, bit in enumerate(bits)) == value
                assert sum(map(int.bit_count, frame)) == value.bit_count()
                assert low_bits(frame, *place(signal)) | high_bits(frame, *place(signal)) << 32 == value


def test_places_count_from_the_first_bit_that_is_sent():
    assert place_of(Signal("S", 16, 8)) == (16, 1)
    assert place_of(Signal("S", 0, 3, little_endian=False)) == (7, 0)
    assert place_of(Signal("S", 15, 3, little_endian=False)) == (8, 0)


def test_whole_extends_the_sign():
    assert whole(0xFF, 0, 8, 1) == -1
    assert whole(0x7F, 0, 8, 1) == 127
    assert whole(0xFF, 0, 8, 0) == 255
    assert whole(0xFFFFFFFF, 0x3FF, 42, 1) == -1
