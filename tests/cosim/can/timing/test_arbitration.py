"""The order of frames: that of the bits they send, dominant before recessive."""

from __future__ import annotations

import itertools
import random

from evcosim.cosim.can.timing.arbitration import arbitration_key
from support.can_bits import Frame, wire


def wins(a: tuple[int, bool], b: tuple[int, bool]) -> bool:
    """Return True if `a` wins against `b`: at the first bit that differs it has the dominant one."""
    for first, second in zip(wire(Frame(*a, b"")), wire(Frame(*b, b"")), strict=False):
        if first != second:
            return first == 0
    raise AssertionError("the same frame")


def test_the_key_orders_as_the_bits_do() -> None:
    draw = random.Random(2)
    base = [0, 1, 0x123, 0x124, 0x7FF]
    frames = {(i, False) for i in base}
    frames |= {(i << 18 | low, True) for i in base for low in (0, 1, 0x3FFFF)}
    frames |= {(draw.getrandbits(11), False) for _ in range(10)} | {
        (draw.getrandbits(29), True) for _ in range(10)
    }
    for a, b in itertools.permutations(sorted(frames), 2):
        assert (arbitration_key(*a) < arbitration_key(*b)) == wins(a, b)


def test_a_standard_frame_wins_against_an_extended_one_of_the_same_first_bits() -> None:
    assert arbitration_key(0x123, False) < arbitration_key(0x123 << 18, True) < arbitration_key(0x124, False)
