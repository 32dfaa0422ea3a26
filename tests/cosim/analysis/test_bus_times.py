"""Rows and busy periods of the times on a bus."""

from __future__ import annotations

from typing import Any

from evcosim.cosim.analysis.bus_times import BusTimes, Carried, longest_wait
from evcosim.cosim.plan.bus_load import BusLoad, MessageLoad

BIT = 2e-6


def message(name: str, response: float | None) -> MessageLoad:
    return MessageLoad(name, 0x10, False, 8, 0.01, 0.02, 0.03, 0.00027, response)


def counted(carried: int, *times: float) -> dict[str, Any]:
    latency = dict(zip(("min", "mean", "max"), times, strict=True)) if times else None
    return {"carried": carried, "latency": latency}


def test_rows_have_a_text_for_each_header() -> None:
    load = BusLoad("can0", 500_000, (message("A", 0.001), message("B", None)))
    messages = {"A": counted(2, 1e-4, 2e-4, 3e-4), "B": counted(0)}
    times = BusTimes(load, {"load": 0.1, "messages": messages}, ())
    first, second = times.rows()
    assert len(first) == len(times.headers())
    assert first == ("A", "0x10", "10", "8", "2.0% to 3.0%", "0.100", "0.200", "0.300", "1.000")
    assert second[-4:] == ("-", "-", "-", "none")


def test_pages_of_a_message_count_together() -> None:
    load = BusLoad("can0", 500_000, (message("A", 0.001),))
    messages = {"A Mux = 0": counted(1, 1.0, 1.0, 1.0), "A Mux = 1": counted(3, 2.0, 3.0, 5.0)}
    assert BusTimes(load, {"messages": messages}, ()).latency("A") == {"min": 1.0, "mean": 2.5, "max": 5.0}


def test_a_busy_period_ends_where_the_bus_is_idle() -> None:
    frames = []
    for begin in (0.0, 0.01, 0.02):  # the second has the longest wait
        start = begin
        for i in range(3 + (begin == 0.01)):
            frames.append(Carried(f"M{i}", begin, start, start + 100 * BIT))
            start += 103 * BIT
    assert longest_wait(frames, 500_000) == tuple(frames[3:7])
    assert longest_wait([], 500_000) == ()


def test_a_bus_that_is_never_idle_shows_forty_frames() -> None:
    frames = [Carried("M", 0.0, i * 103 * BIT, i * 103 * BIT + 100 * BIT) for i in range(200)]
    assert len(longest_wait(frames, 500_000)) <= 40
    assert longest_wait(frames, 500_000)[-1] == frames[-1]
