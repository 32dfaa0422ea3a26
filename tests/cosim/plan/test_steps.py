"""Times as counts of communication steps."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.steps import check_kept, check_steps, steps_in, whole_steps


@given(st.integers(0, 10**6), st.sampled_from([0.001, 0.01, 0.02, 0.1, 1 / 3, 1.0]))
def test_a_multiple_is_counted_whatever_its_last_bits(count: int, step_size: float) -> None:
    assert steps_in(count * step_size, step_size, "here") == count
    assert steps_in(float(f"{count * step_size:.12g}"), step_size, "here") == count


@given(st.integers(0, 1000), st.floats(0.002, 0.998), st.sampled_from([0.001, 0.01, 0.1]))
def test_a_time_between_two_points_is_refused(count: int, share: float, step_size: float) -> None:
    rule = f"step {step_size} s; the nearest are .* s and .* s$"
    with pytest.raises(ConfigError, match=rule):
        steps_in((count + share) * step_size, step_size, "here")


@pytest.mark.parametrize(
    ("time", "start", "nearest"),
    [
        (1.005, 0.0, "the nearest are 1.0 s and 1.01 s"),
        (0.33000001, 0.0, "the nearest are 0.33 s and 0.34 s"),
        (1.704, 0.7, "after start_time 0.7 s; the nearest are 1.7 s and 1.71 s"),
        (-0.004, 0.0, "the nearest multiple is 0.0 s"),
        (-7.0, 0.0, "the nearest multiple is 0.0 s"),
    ],
)
def test_the_nearest_multiples_are_named(time: float, start: float, nearest: str) -> None:
    with pytest.raises(ConfigError, match=f"{re.escape(nearest)}$"):
        steps_in(time, 0.01, "here", start)


def test_no_more_steps_than_there_may_be_are_named() -> None:
    assert steps_in(0.03, 0.01, "here", most=3) == 3
    with pytest.raises(ConfigError, match=r"the nearest multiple is 0\.03 s$"):
        steps_in(0.038, 0.01, "here", most=3)


def test_a_stop_time_or_a_period_is_a_step_at_least() -> None:
    for time in (0.0, 0.004, -3.0):
        with pytest.raises(ConfigError, match=r"the nearest multiple is 0\.01 s$"):
            steps_in(time, 0.01, "here", least=1)


@given(st.integers(0, 2**31), st.integers(0, 2**31), st.integers(0, 10**4))
def test_steps_of_a_loop_count_as_those_of_a_stop_time(done: int, steps: int, columns: int) -> None:
    clock = Clock.counted(0.0, 0.01, 100)
    clock = dataclasses.replace(clock, told=False)

    def said(what: Callable[[], None]) -> str:
        try:
            what()
        except ConfigError as error:
            return str(error).partition(": ")[2]
        return ""

    whole = said(lambda: check_kept(done + steps, 0.01, columns, "stop_time"))
    assert said(lambda: check_steps(steps, done, 0, clock, columns)) == whole
    assert bool(whole) == ((done + steps) * (columns + 1) > 2**31)


@pytest.mark.parametrize("steps", [10**9, np.int64(10**18), 2**63, 10**400, 10**5000], ids=range(5))
def test_so_many_steps_are_refused_however_they_are_asked_for(steps: int) -> None:
    clock = dataclasses.replace(Clock.counted(0.0, 0.01, 100), told=False)
    with pytest.raises(
        ConfigError, match=r"^steps = .*: .* steps of 0\.01 s with 28 recorded variables are more"
    ):
        check_steps(whole_steps(steps), 0, 100, clock, 28)


def test_a_run_of_long_steps_has_a_last_time() -> None:
    clock = dataclasses.replace(Clock.counted(0.0, 1e9, 10), told=False)
    check_steps(1000, 0, 0, clock, 1)
    for steps, done in ((1001, 0), (1, 1000)):
        with pytest.raises(ConfigError, match=r"steps = \d+: a run goes up to 1e\+12 s$"):
            check_steps(steps, done, 0, clock, 1)


def test_a_run_with_frames_has_a_last_time_of_its_own() -> None:
    clock = dataclasses.replace(Clock.counted(-1e7, 3600.0, 10), told=False)
    check_steps(1111, 0, 0, clock, 1, "can0")
    check_steps(1112, 0, 0, clock, 1)
    for steps, done in ((1112, 0), (1, 1111)):
        with pytest.raises(
            ConfigError, match=r"^steps = \d+: bus can0 has frames .* for 4e\+06 s after the st"
        ):
            check_steps(steps, done, 0, clock, 1, "can0")


def test_a_told_stop_time_bounds_the_steps() -> None:
    clock = Clock.counted(0.0, 0.01, 100)
    check_steps(40, 60, 40, clock, 28)
    with pytest.raises(ConfigError, match=r"^steps = 41: 40 are left to the stop time 1\.0 s"):
        check_steps(41, 60, 40, clock, 28)


@pytest.mark.parametrize(
    "steps", [-1, True, 1.0, 1e3, float("nan"), "3", None, [1], np.float64(2), 10**3 + 0j]
)
def test_what_is_no_number_of_steps(steps: object) -> None:
    with pytest.raises(ConfigError, match=r"^steps = .*: a run does 0 steps or more, a whole number$"):
        whole_steps(steps)
