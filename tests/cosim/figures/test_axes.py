"""The axes of panels over time."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.figures.axes import TimeAxis, fit_value_axis, label_value_axis
from evcosim.cosim.figures.canvas import grid
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.results.results import Results, ResultVariable


@pytest.mark.parametrize("value", [0.0, 5.0, -3e6, 1e-9])
def test_a_constant_is_seen_in_the_middle(value: float) -> None:
    data = value * (1.0 + 1e-15 * np.sin(np.arange(50.0)))[:, None]
    axes = draw(Results(np.arange(50), data, [ResultVariable("a.x", "V")])).axes[0]
    low, high = axes.get_ylim()
    assert (low + high) / 2 == pytest.approx(value, abs=1e-9 * (high - low))
    assert high - low > 0.1 * abs(value)


def run(stop: float, start: float = 0.0) -> Results:
    return Results([start, stop], [[0.0], [1.0]], [ResultVariable("a.x")])


@pytest.mark.parametrize(("stop", "unit", "scale"), [(600.0, "s", 1.0), (600.1, "min", 1.0 / 60.0)])
def test_a_run_of_more_than_ten_minutes_is_drawn_over_minutes(stop: float, unit: str, scale: float) -> None:
    assert TimeAxis.of(run(stop)) == TimeAxis(scale, unit, 0.0, scale * stop)


def test_two_runs_have_room_on_one_axis() -> None:
    assert TimeAxis.of(run(5.0, 1.0), run(7.0, 3.0)) == TimeAxis(1.0, "s", 1.0, 7.0)
    assert TimeAxis.of(Results([], np.empty((0, 0)), [])) == TimeAxis(1.0, "s", 0.0, 0.0)


def test_the_time_is_named_below_the_last_panel() -> None:
    _, axes = grid(2, 1, 4.0, "", share_x=True)
    TimeAxis.of(run(3.0)).finish(list(axes[:, 0]))
    assert [one.get_xlabel() for one in axes[:, 0]] == ["", "time [s]"]
    assert axes[0, 0].get_xlim() == (0.0, 3.0)


@pytest.mark.parametrize(
    ("label", "unit", "shown"),
    [
        ("speed", "m/s2", "speed [m/s²]"),
        ("speed", "", "speed"),
        ("", "V", "[V]"),
        ("angular speed of", "rad/s", "angular speed of\n[rad/s]"),
        ("controller.rear_steering_angle", "", "controller.\nrear_steering_angle"),
    ],
)
def test_a_quantity_is_named_with_its_unit(label: str, unit: str, shown: str) -> None:
    _, axes = grid(1, 1, 2.0, "", share_x=False)
    label_value_axis(axes[0, 0], label, unit)
    assert axes[0, 0].get_ylabel() == shown


@given(st.lists(st.floats(-1e6, 1e6) | st.just(math.nan), min_size=1, max_size=20))
@settings(max_examples=30)
def test_all_that_is_finite_lies_within_the_limits(values: list[float]) -> None:
    _, axes = grid(1, 1, 2.0, "", share_x=False)
    axes[0, 0].plot(values)
    fit_value_axis(axes[0, 0])
    low, high = axes[0, 0].get_ylim()
    assert all(low < value < high for value in values if math.isfinite(value))
