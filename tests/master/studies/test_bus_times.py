"""The times of frames in a run: within the bounds, and the same whichever engine."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.studies.bus_times import bus_times


@pytest.mark.parametrize("system", ["scooter", "lane_keeping", "multi_drive"])
def test_latencies_are_within_their_bounds(system: str) -> None:
    for bus in bus_times(system, stop_time=0.5):
        assert bus.period
        for message in bus.load.messages:
            latency = bus.latency(message.name)
            assert latency is not None and message.response is not None
            assert 0.0 < latency["min"] <= latency["mean"] <= latency["max"] <= message.response


def test_frames_of_a_busy_period_follow_each_other() -> None:
    (bus,) = bus_times("scooter", stop_time=0.5)
    names = [frame.name for frame in bus.period]
    assert names == [message.name for message in bus.load.messages]  # all were sampled at once
    for before, after in zip(bus.period, bus.period[1:], strict=False):
        assert after.start - before.end == pytest.approx(3 * 2e-6, abs=1e-9)
    worst = max(frame.end - frame.sampled for frame in bus.period)
    assert worst == pytest.approx(max(bus.latency(name)["max"] for name in names), abs=1e-9)  # type: ignore[index] # each has one


def test_both_engines_find_the_same() -> None:
    found = [bus_times("lane_keeping", stop_time=0.2, engine=engine) for engine in ("python", "compiled")]
    assert [bus.as_data() for bus in found[0]] == [bus.as_data() for bus in found[1]]


def test_what_leaves_no_frames_is_refused() -> None:
    with pytest.raises(ConfigError, match="'ideal' cannot be given"):
        bus_times("scooter", ideal=True)
