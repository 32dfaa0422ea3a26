import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.compare import compare, difference, worst
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable

SPEED = ResultVariable("vehicle.speed", "m/s")
STATE = ResultVariable("ecu.state", type="Enumeration", variability="discrete")


def one(values, variable: ResultVariable = SPEED, step: float = 1.0, start: float = 0.0) -> Results:
    values = np.asarray(values, dtype=float)
    return Results(start + step * np.arange(len(values)), values[:, None], [variable])


numbers = arrays.arrays(np.float64, 8, elements=st.floats(-1e6, 1e6))


@given(numbers)
def test_results_equal_themselves_without_tolerance(values: np.ndarray) -> None:
    assert compare(one(values), one(values)).equal


@given(numbers, numbers, st.floats(0, 1e6))
def test_the_tolerance_is_where_equal_begins(x: np.ndarray, y: np.ndarray, tolerance: float) -> None:
    row = compare(one(x), one(y)).rows[0]
    assert row.difference == np.max(np.abs(x - y))
    assert row.difference == compare(one(y), one(x)).rows[0].difference
    assert row.rms <= row.difference * (1 + 1e-12)
    assert abs(x - y)[int(row.time)] == row.difference
    assert compare(one(x), one(y), tolerance).equal == (row.difference <= tolerance)
    assert compare(one(x), one(y), row.difference).equal


def test_the_relative_tolerance_is_a_share_of_the_range_of_the_first() -> None:
    a, b = one([0.0, 100.0]), one([1.0, 100.0])
    assert compare(a, b, relative=0.01).equal
    assert not compare(a, b, relative=0.0099).equal
    assert compare(a, b, tolerance=0.5, relative=0.005).equal
    assert compare(a, b).rows[0].relative == 0.01


@pytest.mark.parametrize("pair", [(math.nan, 1.0), (1.0, math.nan), (math.nan, math.nan), (math.inf, 1.0)])
def test_what_is_no_number_is_a_difference_at_its_time(pair: tuple[float, float]) -> None:
    found = compare(one([1.0, pair[0]]), one([1.0, pair[1]]), tolerance=math.inf, relative=1.0)
    assert not found.equal
    assert found.rows[0].difference == math.inf
    assert found.rows[0].time == 1.0


def test_units_of_measure_are_converted() -> None:
    other = ResultVariable("vehicle.speed", "km/h")
    assert compare(one([1.0, 5.0]), one([3.6, 18.0], other), tolerance=1e-12).equal
    unknown = compare(one([1.0]), one([1.0], ResultVariable("vehicle.speed")))
    assert unknown.equal and unknown.rows[0].remark == "[m/s] on one side only: compared as numbers"
    force = compare(one([1.0]), one([1.0], ResultVariable("vehicle.speed", "N")), tolerance=9.0)
    assert not force.equal
    assert force.rows[0].remark == "[N] and [m/s] measure different quantities"
    assert worst(force.rows, 6) == []


@given(st.floats(-10, 10), st.floats(-10, 10))
def test_a_line_on_another_grid_is_the_same_line(slope: float, start: float) -> None:
    def line(step: float, n: int) -> Results:
        return one(start + slope * step * np.arange(n), step=step)

    found = compare(line(1.0, 5), line(0.25, 17), tolerance=1e-12)
    assert found.equal and (found.points, found.only_times_a, found.only_times_b) == (17, 0, 12)
    assert "interpolated" in found.remarks[0]
    assert compare(line(0.25, 17), line(1.0, 5), tolerance=1e-12).equal


def test_a_held_value_on_another_grid_is_the_previous_one() -> None:
    fine = one([0, 0, 1, 1, 2], STATE, step=0.5)
    coarse = one([0, 1, 2], STATE)
    for found in (compare(fine, coarse, tolerance=1e-9), compare(coarse, fine, relative=1e-9)):
        assert found.equal and found.rows[0].difference == 0.0


@given(st.integers(2, 6), st.integers(0, 5), st.booleans())
def test_without_a_tolerance_other_times_are_a_difference(rows: int, left_out: int, held: bool) -> None:
    constant = one([1.0] * rows, STATE if held else SPEED)
    keep = np.arange(rows) != left_out
    other = constant.part(keep, constant.names)
    for pair in ((constant, other), (other, constant)):
        found = compare(*pair)
        assert found.equal == bool(keep.all())
        assert compare(*pair, tolerance=1e-300).equal == bool(keep.all() or 0 < left_out < rows - 1)
        said = "without a tolerance, times of one run alone are a difference" in found.summary()
        assert said == (found.same_span and not keep.all())


