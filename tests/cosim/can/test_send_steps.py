"""When a message is sent: its cycle time and start delay in communication steps."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Message
from evcosim.cosim.can.send_steps import send_steps
from evcosim.cosim.errors import ConfigError


def message(cycle_ms: int | None, delay_ms: int = 0) -> Message:
    cycle = None if cycle_ms is None else cycle_ms / 1000
    return Message("ev.dbc", "M", 1, cycle_time=cycle, start_delay=delay_ms / 1000)


@pytest.mark.parametrize("cycle", [1, 3, 7, 10, 20, 30, 70, 100, 1000])
@pytest.mark.parametrize("step", [0.001, 1e-3, 0.0005, 0.0001])
def test_is_exact(cycle: int, step: float) -> None:
    assert send_steps(message(cycle), step) == (round(cycle / 1000 / step), 0)


def test_ten_milliseconds_are_one_step_of_a_hundredth() -> None:
    assert send_steps(message(10), 0.01) == (1, 0)
    assert send_steps(message(30), 0.01) == (3, 0)  # in doubles 0.03 / 0.01 is 3.0000000000000004


def test_a_step_that_is_no_decimal() -> None:
    assert send_steps(message(50, 100), 1 / 60) == (3, 6)


@pytest.mark.parametrize(("delay", "first"), [(0, 0), (1, 1), (9, 1), (10, 1), (11, 2), (70, 7)])
def test_the_first_is_at_or_after_the_start_delay(delay: int, first: int) -> None:
    assert send_steps(message(20, delay), 0.01) == (2, first)


def test_no_multiple() -> None:
    with pytest.raises(
        ConfigError, match=r"^s\.toml: ev\.dbc: message 'M': its cycle time 0\.015 s is no multiple"
    ):
        send_steps(message(15), 0.01, "s.toml")
    with pytest.raises(ConfigError, match=r"step 0\.02 s; the nearest multiple is 0\.02 s \(`cycle_time` in"):
        send_steps(message(10), 0.02)
    with pytest.raises(ConfigError, match=r"the nearest are 0\.01 s and 0\.02 s"):
        send_steps(message(17), 0.01)


def test_no_cycle_time() -> None:
    said = r"'M' has no cycle time.* in \[buses\.can0\.messages\.M\], or in \[buses\.can0\] for all"
    with pytest.raises(ConfigError, match=said):
        send_steps(message(None), 0.01, bus="can0")


@pytest.mark.parametrize("step", [0.0, -0.01])
def test_a_step_that_is_none(step: float) -> None:
    with pytest.raises(ConfigError, match="must be positive"):
        send_steps(message(10), step)


@given(st.integers(1, 1000), st.integers(1, 100), st.integers(0, 5000))
def test_steps_times_the_step_size_are_the_times_that_were_written(step: int, times: int, delay: int) -> None:
    """In whole 0.1 ms, of which no double is exact."""
    written = Message("ev.dbc", "M", 1, cycle_time=step * times / 1e4, start_delay=delay / 1e4)
    every, first = send_steps(written, step / 1e4)
    assert every == times
    assert first * step >= delay > (first - 1) * step
    assert Fraction(str(written.cycle_time)) == every * Fraction(str(step / 1e4))
