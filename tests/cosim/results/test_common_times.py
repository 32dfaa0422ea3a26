"""The times at which two runs are compared are those of both; what one of them alone covers is counted."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.results.common_times import CommonTimes, NotCompared

times = st.lists(st.integers(0, 20), min_size=1, max_size=12).map(lambda x: np.array(sorted(x)) / 8.0)


def of(first: list[float], second: list[float]) -> CommonTimes:
    return CommonTimes.of(np.array(first), np.array(second))


@given(times, times)
def test_every_row_is_compared_or_counted(first: np.ndarray, second: np.ndarray) -> None:
    found = CommonTimes.of(first, second)
    for side, rows, own in (("first", found.first, first), ("second", found.second, second)):
        compared = rows.rows[rows.own]
        left = sum(each.points for each in found.not_compared if each.side == side)
        assert len(set(compared.tolist())) + left == len(own)
        assert (own[compared] == found.time[rows.own]).all()
        assert (own[rows.rows[~rows.own]] < found.time[~rows.own]).all()
    assert found.same_span == (first[0] == second[0] and first[-1] == second[-1])
    assert (np.diff(found.time) >= 0.0).all()
    assert (found.first.own | found.second.own).all()


@given(times, st.sampled_from([0.0, 1e-10]))
def test_equal_times_are_compared_row_by_row(own: np.ndarray, off: float) -> None:
    found = CommonTimes.of(own, own + off)
    assert found.first.rows.tolist() == found.second.rows.tolist() == list(range(len(own)))
    assert (found.time == own).all() and found.same_span and found.remarks == ()


def test_what_is_before_and_after_is_said() -> None:
    found = of([0.0, 1.0, 2.0, 3.0], [1.5, 2.0, 2.5, 3.0, 3.5, 4.0])
    assert found.time.tolist() == [1.5, 2.0, 2.5, 3.0]
    assert found.not_compared == (NotCompared("first", 2, 0.0, 1.0), NotCompared("second", 2, 3.5, 4.0))
    assert found.remarks == (
        "the times differ: 0 are of the first alone and 2 of the second alone, where the other was "
        "interpolated (linear; held values: the previous one)",
        "the first goes from 0 to 3 s, the second from 1.5 to 4 s",
        "not compared: 2 points of the first from 0 to 1 s, 2 points of the second from 3.5 to 4 s",
    )


def test_times_of_one_side_that_are_dates_are_said_to_be_so() -> None:
    epoch = [1704067200.0, 1704067201.5]
    for times, side in (((of([0.0, 1.0], epoch)), "second"), (of(epoch, [0.0, 1.0]), "first")):
        said = " ".join(times.remarks)
        assert "1704067200 to 1704067201.5 s" in said and f"the times of the {side} look like seconds" in said
    assert "look like" not in " ".join(of(epoch, [1704067300.0]).remarks)


def test_runs_that_do_not_meet_and_empty_ones_have_no_time_in_common() -> None:
    apart = of([0.0, 1.0], [2.0])
    assert (len(apart.time), [str(each) for each in apart.not_compared]) == (
        0,
        ["2 points of the first from 0 to 1 s", "1 point of the second at 2 s"],
    )
    assert of([], [1.0]).remarks == ("there is nothing to compare: a run has no points",)
    assert of([], [1.0]).not_compared == (NotCompared("second", 1, 1.0, 1.0),)
    assert len(of([], []).time) == 0


def test_rows_of_one_time_are_paired_in_their_order() -> None:
    found = of([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 1.0, 1.0, 2.0])
    assert found.first.rows.tolist() == [0, 1, 2, 2, 3]
    assert found.second.rows.tolist() == [0, 1, 2, 3, 4]
    jump = of([0.0, 2.0], [0.0, 1.0, 1.0, 2.0])
    assert jump.first.values(np.array([0.0, 4.0]), False, jump.time).tolist() == [0.0, 2.0, 2.0, 4.0]
    assert jump.first.values(np.array([0.0, 4.0]), True, jump.time).tolist() == [0.0, 0.0, 0.0, 4.0]


def test_short_steps_are_told_apart() -> None:
    short = 1e-10 * np.arange(5)
    assert len(CommonTimes.of(short, short[::2]).time) == 5