def test_times_that_another_tool_accumulated_are_the_same_times() -> None:
    time = np.cumsum(np.full(100, 0.01))
    values = np.random.default_rng(1).normal(size=(100, 1))
    accumulated = Results(time + 1e-10, values, [SPEED])
    found = compare(Results(np.arange(1, 101) * 0.01, values, [SPEED]), accumulated)
    assert found.equal and not found.remarks


def test_a_run_that_ends_early_is_not_equal() -> None:
    found = compare(one([1.0, 2.0, 3.0]), one([1.0, 2.0]))
    assert all(row.equal for row in found.rows)
    assert not found.same_span and not found.equal
    assert "the first goes from 0 to 2 s, the second from 0 to 1 s" in found.summary()
    assert "not compared: 1 point of the first at 2 s" in found.summary()


def test_nothing_in_common_is_not_equal() -> None:
    apart = compare(one([1.0]), one([1.0], start=5.0))
    assert not apart.equal and apart.points == 0
    assert apart.rows[0].remark == "no common time"
    empty = compare(one([]), one([]))
    assert not empty.equal
    other = compare(one([1.0]), one([1.0], STATE))
    assert not other.equal
    assert (other.only_a, other.only_b) == (("vehicle.speed",), ("ecu.state",))
    assert "only in the second: ecu.state" in other.summary()


def test_a_variable_of_one_side_alone_is_a_difference_unless_only_common_ones_are_wanted() -> None:
    both = Results([0.0], [[1.0, 2.0]], [SPEED, STATE])
    for a, b, only in ((both, one([1.0]), ("only_a", "first")), (one([1.0]), both, ("only_b", "second"))):
        found, common = compare(a, b, tolerance=9.0), compare(a, b, common=True)
        assert (found.equal, common.equal) == (False, True)
        assert getattr(found, only[0]) == getattr(common, only[0]) == ("ecu.state",)
        line = f"only in the {only[1]}: ecu.state"
        assert f"{line} (a difference, unless --common leaves it out)" in found.summary().splitlines()
        assert line in common.summary().splitlines()
    assert not compare(both, states("a"), common=False).equal
    assert compare(states("a"), Results([0.0], [[0.0]], [SPEED]), common=True).equal
    assert not compare(states("a"), Results([0.0], [[0.0]], [SPEED])).equal
    assert not compare(one([1.0]), one([1.0], STATE), common=True).equal


def test_a_time_that_one_run_has_more_often_is_a_difference_without_a_tolerance() -> None:
    twice = Results([0.0, 1.0, 1.0, 2.0], [[1.0]] * 4, [SPEED])
    for pair in ((one([1.0] * 3), twice), (twice, one([1.0] * 3))):
        found = compare(*pair)
        assert (found.equal, found.same_rows) == (False, False)
        assert "of a time that one has more often, the last row of the other is taken" in found.summary()
        assert compare(*pair, tolerance=1e-12).equal
    assert compare(twice, twice).equal


KINDS = [
    (dataclasses.replace(SPEED, unit=""), "[m/s] on one side only: compared as numbers"),
    (dataclasses.replace(SPEED, type="Integer"), "Real in the first, Integer in the second"),
    (dataclasses.replace(SPEED, type="Boolean"), "Real in the first, Boolean in the second"),
]


@pytest.mark.parametrize(("other", "said"), KINDS)
def test_runs_of_other_kinds_are_equal_within_a_tolerance_alone(other: ResultVariable, said: str) -> None:
    def run(variable: ResultVariable) -> Results:
        return Results([0.0], [[1.0]], [variable], {"system": "x"})

    found = compare(run(SPEED), run(other))
    assert (found.equal, found.rows[0].remark) == (False, said)
    assert compare(run(SPEED), run(other), tolerance=1e-9).equal
    assert compare(run(SPEED), one([1.0], other)).equal, "a table alone declares nothing"
    assert compare(run(other), run(other)).equal


