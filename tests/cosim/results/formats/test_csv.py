"""Results as CSV: every bit comes back, the text is what other tools expect, and a broken file is refused."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.formats import csv
from evcosim.cosim.results.results import Results, ResultVariable

SPEED = ResultVariable("vehicle.speed", "m/s")
STATE = ResultVariable("ecu.state", type="Enumeration", items=((0, "driver"), (1, "acceleration")))
COUNT = ResultVariable("ecu.count", type="Integer", variability="discrete")
FLAG = ResultVariable("ecu.on", type="Boolean", variability="discrete")

finite = st.floats(allow_nan=False, allow_infinity=False)


@given(
    data=arrays.arrays(np.float64, st.tuples(st.integers(0, 6), st.just(2)), elements=finite),
    name=st.text(st.characters(codec="utf-8"), min_size=1).map(lambda text: f"a.{text.strip()}b"),
)
def test_what_is_written_reads_back_bit_for_bit(data: np.ndarray, name: str, tmp_path_factory) -> None:
    path = tmp_path_factory.getbasetemp() / "x.csv"
    written = Results(np.arange(len(data)) * 0.01, data, [ResultVariable("a.b[1,2]"), ResultVariable(name)])
    written.to_csv(path)
    read = csv.read(path)
    assert read.time.tobytes() == written.time.tobytes()
    assert read.data.tobytes() == data.tobytes()
    assert tuple(read.variables) == written.variables


def test_the_text_of_the_file(tmp_path: Path) -> None:
    k = np.arange(4)
    data = np.column_stack([0.1 * k, k // 3, k, k % 2])
    Results(k * 0.01, data, [SPEED, STATE, COUNT, FLAG]).to_csv(tmp_path / "x.csv")
    assert (tmp_path / "x.csv").read_bytes().decode() == (
        "time,vehicle.speed,ecu.state,ecu.count,ecu.on\n"
        "0.0,0.0,0,0,0\n"
        "0.01,0.1,0,1,1\n"
        "0.02,0.2,0,2,0\n"
        "0.03,0.30000000000000004,1,3,1\n"
    )


def test_negative_zero_is_kept_among_zeros(tmp_path: Path) -> None:
    values = np.array([[0.0], [-0.0], [-0.0], [0.0]])
    Results([0, 1, 2, 3], values, [SPEED]).to_csv(tmp_path / "x.csv")
    assert np.signbit(csv.read(tmp_path / "x.csv").data[:, 0]).tolist() == [False, True, True, False]


def test_a_whole_type_whose_values_are_none_is_written_as_it_is(tmp_path: Path) -> None:
    Results([0, 1], [[1.5], [2.0]], [COUNT]).to_csv(tmp_path / "x.csv")
    assert (tmp_path / "x.csv").read_text() == "time,ecu.count\n0.0,1.5\n1.0,2.0\n"


def test_the_text_does_not_depend_on_how_many_rows_are_formatted_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    k = np.arange(50)
    results = Results(k * 0.1, np.column_stack([k // 7, k]), [STATE, SPEED])
    results.to_csv(tmp_path / "a.csv")
    monkeypatch.setattr(csv, "_ROWS", 3)
    results.to_csv(tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_a_csv_of_another_tool(tmp_path: Path) -> None:
    path = tmp_path / "other.csv"
    path.write_bytes(b'\xef\xbb\xbf"Time", "x","y[1,2]"\r\n0,1,2e0\r\n"0.1", 3 ,4\r\n0.1,5,6\r\n\r\n\r\n')
    other = csv.read(path)
    assert [v.name for v in other.variables] == ["x", "y[1,2]"]
    assert all(v == ResultVariable(v.name) for v in other.variables)
    assert other.time.tolist() == [0.0, 0.1, 0.1]
    assert other.data[:, 0].tolist() == [1.0, 3.0, 5.0]
    assert other.manifest == {}


BROKEN = {
    "time,x\n0,1\n0.1,\n": "line 3, column 'x': the value is missing",
    "time,x\n0,1\n0.1,fast\n": "line 3, column 'x': 'fast' is not a number",
    "time,x\n0,1\n0.1,nan\n": "line 3, column 'x': 'nan' is not a finite number",
    "time,x\n0,-inf\n": "line 2, column 'x': '-inf' is not a finite number",
    "time,x\n0,1\n2024-01-01 00:00:00,1\n": "line 3, column 'time': '2024-01-01 00:00:00' is not a number "
    "but a date or a time of day: times are in s, best from the start of the run on",
    "time,x\n0,1_000\n": "line 2, column 'x': '1_000' is not a finite number",
    "time,x\n0,1\n1\n": "line 3 has 1 value, the header has 2 columns",
    "time,x\n0,1,2\n1,1,2\n": "line 2 has 3 values, the header has 2 columns",
    "time,x\n0,1\n2,1\n1.5,1\n": "line 4, column 'time': 1.5 comes after 2.0; time must not decrease",
    'time,"x\ny"\n0,1\n2,1\n1.5,1\n': "line 5, column 'time': 1.5 comes after 2.0; time must not decrease",
    "time;x\n0;1\n2;no\n": "line 3, column 'x': 'no' is not a number",
    "x,y\n0,1\n": "line 1: no column has a name of the time in s",
    "time,x,x\n0,1,1\n": "line 1: columns 2 ('x') and 3 ('x') both have this name",
    "time,time\n0,1\n": "line 1: columns 1 ('time') and 2 ('time') both have this name",
    "time,Time\n0,1\n": "line 1: columns 1 ('time') and 2 ('Time') both have the name of the time",
    "time,,x\n0,1,1\n": "line 1, column 2: a name is needed",
    "time,x,\n0,1,\n1,1,no\n": "line 1, column 3: a name is needed",
    ",time,x\n0,0,1\n0,1,1\n": "line 1, column 1: a name is needed",
    ",time,x\n0.5,0,1\n2,1,1\n": "line 1, column 1: a name is needed",
    ",time,x\na,0,1\n,1,1\n": "line 1, column 1: a name is needed",
    ",time,x\na,0,1\n2,1,1\n": "line 1, column 1: a name is needed",
    "time,,x\n0,0,1\n2,1,1\n": "line 1, column 2: a name is needed",
    "timestamp,x\n1700000000000,1\n": "1700000000000 s is beyond the 1e+12 s of a run; it looks like "
    "milliseconds since 1970 (2023-11-14 22:13:20 UTC)",
    "x,t\n1,0\n\n1,1.7e15\n": "line 4, column 't': 1700000000000000 s is beyond the 1e+12 s of a run; it "
    "looks like microseconds since 1970",
    "t,x\n1.7e18,0\n": "it looks like nanoseconds since 1970",
    "t,x\n-1e13,0\n": "-10000000000000 s is beyond the 1e+12 s of a run: the time is in s",
    "0,1\n1,2\n": "a header with names is needed, not numbers: '0,1'",
    ",,\n1,2,3\n": "line 1: a header with the names of the columns is needed",
    "": "line 1: a header with the names of the columns is needed",
}


@pytest.mark.parametrize("text", BROKEN)
def test_a_broken_csv_is_refused_with_its_place(text: str, tmp_path: Path) -> None:
    path = tmp_path / "broken.csv"
    path.write_text(text)
    with pytest.raises(ConfigError) as refusal:
        csv.read(path)
    assert str(refusal.value).startswith(f"{path}: ")
    assert BROKEN[text] in str(refusal.value)


@pytest.mark.parametrize("rows", [("1", "2"), ("0", "1"), ("3", "7"), ("12", "4"), ("left", "right")])
def test_the_names_of_rows_that_r_and_pandas_write_first_are_left_out(rows, tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text(f'"","time","x"\n"{rows[0]}",0,1.5\n"{rows[1]}",1,2\n')
    results = Results.read(tmp_path / "r.csv")
    assert (results.names, results.time.tolist(), results["x"].tolist()) == (("x",), [0.0, 1.0], [1.5, 2.0])


def test_the_time_may_stand_anywhere_and_truth_is_1_or_0(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("u;Time [s];on\n5,5;0;true\n6;0,5;false\n")
    results = Results.read(tmp_path / "x.csv")
    assert results.time.tolist() == [0.0, 0.5] and results.names == ("u", "on")
    assert results.data.tolist() == [[5.5, 1.0], [6.0, 0.0]]


@pytest.mark.parametrize("value", [2.0**63, -(2.0**63), 2.0**64, 1e300])
def test_an_integer_beyond_64_bits_keeps_its_value(value: float, tmp_path: Path) -> None:
    results = Results([0.0], [[value]], [ResultVariable("a.n", type="Integer")])
    assert results["a.n"][0] == results.final()["a.n"] == value
    path = results.to_csv(tmp_path / "r.csv")
    assert path.read_text() == f"time,a.n\n0.0,{int(value)}\n"
    assert Results.read(path).column("a.n")[0] == value


@pytest.mark.parametrize(
    "text",
    ["time,x,\n0,1,\n2,3,\n", "time,x,,\n0,1\n2,3\n", "time,x\n0,1,\n\n2,3,\n", ",time,x\n0,0,1\n1,2,3\n",
     '"","time","x"\n"1",0,1\n"2",2,3\n',
     "time;;x;\r\n0;;1;\r\n\r\n;;;\r\n2;;3;\r\n", "x,,time\n1,,0\n,,\n3,,2\n"],
)  # fmt: skip # a table of files
def test_a_column_without_name_and_values_is_none(text: str, tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text(text, newline="")
    read = Results.read(tmp_path / "x.csv")
    assert (read.names, read.time.tolist(), read.data.tolist()) == (
        ("x",),
        [0.0, 2.0],
        [[1.0], [3.0]],
    )


def test_numbers_that_can_be_read_two_ways_are_a_warning(tmp_path):
    (tmp_path / "a.csv").write_text("time;x\n0;1.500\n1;2.500\n")
    (said,) = Results.read(tmp_path / "a.csv").manifest["warnings"]
    assert "line 2, column 'x': '1.500' is read as 1.5; where the point divides thousands, it is 1500" in said
    (tmp_path / "a.csv").write_text("time;x\n0;1.5\n1;2.500\n")
    assert "warnings" not in Results.read(tmp_path / "a.csv").manifest
