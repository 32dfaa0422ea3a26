"""Any prefix of a file of text rows reads, as the texts that it holds whole."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.text_rows import TEXT_ROWS_NAME, TextRows, complete_texts, read_text_rows
from evcosim.cosim.results.text_table import Change, TextTable
from evcosim.cosim.results.variable import ResultVariable

VARIABLES = [
    ResultVariable("a.s", type="String", variability="discrete"),
    ResultVariable("b.t", type="String"),
]
CHANGES: list[Change] = [(0, ("", "x")), (2, ('line\n"two"', "x")), (5, ("\N{SNOWMAN}, \u2028", ""))]


def saved(folder: Path) -> Path:
    noted: list[Change] = []
    rows = TextRows(folder / TEXT_ROWS_NAME, VARIABLES, lambda first: noted[first:])
    rows.save()
    assert not (folder / TEXT_ROWS_NAME).exists()  # a run without texts has no such file
    noted += CHANGES[:1]
    rows.save()
    noted += CHANGES[1:]
    rows.save()
    return folder / TEXT_ROWS_NAME


def test_what_is_saved_is_read(tmp_path: Path) -> None:
    path = saved(tmp_path)
    table = read_text_rows(path, 6)
    assert (list(table.variables), list(table.changes)) == (VARIABLES, CHANGES)
    assert list(read_text_rows(path, 5).changes) == CHANGES[:2]  # the row of the third is not on the disk
    assert read_text_rows(tmp_path / "none", 5).names == ()
    with pytest.raises(FileExistsError):
        TextRows(path, VARIABLES, lambda first: CHANGES[first:]).save()


def test_texts_that_found_no_room_are_written_later_in_their_order(tmp_path: Path) -> None:
    """Half a line stays behind where the disk is full."""
    path = tmp_path / TEXT_ROWS_NAME
    noted = CHANGES[:1]
    rows = TextRows(path, VARIABLES, lambda first: noted[first:])
    rows.save()
    with path.open("ab") as file:
        file.write(b'[2, "lin')
    noted = CHANGES
    rows.save()
    assert list(read_text_rows(path, 6).changes) == CHANGES
    path.unlink()  # and where somebody removes it
    rows.save()
    assert list(read_text_rows(path, 6).changes) == CHANGES


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_file_of_texts_is_completed(count: int, tmp_path: Path) -> None:
    path = tmp_path / TEXT_ROWS_NAME
    if count:
        TextRows(path, VARIABLES, lambda first: CHANGES[first:count]).save()
        with path.open("ab") as file:
            file.write(b"[7, ")
    assert complete_texts(path, TextTable(VARIABLES, CHANGES))
    assert list(read_text_rows(path, 6).changes) == CHANGES
    assert not complete_texts(tmp_path / "none" / "texts", TextTable(VARIABLES, CHANGES))


@given(share=st.floats(0.0, 1.0))
def test_a_prefix_reads(tmp_path_factory: pytest.TempPathFactory, share: float) -> None:
    path = saved(tmp_path_factory.mktemp("rows"))
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    whole = path.read_bytes().count(b"\n") - 1
    assert list(read_text_rows(path, 6).changes) == CHANGES[: max(0, whole)]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("[0]", "line 2: needs a row, then 2 texts"),
        ('[0, "x", 1]', "line 2: needs a row, then 2 texts"),
        ('[-1, "x", "y"]', "line 2: needs a row, then 2 texts"),
        ('[true, "x", "y"]', "line 2: needs a row, then 2 texts"),
        ("7", "line 2: is no row with texts"),
        ("[0, ", "line 2: is no row with texts"),
        ('[1, "x", "y"]\n[1, "z", "y"]', "line 3: row 1 comes after row 1"),
    ],
)
def test_a_line_that_holds_no_texts_is_refused(line: str, said: str, tmp_path: Path) -> None:
    path = saved(tmp_path)
    head = path.read_text().splitlines()[0]
    path.write_text(f"{head}\n{line}\n")
    with pytest.raises(ConfigError, match=said):
        read_text_rows(path, 6)
    path.write_text(f"{line}\n")
    with pytest.raises(ConfigError, match="does not begin as a file of texts"):
        read_text_rows(path, 6)