def test_other_states_of_an_enumeration_are_a_difference() -> None:
    on = dataclasses.replace(STATE, items=((0, "off"), (1, "on")))
    for items, said in (
        (((0, "off"), (1, "fault")), "1 is 'on' in the first, 'fault' in the second"),
        (((0, "off"),), "1 is 'on' in the first, no state in the second"),
        (((0, "off"), (1, "on"), (2, "x")), "2 is no state in the first, 'x' in the second"),
    ):
        other = dataclasses.replace(STATE, items=items)
        found = compare(one([0.0, 1.0], on), one([0.0, 1.0], other), tolerance=9.0)
        assert (found.equal, found.rows[0].remark) == (False, said)
    assert compare(one([0.0, 1.0], on), one([0.0, 1.0], STATE)).equal, "one side declares no states"


def test_the_table_tells_what_differs() -> None:
    a = Results([0.0, 0.5], [[0.0, 1.0], [10.0, 2.0]], [SPEED, STATE])
    b = Results([0.0, 0.5], [[0.0, 1.0], [10.5, 2.0]], [SPEED, STATE])
    header, rows = compare(a, b).table()
    assert all(len(row) == len(header) for row in rows)
    assert rows[0] == ("vehicle.speed", "m/s", "0.5", "0.5", "0.3536", "5 %", "differs")
    assert rows[1][-1] == ""
    assert compare(a, b).table(all_rows=False)[1] == rows[:1]
    assert compare(a, b).summary() == "different: 1 of 2 common variables at 2 times, tolerance 0"
    assert (
        compare(a, b, 1.0, 0.01)
        .summary()
        .startswith("equal: 2 common variables at 2 times, tolerance 1 + 1 %")
    )
    assert worst(compare(a, b).rows, 6) == ["vehicle.speed"]
    assert worst(compare(a, a).rows, 6) == ["vehicle.speed", "ecu.state"]


whole_numbers = arrays.arrays(np.float64, 8, elements=st.integers(-(10**6), 10**6).map(float))


@pytest.mark.filterwarnings("error")
@given(whole_numbers, whole_numbers)
def test_numbers_at_the_end_of_the_doubles_are_compared_as_others_are(x: np.ndarray, y: np.ndarray) -> None:
    huge = 2.0**1003  # a range may be beyond the doubles then
    small, large = (compare(one(f * x), one(f * y)).rows[0] for f in (1.0, huge))
    assert compare(one(huge * x), one(huge * x)).equal
    assert large.equal == small.equal and large.rms == pytest.approx(huge * small.rms)
    for relative in (0.1, 0.5, 0.9):
        equal = [compare(one(f * x), one(f * y), relative=relative).equal for f in (1.0, huge)]
        assert equal[0] == equal[1]


@pytest.mark.parametrize("tolerance", [-1.0, math.nan])
def test_a_tolerance_is_a_number_from_0(tolerance: float) -> None:
    with pytest.raises(
        ConfigError, match=f"^tolerance = {tolerance}: a tolerance is .* must not be negative"
    ):
        compare(one([1.0]), one([1.0]), tolerance)
    with pytest.raises(ConfigError, match=f"^relative = {tolerance}: a tolerance is"):
        compare(one([1.0]), one([1.0]), 0.0, tolerance)


def test_a_difference_is_signed_and_in_the_unit_of_the_first() -> None:
    a, b = one([1.0, 2.0, 4.0]), one([3.6, 10.8, 14.4], dataclasses.replace(SPEED, unit="km/h"))
    assert a.variables[0].unit == "m/s"
    times, values = difference(a, b, SPEED.name)
    assert list(times) == list(a.time)
    assert values == pytest.approx([0.0, 1.0, 0.0])
    assert difference(a, a, SPEED.name)[1] == pytest.approx(np.zeros(3), abs=0.0)
    largest = compare(a, b).rows[0].difference
    assert largest == pytest.approx(np.max(np.abs(values)))


def test_a_difference_of_temperatures_has_no_zero_to_convert() -> None:
    kelvin = ResultVariable("cell.warming", "K", difference=True)
    for said in (True, False):  # a bare table does not say it
        celsius = ResultVariable("cell.warming", "degC", difference=said)
        assert compare(one([5.0], kelvin), one([5.0], celsius)).equal
    absolute = [ResultVariable("cell.temperature", unit) for unit in ("K", "degC")]
    assert compare(one([278.15], absolute[0]), one([5.0], absolute[1])).equal


