"""Stimuli: values at given times, and what is said of a broken table or file."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.scenario import StimulusEntry
from evcosim.cosim.system.stimuli import initial_value, stimulus
from evcosim.cosim.system.toml import validate

CLOCK = Clock.counted(0.0, 0.01, 3000)


def values(times, **entry):
    described = StimulusEntry.model_validate({"to": "u.x"} | entry)
    return stimulus(described, "here", None, VariableInfo("x"), CLOCK)(np.array(times, dtype=float))


def test_table_is_linear_between_its_points_and_constant_outside():
    table = [[1.0, 10.0], [2.0, 20.0], [2.0, 0.0], [4.0, 8.0]]
    assert values([0, 1, 1.5, 2, 3, 4, 9], table=table) == pytest.approx([10, 10, 15, 0, 4, 8, 8])


@pytest.mark.parametrize("interpolation", ["linear", "hold"])
def test_a_jump_at_the_start_comes_after_the_initialization(interpolation):
    table = [[0.0, 1.0], [0.7, 2.0], [0.7, 3.0], [0.7, 5.0], [1.0, 6.0]]
    entry = StimulusEntry.model_validate({"to": "u.x", "table": table, "interpolation": interpolation})
    signal = stimulus(entry, "here", None, VariableInfo("x"), CLOCK)
    assert [initial_value(signal, t) for t in (-1.0, 0.0, 0.7, 1.0)] == [1.0, 1.0, 2.0, 6.0]
    assert signal(np.array([0.7])) == 5.0


@given(st.floats(-10.0, 10.0))
def test_in_the_initialization_a_stimulus_without_a_jump_has_its_value(time):
    for entry in ({"constant": 3.0}, {"sine": {"amplitude": 1.0, "period": 2.0}}, {"ramp": {"slope": 2.0}}):
        described = StimulusEntry.model_validate({"to": "u.x"} | entry)
        signal = stimulus(described, "here", None, VariableInfo("x"), CLOCK)
        assert initial_value(signal, time) == signal(np.array([time]))[0]


def test_table_that_holds():
    table = [[1.0, 10.0], [2.0, 20.0]]
    assert list(values([0, 1, 1.99, 2, 5], table=table, interpolation="hold")) == [10, 10, 10, 20, 20]


def test_ramp_stops_at_its_end():
    assert values(
        [0, 1, 2, 9], ramp={"slope": -2.0, "start": 1.0, "end": -3.0, "delay": 1.0}
    ) == pytest.approx([1, 1, -1, -3])
    with pytest.raises(ConfigError, match="never reaches"):
        values([0], ramp={"slope": 1.0, "end": -1.0})


def test_constant_and_sine():
    assert list(values([0, 5], constant=3.0)) == [3.0, 3.0]
    assert values([0, 1, 2], sine={"amplitude": 2.0, "period": 4.0, "mean": 1.0}) == pytest.approx([1, 3, 1])


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=20), st.floats(-10, 30))
def test_a_table_stays_within_its_values(points, t):
    (value,) = values([t], table=[[float(i), p] for i, p in enumerate(points)])
    assert min(points) - 1e-9 <= value <= max(points) + 1e-9


@given(st.lists(st.tuples(st.floats(0, 100), st.floats(-1e3, 1e3)), min_size=1, max_size=20))
def test_linear_is_numpys_where_times_differ(points):
    points = sorted(dict(points).items())
    times, ys = np.array(points).T
    at = np.linspace(-1, 101, 57)
    assert values(at, table=points) == pytest.approx(np.interp(at, times, ys), abs=1e-6)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("t,v\n0,1\n1,\n", r"line 3, column 'v': the value is missing"),
        ("t,v\n0,1\n1,fast\n", r"line 3, column 'v': 'fast' is not a number"),
        ("t,v\n0,1\n1,nan\n", r"line 3, column 'v': 'nan' is not a finite number"),
        ("t,v\n0,1\n1\n", r"line 3 has 1 value, the header has 2"),
        ("t,v\n1,1\n0,2\n", r"line 3, column 't': time goes back from 1.0 s to 0.0 s"),
        ("# c\nt,v\n\n1,1\n#\n0,2\n", r"line 6, column 't': time goes back from 1.0 s to 0.0 s"),
        ("t,v\n", r"there is no row"),
        ("a,b\n0,1\n", r"line 1: no column has a name of the time in s .*: 'a', 'b'"),
        ("time [ms],b\n0,1\n", r"line 1: no column has a name of the time in s .*: 'time \[ms\]', 'b'"),
        ("b,t,Time [s]\n0,1,2\n", r"line 1: 2 columns could be the time: 'b', 't', 'Time \[s\]'"),
        ("t,v\n0,1\n1,true\n", r"line 3, column 'v': 'true' is not a number"),
        ("t,v\n0,1e308\n1,-1e308\n", r"line 3, column 'v': -1e\+308 is too far from 1e\+308"),
        (
            "t,v\n-1e308,1\n1e308,1\n",
            r"line 2, column 't': -1e\+308 s is beyond the 1e\+12 s of a run: the time",
        ),
        (
            "timestamp,v\n\n1700000000000,1\n",
            r"line 3, column 'timestamp': 1700000000000 s .* like milliseconds",
        ),
        (
            "time,v\n0,1\n1.7e18,1\n",
            r"line 3, column 'time': 1\.7e\+18 s is .* looks like nanoseconds since 1970",
        ),
        (",t\n0,0\n1,1\n", r"a header of two or more column names is needed, not \['t'\]"),
        ("t,v\n0,1_0\n", r"line 2, column .v.: .1_0. is not a finite number"),
        ("t,v\n0,1\n1,1,2\n", r"line 3 has 3 values, the header has 2 columns"),
        ("0,1\n1,2\n", r"line 1: a header with names is needed, not numbers: '0,1'"),
        ("t\n0\n", r"a header of two or more column names is needed, not \['t'\]"),
        ("", r"a header of two or more"),
    ],
)
def test_a_broken_csv_names_file_line_column_and_value(tmp_path, text, said):
    path = tmp_path / "cycle.csv"
    path.write_text(text)
    with pytest.raises(ConfigError, match=said) as caught:
        values([0], csv=str(path))
    assert "cycle.csv" in str(caught.value)


def test_a_csv_column_by_name(tmp_path):
    path = tmp_path / "cycle.csv"
    path.write_text("time,a,b\n0,1,5\n2,3,9\n")
    assert values([1], csv=str(path), column="b") == pytest.approx([7])
    assert values([1], csv=str(path)) == pytest.approx([2])
    with pytest.raises(ConfigError, match=r"no column 'bb' \(did you mean 'b'\?\); columns: a, b"):
        values([1], csv=str(path), column="bb")


@pytest.mark.parametrize(
    "name",
    ["time", "t", "T", "TIME", "Time [s]", "time (s)", "t/s", "time_s", "timestamps", "Zeit [s]", "Time, s"],
)
def test_the_time_is_the_column_of_such_a_name_wherever_it_stands(tmp_path, name):
    path = tmp_path / "cycle.csv"
    path.write_text(f'u,"{name}",v\n5,0,1\n7,2,9\n')
    assert values([1], csv=str(path)) == pytest.approx([6])
    assert values([1], csv=str(path), column="v") == pytest.approx([5])
    with pytest.raises(ConfigError, match="there is no column"):
        values([1], csv=str(path), column=name)


def test_of_several_names_of_the_time_the_plain_one_counts_then_the_first_column(tmp_path):
    path = tmp_path / "cycle.csv"
    path.write_text("t,u,time\n1,2,0\n3,4,2\n")
    assert values([1], csv=str(path)) == pytest.approx([2])
    path.write_text("t,u,Time [s]\n0,2,7\n2,4,9\n")
    assert values([1], csv=str(path)) == pytest.approx([3])


UNNAMED = [",time,v\n0,0,1\n1,2,3\n", "time,,v,\n0,,1,\n,,,\n\n2,5,3,\n", "x;time;v;\n;0;1\n;2;3\n"]


@pytest.mark.parametrize("text", UNNAMED)
def test_a_column_without_a_name_is_none(tmp_path, text):
    path = tmp_path / "cycle.csv"
    path.write_text(text)
    assert values([1], csv=str(path), column="v") == pytest.approx([2])
    if "x" not in text:
        assert values([1], csv=str(path)) == pytest.approx([2])


def test_times_beyond_every_run_are_refused_in_a_table_too():
    with pytest.raises(
        ConfigError,
        match=r"^here.table: row 2: 1700000000000000 s is .* microseconds since 1970 \(2023-11-14",
    ):
        values([0], table=[[0.0, 1.0], [1.7e15, 2.0]])


def test_the_time_of_another_name_is_named(tmp_path):
    path = tmp_path / "cycle.csv"
    path.write_text("u,x,t\n5,0,1\n7,2,1\n")
    assert values([1], csv=str(path), time_column="x") == pytest.approx([6])
    with pytest.raises(ConfigError, match=r"no column 'y'.*; columns: u, x, t"):
        values([1], csv=str(path), time_column="y")


def test_a_name_that_two_columns_have_is_no_choice(tmp_path):
    path = tmp_path / "cycle.csv"
    path.write_text("time,u,v,v\n0,1,2,3\n")
    assert values([0], csv=str(path), column="u") == pytest.approx([1])
    both = r"cycle.csv: line {}: columns {} \('v'\) and {} \('v'\) both have this name: which is meant\?$"
    with pytest.raises(ConfigError, match=both.format(1, 3, 4)):
        values([0], csv=str(path), column="v")
    path.write_text("# of a test\ntime,v,v\n0,1,2\n")  # the first one beside the time
    with pytest.raises(ConfigError, match=both.format(2, 2, 3)):
        values([0], csv=str(path))
    path.write_text("time,u,time\n0,1,2\n")
    with pytest.raises(
        ConfigError, match=r"line 1: columns 1 \('time'\) and 3 \('time'\) both have the name of"
    ):
        values([0], csv=str(path))
    with pytest.raises(
        ConfigError, match=r"line 1: columns 1 \('time'\) and 3 \('time'\) both have this name"
    ):
        values([0], csv=str(path), time_column="time")


def test_results_that_were_cut_off_drive_nothing(tmp_path):
    path = tmp_path / "results.csv"
    path.write_text("time,a.v\n0.0,1.25\n2.0,3.2")  # it was 3.25
    with pytest.raises(
        ConfigError, match=r"results.csv: line 3, the last, does not end: '2.0,3.2'; the file"
    ):
        values([1], csv=str(path))
    for cut in ("2;3,", '2;"3,5'):
        path.write_text(f"time;v\n0;1\n{cut}")
        with pytest.raises(ConfigError, match=r"line 3, the last, does not end: .* was cut off"):
            values([1], csv=str(path))
    path.write_text("time,v\n0,1\n2,3")  # of a spreadsheet
    assert values([1], csv=str(path)) == pytest.approx([2])


def test_two_rows_too_far_apart_for_a_line_may_be_held():
    table = [[0.0, 1e308], [1.0, -1e308]]
    with pytest.raises(ConfigError, match=r'here.table: row 2: -1e\+308 is too far .* = "hold" needs none'):
        values([0], table=table)
    assert list(values([0, 1], table=table, interpolation="hold")) == [1e308, -1e308]


def test_what_stands_beside_the_wanted_columns_counts_for_nothing(tmp_path):
    path = tmp_path / "cycle.csv"
    path.write_text('"time\n[s]",phase,"v, raw",w\n\n0,cold,1,\n\n2,"warm, dry",3,nan\n')
    assert values([1], csv=str(path), column="v, raw") == pytest.approx([2])
    with pytest.raises(ConfigError, match="line 4, column 'phase': 'cold' is not a number"):
        values([1], csv=str(path))


@pytest.mark.parametrize(
    "entry",
    [
        {},
        {"constant": 1.0, "table": [[0, 1]]},
        {"constant": 1.0, "column": "a"},
        {"constant": 1.0, "time_column": "t"},
    ],
)
def test_exactly_one_kind(entry):
    with pytest.raises(ConfigError):
        validate({"to": "u.x"} | entry, StimulusEntry, "s.toml")


def test_a_whole_number_that_no_double_holds_is_refused_and_a_decimal_one_is_not(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("time,v\n0,1\n\n1,9007199254740993\n")
    said = (
        r"= 9007199254740993 is no number that a double holds exactly: the nearest are 9007199254740992 and"
    )
    with pytest.raises(ConfigError, match=rf"x.csv: line 4, column 'v': .* {said}"):
        values([0], csv=str(path))
    for row in range(2):
        table = [[0.0, 1], [1.0, 1]]
        table[row][1] = 2**53 + 1
        with pytest.raises(ConfigError, match=rf"here.table: row {row + 1}: .* {said}"):
            values([0], table=table)
    with pytest.raises(ConfigError, match=rf"here.constant: .* {said}"):
        values([0], constant=2**53 + 1)
    path.write_text("time,v\n0,9007199254740993.0\n1,9007199254740994\n")
    assert list(values([0, 1], csv=str(path))) == [2.0**53, 2.0**53 + 2]
