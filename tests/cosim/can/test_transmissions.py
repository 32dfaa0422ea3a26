"""The transmissions that a channel keeps: in a file what they are in memory, and read in stretches."""

from __future__ import annotations

import tracemalloc

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can import transmissions
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Signal
from evcosim.cosim.units.measure import Affine
from support.channels import POWER, THROTTLE, channel_of, memory_of, message


@given(st.lists(st.integers(0, 2**64 - 1), max_size=12), st.sets(st.integers(0, 11)))
def test_a_log_in_a_file_is_that_in_memory(raws: list[int], flushes: set[int]) -> None:
    """Also of integers whose bytes, taken for a double, are a NaN."""
    wide = Signal("Wide", 0, 64)
    channels = [MessageChannel(message(wide), [SignalRoute(wide, 0, Affine(), ())], log_raw=True)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(transmissions, "_MEMORY", 0)
        channels.append(MessageChannel(message(wide), [SignalRoute(wide, 0, Affine(), ())], log_raw=True))
    for k, raw in enumerate(raws):
        for channel in channels:
            channel.transmit(memory_of(min(float(raw), 2.0**64 - 2048)), k)
        if k in flushes:
            channels[1].flush()
    kept, filed = (channel.log for channel in channels)
    assert kept.steps.tolist() == filed.steps.tolist() == list(range(len(raws)))
    assert kept.raws["Wide"].tolist() == filed.raws["Wide"].tolist()
    assert kept.raws["Wide"].tolist() == [min(int(float(raw)), 2**64 - 2048) for raw in raws]


def test_a_long_log_is_not_in_memory() -> None:
    """Three times the transmissions take no more of it, kept or read: not even their own bytes."""
    peaks = []
    for count in (60_000, 200_000):
        channel = channel_of(THROTTLE, POWER, log_raw=True)
        memory = memory_of(1.0, 2.0)
        tracemalloc.start()
        for k in range(count):
            channel.transmit(memory, k)
            if k % 1000 == 0:
                channel.flush()
        assert sum(len(steps) for steps, _ in channel.log.stretches()) == count
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] - peaks[0] < 0.2 * 24 * 140_000


@pytest.mark.parametrize("length", [1, 4, 7])
def test_stretches_are_the_whole_in_order(monkeypatch: pytest.MonkeyPatch, length: int) -> None:
    monkeypatch.setattr(transmissions, "_STRETCH", length)
    channel = channel_of(THROTTLE, POWER, log_raw=True)
    for k in range(10):
        channel.transmit(memory_of(float(k), -2.0 * k), 3 * k)
    log = channel.log
    stretches = list(log.stretches())
    assert [len(steps) for steps, _ in stretches] == [min(length, 10 - k) for k in range(0, 10, length)]
    assert [k for steps, _ in stretches for k in steps] == log.steps.tolist() == list(range(0, 30, 3))
    for name in ("Throttle", "Power"):
        assert [r for _, raws in stretches for r in raws[name]] == log.raws[name].tolist()


def test_an_empty_log_has_no_stretch() -> None:
    log = channel_of(THROTTLE, log_raw=True).log
    assert (len(log), list(log.stretches()), log.raws["Throttle"].shape) == (0, [], (0,))