def states(*texts: str, step: float = 1.0) -> Results:
    """Results of a speed, and of a text in each row."""
    table = TextTable([ResultVariable("ecu.mode", type="String")], [(k, (x,)) for k, x in enumerate(texts)])
    times = step * np.arange(len(texts))
    return Results(times, np.zeros((len(texts), 1)), [SPEED], texts=table)


@given(
    st.lists(st.text(max_size=2), min_size=3, max_size=3),
    st.lists(st.text(max_size=2), min_size=3, max_size=3),
)
def test_texts_are_equal_where_all_are(x: list[str], y: list[str]) -> None:
    found = compare(states(*x), states(*y), tolerance=1e9)
    assert found.equal == (x == y)
    assert [row.name for row in found.rows] == ["vehicle.speed", "ecu.mode"]
    assert worst(found.rows, 5) == ["vehicle.speed"]


def test_texts_that_differ_are_said() -> None:
    found = compare(states("off", "on", "on"), states("off", "on", "fault"))
    assert not found.equal
    (_, (cells,)) = found.table(all_rows=False)
    assert cells == ("ecu.mode", "", "-", "2", "-", "-", "'on' and 'fault'; they differ at 1 of 3 times")
    fine = states("off", "off", "on", "on", "on", step=0.5)
    assert compare(states("off", "on", "on"), fine, tolerance=1e-9).equal


def test_a_text_on_one_side_is_named() -> None:
    text, number = states("a", "b"), one([1.0, 2.0], ResultVariable("ecu.mode"))
    both = compare(text, number)
    assert [(row.name, row.equal, row.remark) for row in both.rows] == [
        ("ecu.mode", False, "a text on one side, numbers on the other")
    ]
    assert (both.only_a, both.only_b) == (("vehicle.speed",), ())
    assert compare(text, one([1.0, 2.0])).only_a == ("ecu.mode",)
    assert compare(one([1.0, 2.0]), text).only_b == ("ecu.mode",)


runs = st.tuples(
    st.lists(st.integers(0, 12), min_size=1, max_size=8).map(sorted),
    st.lists(st.integers(-3, 3), min_size=8, max_size=8),
).map(lambda run: Results(0.25 * np.array(run[0]), np.array(run[1][: len(run[0])], float)[:, None], [SPEED]))


@given(runs, runs, st.booleans())
def test_the_first_compared_with_the_second_is_the_second_compared_with_the_first(
    a: Results, b: Results, held: bool
) -> None:
    if held:
        variable = dataclasses.replace(SPEED, variability="discrete")
        a, b = (Results(each.time, each.data, [variable]) for each in (a, b))
    one_way, other = compare(a, b), compare(b, a)
    assert (one_way.equal, one_way.points, one_way.same_span) == (other.equal, other.points, other.same_span)
    assert (one_way.only_times_a, one_way.only_times_b) == (other.only_times_b, other.only_times_a)
    assert {(x.points, x.begin, x.end) for x in one_way.not_compared} == {
        (x.points, x.begin, x.end) for x in other.not_compared
    }
    ours, theirs = dataclasses.astuple(one_way.rows[0]), dataclasses.astuple(other.rows[0])
    assert ours[2:5] == pytest.approx(theirs[2:5], nan_ok=True)
    assert difference(a, b, SPEED.name)[1] == pytest.approx(-difference(b, a, SPEED.name)[1])


def test_a_difference_between_the_points_of_the_first_is_one() -> None:
    coarse, fine = one([0.0, 1.0, 2.0]), one([0.0, 0.5, 1.0, 9.0, 2.0], step=0.5)
    for found in (compare(coarse, fine), compare(fine, coarse)):
        assert not found.equal
        assert (found.rows[0].difference, found.rows[0].time, found.points) == (7.5, 1.5, 5)
    mode = states("off", "on", "on")
    blip = states("off", "off", "on", "off", "on", step=0.5)
    assert [compare(*pair).rows[1].time for pair in ((mode, blip), (blip, mode))] == [1.5, 1.5]


def test_an_infinite_share_of_the_range_is_refused() -> None:
    with pytest.raises(ConfigError, match="a relative tolerance must be finite, not inf"):
        compare(one([1.0]), one([1.0]), relative=math.inf)
