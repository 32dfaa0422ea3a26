"""Any prefix of a file of text rows reads, as the texts that it holds whole."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.text_rows import TEXT_ROWS_NAME, TextRows, read_text_rows
from evcosim.cosim.results.variable import ResultVariable

VARIABLES = [
    ResultVariable("a.s", type="String", variability="discrete"),
    ResultVariable("b.t", type="String"),
]
CHANGES = [(0, ("", "x")), (2, ('line\n"two"', "x")), (5, ("\N{SNOWMAN}, \u2028", ""))]


def saved(folder: Path) -> Path:
    rows = TextRows(folder / TEXT_ROWS_NAME, VARIABLES)
    rows.save([])
    assert not (folder / TEXT_ROWS_NAME).exists()  # a run without texts has no such file
    rows.save(CHANGES[:1])
    rows.save(CHANGES[1:])
    return folder / TEXT_ROWS_NAME


def test_what_is_saved_is_read(tmp_path: Path) -> None:
    path = saved(tmp_path)
    table = read_text_rows(path, 6)
    assert (list(table.variables), list(table.changes)) == (VARIABLES, CHANGES)
    assert list(read_text_rows(path, 5).changes) == CHANGES[:2]  # the row of the third is not on the disk
    assert read_text_rows(tmp_path / "none", 5).names == ()
    with pytest.raises(FileExistsError):
        TextRows(path, VARIABLES).save(CHANGES)


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
