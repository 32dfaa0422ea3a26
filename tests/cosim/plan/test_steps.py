"""Times as counts of communication steps."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.steps import steps_in


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
        (-0.004, 0.0, "the nearest is 0.0 s"),
        (-7.0, 0.0, "the nearest is 0.0 s"),
    ],
)
def test_the_nearest_multiples_are_named(time: float, start: float, nearest: str) -> None:
    with pytest.raises(ConfigError, match=f"{re.escape(nearest)}$"):
        steps_in(time, 0.01, "here", start)


def test_a_stop_time_or_a_period_is_a_step_at_least() -> None:
    for time in (0.0, 0.004, -3.0):
        with pytest.raises(ConfigError, match=r"the nearest is 0\.01 s$"):
            steps_in(time, 0.01, "here", least=1)
