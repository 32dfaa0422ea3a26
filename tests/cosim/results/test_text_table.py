"""The table of texts beside results.csv: what is written is what is read, and only beside its own results."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.text_table import TextTable, read_texts, shown_text, texts_path, write_texts
from evcosim.cosim.results.variable import ResultVariable

VARIABLES = [ResultVariable("a.s", type="String"), ResultVariable("b.t", type="String")]
TIMES = np.array([0.0, 0.1, 0.2, 0.30000000000000004])
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=8)


@given(changes=st.dictionaries(st.integers(1, 3), st.tuples(TEXTS, TEXTS)), first=st.tuples(TEXTS, TEXTS))
def test_what_is_written_is_what_is_read(
    changes: dict[int, tuple[str, str]], first: tuple[str, str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "results.csv"
    table = TextTable(VARIABLES, sorted({0: first, **changes}.items()))
    write_texts(path, table, TIMES)
    back = read_texts(path, TIMES)
    assert back.names == table.names and back.changes == table.changes


def test_a_text_holds_until_it_changes() -> None:
    table = TextTable(VARIABLES, [(0, ("x", "")), (2, ("x", "y"))])
    assert table.column("a.s", 4).tolist() == ["x"] * 4
    assert table.column("b.t", 4).tolist() == ["", "", "y", "y"]
    assert table.column("b.t", 2).tolist() == ["", ""]


def test_results_without_texts_have_no_file_of_texts(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    write_texts(path, TextTable(VARIABLES, [(0, ("x", ""))]), TIMES)
    assert texts_path(path) == tmp_path / "x.texts.csv" and texts_path(path).exists()
    write_texts(path, TextTable(), TIMES)  # of the results that take the place of the others
    assert not texts_path(path).exists()
    assert read_texts(path, TIMES).names == ()


@given(
    changes=st.dictionaries(st.integers(1, 9), st.tuples(TEXTS, TEXTS)),
    rows=st.one_of(
        st.slices(10), st.lists(st.booleans(), min_size=10, max_size=10).map(lambda choice: np.array(choice))
    ),
    names=st.lists(st.sampled_from(["a.s", "b.t"]), unique=True),
)
def test_a_part_has_the_same_texts(changes: dict[int, tuple[str, str]], rows: Any, names: list[str]) -> None:
    table = TextTable(VARIABLES, sorted({0: ("", "x"), **changes}.items()))
    part = table.part(rows, names, 10)
    assert part.names == tuple(names)
    for name in names:
        expected = table.column(name, 10)[rows].tolist()
        assert part.column(name, len(expected)).tolist() == expected
        assert not expected or part.final()[names.index(name)] == expected[-1]
    assert all(one != two for (_, one), (_, two) in zip(part.changes, part.changes[1:], strict=False))


def test_results_that_were_cut_off_have_the_texts_up_to_their_end(tmp_path: Path) -> None:
    table = TextTable(VARIABLES, [(0, ("x", "y")), (2, ("z", "y")), (3, ("x", "y"))])
    write_texts(tmp_path / "x.csv", table, TIMES)
    for count in range(len(TIMES) + 1):
        kept = read_texts(tmp_path / "x.csv", TIMES[:count])
        assert kept.changes == tuple(change for change in table.changes if change[0] < count)


def test_a_table_that_was_cut_off_is_refused_wherever(tmp_path: Path) -> None:
    table = TextTable(VARIABLES, [(0, ("x", "y")), (2, ('say "on"', 'say "off"'))])
    write_texts(tmp_path / "x.csv", table, TIMES)
    path = tmp_path / "x.texts.csv"
    whole = path.read_bytes()
    for end in range(whole.index(b"say"), len(whole)):
        path.write_bytes(whole[:end])
        with pytest.raises(
            ConfigError, match=r"x.texts.csv: (line 3, the last, does not end|is no table of)"
        ):
            read_texts(tmp_path / "x.csv", TIMES)


def test_a_text_of_any_length_reads(tmp_path: Path) -> None:
    before = csv.field_size_limit()
    table = TextTable(VARIABLES, [(0, ("x" * 300_000, '"' * 200_000))])
    write_texts(tmp_path / "x.csv", table, TIMES)
    assert read_texts(tmp_path / "x.csv", TIMES).changes == table.changes
    assert csv.field_size_limit() == before


def test_a_file_of_somebody_stays(tmp_path: Path) -> None:
    """x.texts.csv may be a table of somebody, about texts or not."""
    (tmp_path / "x.texts.csv").write_text("time,label\n0.05,begin\n")
    write_texts(tmp_path / "x.csv", TextTable(), TIMES)
    assert read_texts(tmp_path / "x.csv", TIMES).names == ()
    with pytest.raises(ConfigError, match=r"x.texts.csv: the texts of x.csv go there, and the file that is"):
        write_texts(tmp_path / "x.csv", TextTable(VARIABLES, [(0, ("a", "b"))]), TIMES)
    assert (tmp_path / "x.texts.csv").read_text() == "time,label\n0.05,begin\n"


def test_a_text_in_a_line_steers_no_terminal_and_has_an_end() -> None:
    assert shown_text("a\x1b[2J\u202e\n") == r"'a\x1b[2J\u202e\n'"
    assert shown_text("x" * 100) == "'" + "x" * 56 + "..."


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,a.s\n0.0,x\n0.15,y\n", "line 3: '0.15' begins no row of results.csv"),
        ("time,a.s\n0.0,x\nnan,y\n", "line 3: 'nan' begins no row of results.csv"),
        ("time,a.s\n0.0,x\n0.0,y\n", "line 3: '0.0' begins no row of results.csv"),
        ("time,a.s\n0.0\n", "line 2: '0.0' begins no row of results.csv"),
        ("time,a.s\nsoon,x\n", "line 2: 'soon' begins no row of results.csv"),
        ('time,a.s\n0.0,"x\n', "is no table of texts: unexpected end of data"),
        ("time,a.s,a.s\n", r"line 1: columns 2 \('a.s'\) and 3 \('a.s'\) both have this name"),
        ("time,a.s,time\n", r"line 1: columns 1 \('time'\) and 3 \('time'\) both have this name"),
        ("time,a.s,a.x\n", "line 1, column 3: 'a.x' has numbers in the results"),
    ],
)
def test_a_table_of_other_results_is_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "results.texts.csv").write_text(text)
    with pytest.raises(ConfigError, match=said):
        read_texts(tmp_path / "results.csv", TIMES, ["a.x"])
