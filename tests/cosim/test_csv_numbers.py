"""Numbers in CSV files: two ways of reading give the same, and a mistake is found where it is."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim import csv_numbers
from evcosim.cosim.csv_numbers import CsvFile
from evcosim.cosim.errors import ConfigError

finite = st.floats(allow_nan=False, allow_infinity=False)
tables = arrays.arrays(np.float64, st.tuples(st.integers(0, 5), st.integers(1, 4)), elements=finite)


def text_of(table: np.ndarray, end: str = "\n") -> str:
    names = [f"c{j}" for j in range(table.shape[1])]
    return "".join(",".join(row) + end for row in [names, *(map(repr, row) for row in table.tolist())])


def opened(path: Path, text: str | bytes) -> CsvFile:
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return CsvFile.of(path)


@given(table=tables, end=st.sampled_from(["\n", "\r\n"]), data=st.data())
def test_the_numbers_are_those_that_were_written_whoever_reads_them(
    table: np.ndarray, end: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    file = opened(tmp_path_factory.getbasetemp() / "numbers.csv", text_of(table, end))
    every = range(table.shape[1])
    columns = data.draw(st.lists(st.sampled_from(every), min_size=1, max_size=3))
    assert file.names == tuple(f"c{j}" for j in every)
    assert file.numbers().tobytes() == table.tobytes()
    for wanted in (every, columns):
        expected = table[:, list(wanted)].tobytes()
        assert file.numbers(wanted).tobytes() == expected
        by_numpy = file._by_numpy(wanted)
        assert by_numpy is not None and by_numpy.tobytes() == expected
        assert file._line_by_line(wanted).tobytes() == expected


def test_one_of_many_columns_is_the_one_that_was_asked_for(tmp_path: Path) -> None:
    table = np.random.default_rng(1).normal(size=(20, 30))
    file = opened(tmp_path / "wide.csv", text_of(table))
    assert np.array_equal(file.numbers((0, 17)), table[:, [0, 17]])


def test_what_nobody_wants_may_be_anything(tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", 't,phase,v\n0,"cold, wet",1\n1,,2\n2,nan,3\n')
    assert file.numbers((0, 2)).tolist() == [[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]]
    with pytest.raises(ConfigError, match="line 2, column 'phase': 'cold, wet' is not a number"):
        file.numbers((0, 1))


@pytest.mark.parametrize(
    "end", ["\n", "\r\n", "  \n", " \n\t\n", ",\n", " , \n,\n\n", '"",""\n', ",,,,\n", "\f\n"]
)
def test_lines_without_a_value_count_for_nothing(tmp_path: Path, end: str) -> None:
    path = tmp_path / "a.csv"
    for text in (f"time,a\n0,1\n2,3\n{end}", f"time,a\n0,1\n{end}2,3\n", f"time,a\n{end}0,1\n2,3\n"):
        path.write_text(text)
        assert CsvFile.of(path).numbers().tolist() == [[0.0, 1.0], [2.0, 3.0]]
        assert CsvFile.of(path).texts(1) == ["1", "3"]
    path.write_text(f"time,a\n{end}0,1\n{end}2,x\n")
    line = 4 + 2 * (end.count("\n") - 1) + 1
    with pytest.raises(ConfigError, match=rf"a.csv: line {line}, column 'a': 'x' is not a number"):
        CsvFile.of(path).numbers()


def test_a_file_without_a_row_has_none(tmp_path: Path) -> None:
    for nothing in ("t,v", "t,v\n", "t,v\n\n\n", "t,v\n,\n"):
        assert opened(tmp_path / "c.csv", nothing).numbers().shape == (0, 2)


@given(
    table=tables,
    separator=st.sampled_from([",", ";", "\t"]),
    header=st.integers(0, 3),
    row=st.integers(0, 3),
    end=st.sampled_from(["\n", "\r\n"]),
)
def test_separators_at_the_end_of_lines_count_for_nothing(
    table: np.ndarray,
    separator: str,
    header: int,
    row: int,
    end: str,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    lines = text_of(table).replace(",", separator).splitlines()
    more = [lines[0] + header * separator, *(line + row * separator for line in lines[1:])]
    file = opened(tmp_path_factory.getbasetemp() / "ends.csv", "".join(line + end for line in more))
    if table.shape[1] > 1:
        every = range(table.shape[1])
        assert file.named == tuple(f"c{j}" for j in every)
        assert file.numbers(every).tobytes() == table.tobytes()


@pytest.mark.parametrize("rows", ["0,1,\n2,3,x\n", "0,1,,\n2,3,,x\n"])
def test_a_value_behind_the_last_name_is_one_too_many(rows: str, tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", f"t,v\n{rows}")
    with pytest.raises(ConfigError, match=r"line 3 has \d values, the header has 2 columns"):
        file.numbers()


def test_trailing_separators_do_not_choose_the_separator(tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", "t;v [m/s, raw];\n0;1,5\n1;2,5\n")
    assert file.named == ("t", "v [m/s, raw]")
    assert opened(tmp_path / "y.csv", "t;v [m/s, raw]\n0;1,5;\n").numbers().tolist() == [[0.0, 1.5]]


def test_a_name_may_hold_commas_and_line_ends(tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", b'\xef\xbb\xbf"Time\r\n[s]", "x[1,2]" ,6" wheel\n0,1,2\n3,4,fast\n')
    assert file.names == ("Time\r\n[s]", "x[1,2]", '6" wheel')
    assert file.numbers((0, 1)).tolist() == [[0.0, 1.0], [3.0, 4.0]]
    with pytest.raises(ConfigError, match="line 4, column '6\" wheel': 'fast' is not a number"):
        file.numbers()


def test_old_line_ends_and_digits_of_other_scripts_are_read_too(tmp_path: Path) -> None:
    assert opened(tmp_path / "x.csv", "t,v\r0,1\r2,٣\r").numbers().tolist() == [[0.0, 1.0], [2.0, 3.0]]


HEADERS = {
    b"": (),
    b"\n": (),
    b"\n\nt,v\n": ("t", "v"),
    b"t\n0\n": ("t",),
    b",,\n": ("", "", ""),
    b"1,x\n": ("1", "x"),
}


@pytest.mark.parametrize("text", HEADERS)
def test_names_are_read_as_they_are(text: bytes, tmp_path: Path) -> None:
    assert opened(tmp_path / "x.csv", text).names == HEADERS[text]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"0;1,5\n1;2\n", "line 1: a header with names is needed, not numbers: '0;1,5'"),
        (b"# nothing, known\n0\n", "line 2: a header with names is needed, not numbers: '0'"),
        (b"0,1\n1,2\n", "line 1: a header with names is needed, not numbers: '0,1'"),
        (b't,"v\n0,1\n2,3\n', "line 1: a quote of the header is not closed: 't,\"v'"),
        (b"t,\x81\n0,1\n", "is not UTF-8 or Windows-1252 text: character maps to <undefined> at byte 2"),
        (b"\xff\xfet\x00,", "is not UTF-16 or UTF-32 text: truncated data"),
        (b't,"' + 200_000 * b"x", "line 1: is not well-formed CSV: field larger than field limit"),
    ],
)
def test_a_broken_header_is_refused(text: bytes, said: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError) as refusal:
        opened(tmp_path / "x.csv", text)
    assert str(refusal.value).startswith(f"{tmp_path / 'x.csv'}: {said}")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"t,v\n0,1\n1,\n", "line 3, column 'v': the value is missing"),
        (b"t,v\n0,1\n1, fast \n", "line 3, column 'v': 'fast' is not a number"),
        (b"t,v\n0,1\n1,nan\n", "line 3, column 'v': 'nan' is not a finite number"),
        (b"t,v\n0,-inf\n", "line 2, column 'v': '-inf' is not a finite number"),
        (b"t,v\n0,1e999\n", "line 2, column 'v': '1e999' is not a finite number"),
        (b"t,v\n0,1_000\n", "line 2, column 'v': '1_000' is not a finite number"),
        (b"t,v\n0,1\n1\n", "line 3 has 1 value, the header has 2 columns"),
        (b"t,v\n0,1,2\n1,1,2\n", "line 2 has 3 values, the header has 2 columns"),
        (b'"t\n",v\n0,"1\n"\n1,x\n', "line 5, column 'v': 'x' is not a number"),
        (b"t,v\n0,1\n0,\x81\n", "is not UTF-8 or Windows-1252 text: character maps to <undefined> at byte"),
        (b't,v\n# 1\n0,1\n#\n"1",no\n', "line 5, column 'v': 'no' is not a number"),
        (b"t,v\n0,true\n", "line 2, column 'v': 'true' is not a number"),
        (b't,v\n0,"1,5"\n', "line 2, column 'v': '1,5' is not a number"),
        (b"t;v\n0;1.234,5\n", "line 2, column 'v': '1.234,5' is not a number"),
        (b"t;v\n0,5;1.5\n", "line 2, column 'v': '1.5' has '.' as its decimal mark, and '0,5' above has ','"),
        (b"t\tv\n0.5\t1\n1\t1,5\n", "line 3, column 'v': '1,5' has ',' as its decimal mark, and '0.5'"),
        (b't,v\n0,"' + 200_000 * b"x", "line 2: is not well-formed CSV: field larger than field limit"),
    ],
)
def test_a_mistake_is_named_with_its_place(text: bytes, said: str, tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_bytes(text)
    with pytest.raises(ConfigError) as refusal:
        CsvFile.of(path).numbers()
    assert str(refusal.value).startswith(f"{path}: {said}")


def test_a_file_that_is_none_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none.csv: cannot be read: No such file or directory"):
        CsvFile.of(tmp_path / "none.csv")
    with pytest.raises(ConfigError, match="cannot be read: it is a folder, not a file"):
        CsvFile.of(tmp_path)


@pytest.mark.parametrize("phase", ["1", "warm"])
def test_reading_holds_little_beside_the_numbers(phase: str, tmp_path: Path) -> None:
    """Twice the rows take twice the numbers: 16 bytes for two columns, where texts would take 100."""
    peaks = []
    for count in (20_000, 40_000):
        rows = "".join(f"{k},{phase},{k}.5\n" for k in range(count))
        file = opened(tmp_path / "x.csv", "t,phase,v\n" + rows)
        tracemalloc.start()
        assert file.numbers((0, 2)).shape == (count, 2)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] - peaks[0] < 45 * 20_000


def test_few_columns_of_many_are_not_all_converted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = opened(tmp_path / "x.csv", text_of(np.ones((2, 7))))
    monkeypatch.setattr(csv_numbers, "_all_numbers", lambda *_: pytest.fail("numpy converts every column"))
    assert file.numbers((0, 6)).tolist() == [[1.0, 1.0]] * 2


GERMAN = 'Zeit [s];v, "gemessen" [\N{DEGREE SIGN}C]\r\n0;1,5\r\n"0,5";-2,25e1\r\n'


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le", "utf-16-be", "utf-32"]
)
def test_a_german_table_is_read_in_every_encoding_that_excel_writes(encoding: str, tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", GERMAN.encode(encoding))
    assert file.names == ("Zeit [s]", 'v, "gemessen" [\N{DEGREE SIGN}C]')
    assert file.numbers().tolist() == [[0.0, 1.5], [0.5, -22.5]]


@given(table=tables, separator=st.sampled_from([";", "\t"]), comma=st.booleans())
def test_other_separators_give_the_same_numbers(
    table: np.ndarray, separator: str, comma: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    text = text_of(table).replace(",", separator)
    file = opened(tmp_path_factory.getbasetemp() / "other.csv", text.replace(".", ",") if comma else text)
    if table.shape[1] > 1:
        assert file.numbers().tobytes() == table.tobytes()


@pytest.mark.parametrize(
    ("text", "names", "rows"),
    [
        ("# made by hand\n\n  # twice\nt,v\n# half way\n0,1\n#1,5\n1,2\n", ("t", "v"), [[0, 1], [1, 2]]),
        ("# t,v\n0,1\n1,2\n", ("t", "v"), [[0, 1], [1, 2]]),  # as numpy.savetxt writes it
        ("sep=;\nt,s;v\n0;1\n", ("t,s", "v"), [[0, 1]]),
        ("t;v [m/s, raw]\n0;1,5\n", ("t", "v [m/s, raw]"), [[0, 1.5]]),
        ("t,v;w\n0,1\n", ("t", "v;w"), [[0, 1]]),
        ('t,"v;w;x"\n0,1\n', ("t", "v;w;x"), [[0, 1]]),
        ("t;v\n0.5;1e3\n", ("t", "v"), [[0.5, 1000]]),
        ('t, "v"\n0, "1.5"\n', ("t", "v"), [[0, 1.5]]),
    ],
)
def test_comments_and_separators_are_told_from_names_and_numbers(
    text: str, names: tuple[str, ...], rows: list[list[float]], tmp_path: Path
) -> None:
    file = opened(tmp_path / "x.csv", text)
    assert file.names == names
    assert file.numbers().tolist() == rows
    assert file._line_by_line(range(2)).tolist() == rows


def test_truth_is_a_number_only_where_it_is_allowed(tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", "t,v\n0,TRUE\n1,false\n2,1\n")
    assert file.numbers(truths=[1]).tolist() == [[0.0, 1.0], [1.0, 0.0], [2.0, 1.0]]
    with pytest.raises(ConfigError, match="line 2, column 'v': 'TRUE' is not a number"):
        file.numbers()


def test_texts_and_the_lines_of_rows_pass_over_comments_and_empty_lines(tmp_path: Path) -> None:
    file = opened(tmp_path / "x.csv", '# a\nt,v\n\n0, warm \n# b\n1,"cold,\n# wet"\n2,\n')
    assert file.texts(1) == ["warm", "cold,\n# wet", ""]
    assert [file.line_of(row) for row in range(3)] == [4, 7, 8]


CUT = {
    "t;v\n0;1,5\n1;2,": "line 3, the last, does not end: '1;2,'; the file was cut off: its last value ends",
    "t,v\n0,1.5\n1,2.": "line 3, the last, does not end: '1,2.'; the file was cut off: its last value ends",
    "t\tv\n0\t1\n1\t-2. ": "line 3, the last, does not end: ",
    't,v\n0,1\n1,"2.5': "line 3, the last, does not end: '1,\"2.5'; the file was cut off: its last value has",
    't,v\n0,1\n1,"2.': "line 3, the last, does not end: ",
    't,v\n0,1\n1,"two\nand': "line 4, the last, does not end: 'and'; the file was cut off",
    "t,v\n0,1\n1,2e": "line 3, column 'v': '2e' is not a number",
    "t,v\n0,1\n1,2e-": "line 3, column 'v': '2e-' is not a number",
    "t,v\n0,1\n1,-": "line 3, column 'v': '-' is not a number",
    "t,v\n0,1\n1,": "line 3, column 'v': the value is missing",
    "t,v\n0,1\n1": "line 3 has 1 value, the header has 2 columns",
    "t,v\n0,1,\n1,2": "line 3, the last, does not end: '1,2'; the file was cut off: its last value l",
    "t;v;\n0;1;\n1;2": "line 3, the last, does not end: '1;2'; the file was cut off: its last value l",
    't,\N{DEGREE SIGN}C,w\n0,1,"5 \N{DEGREE SIGN}': "line 2, the last, does not end: ",
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("text", CUT)
def test_a_file_that_was_cut_off_within_its_last_value_is_refused(
    text: str, encoding: str, tmp_path: Path
) -> None:
    path = tmp_path / "x.csv"
    with pytest.raises(ConfigError) as refusal:
        file = opened(path, text.encode(encoding))
        file.last_line_without_end()
        file.numbers()
    if encoding == "utf-8":
        assert str(refusal.value).startswith(f"{path}: {CUT[text]}")


@pytest.mark.parametrize(
    "text", ["t,v\n0,1\n1,2.5", "t;v\n0;1\n1;2,5", 't,v\n0,1\n1,"2.5"', "t,v\n0,1.\n1,2\n# cut.", 't,6"\n1,2']
)
def test_a_whole_last_line_need_not_end_and_one_that_does_may_end_with_a_mark(
    text: str, tmp_path: Path
) -> None:
    file = opened(tmp_path / "x.csv", text)
    file.last_line_without_end()
    assert len(file.numbers()) == text.count("\n") - ("#" in text)
    ended = opened(tmp_path / "y.csv", "t,v\n0,1\n1,2.\n")
    assert ended.last_line_without_end() is None
    assert ended.numbers().tolist() == [[0.0, 1.0], [1.0, 2.0]]


def test_a_text_may_end_with_a_full_stop_and_is_not_cut_within_a_character(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    whole = "t,\N{DEGREE SIGN}C\n0,warm\n1,no more of it.".encode()
    file = opened(path, whole)
    file.last_line_without_end()
    assert file.texts(1) == ["warm", "no more of it."]
    with pytest.raises(ConfigError, match=r"x\.csv: ends within a character of UTF-8: the file was cut off"):
        opened(path, whole + "\N{EURO SIGN}".encode()[:-1])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("t [s],time,x\n0,0,1\n1,2,5\n",
         "line 3, column 'time': 2 is taken as the time, though column 't [s]' has another one, 1"),
        ("t;timestamp;x\n0;1704067200,5;1\n",
         "line 2, column 't': 0 is taken as the time, though column 'timestamp' has another one, "
         "1704067200,5"),
        ("t [s],time,x\n0,0,1\n1.0,1,5\n", ""),
        ("time,timestamp\n0,2024-01-01\n", ""),
        ("time,T\n0,20\n", ""),  # a temperature
        ("time,x\n0,20\n", ""),
    ],
)  # fmt: skip # a table
def test_two_columns_that_could_be_the_time_are_a_warning_where_they_differ(tmp_path, text, said):
    (tmp_path / "x.csv").write_text(text)
    assert CsvFile.of(tmp_path / "x.csv").time_note() == (said and f"{tmp_path / 'x.csv'}: {said}")
