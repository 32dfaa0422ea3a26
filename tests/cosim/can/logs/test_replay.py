"""The frames of a log in the steps of a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.logs.recording import PAYLOAD, Recording, Span
from evcosim.cosim.can.logs.replay import Replayed
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.clock import Clock
from evcosim.cosim.row_store import MemoryTable

Times = st.lists(st.integers(-(10**9), 20 * 10**9), min_size=1, max_size=30)


def replayed(
    times: list[int], clock: Clock, offset: int = 0, delay: float = 0.0, resolution: int = 1
) -> Replayed:
    rows = np.zeros((len(times), PAYLOAD + 1), dtype=np.int64)
    rows[:, 0] = times
    rows[:, 3] = np.arange(len(times))
    table = MemoryTable(rows.view(np.float64))
    spans = {"a": Span(min(times), max(times), resolution)}
    recording = Recording(Path("x"), table, ("a",), {}, {}, spans, 0, ())
    return Replayed(recording, "a", offset, clock, delay, np.array([7]))


def seen(frames: Replayed) -> list[int]:
    """Return the step at which each frame is seen."""
    return [step for _, steps in frames.steps() for step in steps.tolist()]


@given(Times, st.sampled_from([0.01, 0.001, 1 / 60, 1 / 3, 0.25]), st.sampled_from([0.0, 2.5, -1.0]))
def test_a_frame_is_seen_at_the_first_point_at_or_after_its_time(
    times: list[int], step: float, start: float
) -> None:
    clock = Clock.counted(start, step, 100_000)
    steps = seen(replayed(times, clock))
    for time, k in zip(times, steps, strict=True):
        slack = 0.6e-9  # half of the last digit of the log, and the rounding of doubles
        assert clock.at(k) >= time * 1e-9 - slack or k < 0
        assert clock.at(k - 1) < time * 1e-9 + slack or k < 0
        assert (k < 0) == (time < start * 1e9 - 0.5)


@given(
    st.integers(0, 10**6),
    st.sampled_from([0.01, 0.001, 1 / 60, 1 / 3]),
    st.sampled_from([1, 1000, 10_000, 100_000]),
)
def test_a_communication_point_that_a_log_rounds_is_that_point(k: int, step: float, resolution: int) -> None:
    clock = Clock.counted(0.0, step, 2 * 10**6)
    time = round(clock.at(k) * 1e9 / resolution) * resolution
    assert seen(replayed([time], clock, resolution=resolution)) == [k]


def test_times_that_are_rounded_to_more_than_a_step_are_seen_at_the_nearest_point() -> None:
    clock = Clock.counted(0.0, 0.01, 1000)
    times = [500_000_000, 504_000_000, 506_000_000]
    assert seen(replayed(times, clock, resolution=10**8)) == [50, 50, 51]


def test_offset_and_delay_move_frames_and_times_that_no_run_reaches_stay_behind_all() -> None:
    clock = Clock.counted(0.0, 0.01, 100)
    assert seen(replayed([5 * 10**9], clock, offset=5 * 10**9 - 1)) == [1]
    assert seen(replayed([0], clock, delay=0.02)) == [2]
    assert seen(replayed([2**62], clock))[0] > 10**8 and seen(replayed([-(2**62)], clock))[0] < 0


@given(st.sampled_from([-1e12, -1e7, 1e7, 1e9]), st.integers(0, 10**6))
def test_a_run_that_starts_long_before_or_after_0_s_has_its_frames(start: float, k: int) -> None:
    clock = Clock.counted(start, 0.25, 10**6)
    time = round(clock.at(k) * 10**9)
    inside = abs(time) < 2**62  # a log has no later times
    steps = seen(replayed([min(max(time, -(2**62)), 2**62)], clock))
    assert steps[0] == k if inside else not 0 <= steps[0] < 10**6


def test_blocks_have_the_frames_from_the_start_on() -> None:
    clock = Clock.counted(0.0, 0.01, 100)
    stream = replayed([-(10**9)] * 3000 + [k * 10**7 for k in range(3000)], clock)
    rows, at, found = np.empty((0, T.LOG_WIDTH), dtype=np.int64), 0, []
    while at >= 0:
        rows, at = stream.block(at)
        assert len(rows) or at < 0
        found += rows.tolist()
    assert [row[T.LOG_STEP] for row in found] == list(range(3000))
    assert found[5][: T.LOG_PAYLOAD] == [5, 5 * 10**10, 7] and found[5][T.LOG_PAYLOAD] == 3005
