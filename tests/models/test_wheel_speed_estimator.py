"""WheelSpeedEstimator: (16)."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.wheel_speed_estimator import WheelSpeedEstimator

P = WheelSpeedEstimator.Parameters()
speeds = st.floats(0.0, 200.0)


def estimate(front: float, rear: float) -> float:
    x = WheelSpeedEstimator.initial(P, WheelSpeedEstimator.Inputs())
    x = WheelSpeedEstimator.step(P, x, WheelSpeedEstimator.Inputs(front, rear), 0.01)
    return WheelSpeedEstimator.outputs(P, x).speed


@given(speeds, speeds)
def test_the_fastest_wheel_tells_the_speed(front: float, rear: float) -> None:
    assert estimate(front, rear) == estimate(rear, front) == 0.25 * max(front, rear)


def test_locked_wheels_and_wheels_that_turn_backward_are_no_speed() -> None:
    assert estimate(0.0, 0.0) == 0.0
    assert estimate(-1.0, -2.0) == 0.0
