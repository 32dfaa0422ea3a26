"""Stimuli of inputs that are not Real: values of the input's type that hold, wrong ones with their place."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.csv_numbers import CsvFile
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.held_stimuli import course, held_stimulus
from evcosim.cosim.system.scenario import StimulusEntry
from evcosim.cosim.system.values import as_double
from evcosim.cosim.texts import Texts
from evcosim.cosim.units.measure import Affine

CLOCK = Clock.counted(0.0, 0.01, 3000)
COUNT = VariableInfo("n", "Integer")
FLAG = VariableInfo("b", "Boolean")
STATE = VariableInfo("e", "Enumeration", items=((1, "off"), (4, "broken")))


def values(
    variable: VariableInfo, times: list[float], map_: Affine | None = None, **entry: Any
) -> list[float]:
    described = StimulusEntry.model_validate({"to": "u.x"} | entry)
    to_double = functools.partial(as_double, variable, texts=Texts())
    signal = held_stimulus(described, "here", None, variable, map_ or Affine(), CLOCK, to_double)
    return list(signal(np.array(times)))


def test_a_value_holds_until_the_time_of_the_next() -> None:
    table = [[1.0, 10], [2.0, 20], [2.0, 30]]
    assert values(COUNT, [0, 1, 1.99, 2, 5], table=table) == [10, 10, 10, 30, 30]
    assert values(COUNT, [0, 9], constant=7, interpolation="hold") == [7, 7]
    assert values(FLAG, [0, 1, 2], table=[[1, True], [2, 0]]) == [1, 1, 0]
    assert values(STATE, [0, 1], table=[[0, "broken"], [1, 1]]) == [4, 1]


def test_a_unit_of_measure_converts_numbers_and_no_names() -> None:
    assert values(COUNT, [0], Affine(60.0, 0.0), constant=2) == [120]
    with pytest.raises(ConfigError, match=r"here.constant: n is an Integer, not 0.5"):
        values(COUNT, [0], Affine(0.25, 0.0), constant=2)


def test_a_file_is_read_again_for_the_place_of_a_wrong_value_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Many different values else take a time that grows with the square of their number."""
    path, read = tmp_path / "in.csv", []
    line_of = CsvFile.line_of
    monkeypatch.setattr(CsvFile, "line_of", lambda self, row: read.append(row) or line_of(self, row))
    path.write_text("time,n\n" + "".join(f"{k},{k}\n" for k in range(100)))
    assert values(COUNT, [0, 99], csv=str(path)) == [0, 99]
    assert read == []
    path.write_text(path.read_text() + "100,x\n")
    with pytest.raises(ConfigError, match=r"in.csv: line 102, column 'n': n is a finite Integer number"):
        values(COUNT, [0], csv=str(path))
    assert read == [100]


def test_a_csv_holds_numbers_truths_and_names_of_items(tmp_path: Path) -> None:
    path = tmp_path / "in.csv"
    path.write_text("time;n;b;e\n0;1;TRUE;off\n# c\n1;-2;0; broken \n2;3.0;false;1\n")
    assert values(COUNT, [0, 1, 2], csv=str(path)) == [1, -2, 3]
    assert values(FLAG, [0, 1, 2], csv=str(path), column="b") == [1, 0, 0]
    assert values(STATE, [0, 1, 2], csv=str(path), column="e") == [1, 4, 1]
    with pytest.raises(
        ConfigError, match=r"in.csv: line 2, column 'b': n is a finite Integer number, not 'TRUE'"
    ):
        values(COUNT, [0], csv=str(path), column="b")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,n\n0,\n", "line 2, column 'n': n is a finite Integer number, not ''"),
        ("time,n\n0,1\n# c\n1,nan\n", "line 4, column 'n': n is a finite Integer number, not 'nan'"),
        ("time,n\n0,1_0\n", "line 2, column 'n': n is a finite Integer number, not '1_0'"),
        (f"time,n\n0,{'9' * 5000}\n", "line 2, column 'n': n is a finite Integer number, not '999"),
        ("time,n\n0,9007199254740993\n", "line 2, column 'n': n = 9007199254740993 is more than a double"),
        ("time,n\n1,0\n0,1\n", "line 3, column 'time': time goes back from 1.0 s to 0.0 s"),
        ("time,n\nnan,0\n", "line 2, column 'time': 'nan' is not a finite number"),
        ("time,n\n", "in.csv: there is no row"),
    ],
)
def test_a_wrong_row_is_named(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "in.csv"
    path.write_text(text)
    with pytest.raises(ConfigError, match=said):
        values(COUNT, [0], csv=str(path))


def test_decimal_commas_are_those_of_a_real(tmp_path: Path) -> None:
    path = tmp_path / "in.csv"
    path.write_text("time;n;x\n0,0;1,0;0,5\n1,5;2,0;0,25\n")
    assert values(COUNT, [0, 1.5], csv=str(path)) == [1, 2]
    entry = StimulusEntry.model_validate({"to": "u.x", "csv": str(path), "column": "x"})
    assert course(entry, "here", None, CLOCK, np.array([0.0, 0.75, 1.5])) == [0.5, 0.375, 0.25]


def test_a_table_that_goes_back_is_named() -> None:
    with pytest.raises(ConfigError, match=r"here.table: row 2: time goes back from 1.0 s to 0.0 s"):
        values(COUNT, [0], table=[[1.0, 1], [0.0, 2]])


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"sine": {"amplitude": 1, "period": 1}}, "here.sine: n is of type Integer, which takes a constant"),
        ({"ramp": {"slope": 1}}, "here.ramp: n is of type Integer"),
        (
            {"table": [[0, 1]], "interpolation": "linear"},
            'here.interpolation: n .* "linear" is between Reals',
        ),
    ],
)
def test_what_only_a_real_can_follow_is_refused(entry: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        values(COUNT, [0], **entry)
