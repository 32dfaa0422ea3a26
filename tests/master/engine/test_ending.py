"""The end of a run at the request of a unit: at the end of its turn, or within it."""

from __future__ import annotations

import math
import sys

import pytest

from evcosim.master.engine.ending import EndedWithin, Ending

TURN, SPAN = (4, 6), (0.4, 0.6)


@pytest.mark.parametrize("asked", [0.6, 0.6 - 1e-9, 0.6 + 1e-9, 0.9, math.inf])
def test_a_request_at_the_end_of_a_turn(asked: float) -> None:
    ending = Ending()
    assert (ending.step, ending.text) == (sys.maxsize, "")
    ending.request("a", asked, TURN, SPAN)
    assert (ending.step, ending.text) == (6, "unit 'a' asked to end the simulation at t = 0.6 s")


@pytest.mark.parametrize(
    ("asked", "time"),
    [(0.5, 0.5), (0.4, 0.4), (0.5999, 0.5999), (0.0, 0.4), (math.nan, 0.4), (-math.inf, 0.4)],
)
def test_a_request_within_a_turn(asked: float, time: float) -> None:
    ending = Ending()
    with pytest.raises(EndedWithin):
        ending.request("a", asked, TURN, SPAN)
    assert (ending.step, ending.time) == (4, time)


def test_the_first_request_ends_the_run() -> None:
    ending = Ending()
    ending.request("slow", 0.6, TURN, SPAN)
    ending.request("fast", 0.5, (4, 5), (0.4, 0.5))
    ending.request("late", 0.6, (5, 6), (0.5, 0.6))
    assert (ending.step, ending.unit) == (5, "fast")
    with pytest.raises(EndedWithin):
        ending.request("at once", 0.41, TURN, SPAN)
    assert (ending.step, ending.unit) == (4, "at once")
