"""Times as counts of communication steps."""

from __future__ import annotations

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
    rule = f"^here = .* s is not a multiple of the communication step {step_size} s$"
    with pytest.raises(ConfigError, match=rule):
        steps_in((count + share) * step_size, step_size, "here")
