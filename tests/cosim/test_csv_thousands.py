"""Points and commas that may divide thousands: a warning where nothing shows that they are decimal ones."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.csv_numbers import CsvFile
from evcosim.cosim.csv_thousands import thousands_note

HEADER = "time;speed;note\n"


def noted(folder: Path, text: str, columns=(0, 1)) -> str:
    path = folder / "speed.csv"
    path.write_text(text)
    return thousands_note(CsvFile.of(path), columns)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{HEADER}0;900;\n1;1.500;\n", "line 3, column 'speed': '1.500' is read as 1.5; where the point "
                                        "divides thousands, it is 1500"),
        (f"{HEADER}0;-1.500;\n1;-2.750;\n", "line 2, column 'speed': '-1.500' is read as -1.5;"),
        (f"{HEADER}0;1.500;0,25\n1;2.000;0,5\n", "it is 1500: write the numbers without it; other "
                                                 "columns have decimal commas"),
        (f"{HEADER}0;12.000;04.05.2026\n", "is read as 12; where the point divides thousands, it is 12000"),
        (f"{HEADER}0;5;\n1.000;6;\n", "column 'time': '1.000' is read as 1;"),
        (HEADER.replace(";", "\t") + "0\t1.500\t\n", "'1.500' is read as 1.5"),
        (HEADER.replace(";", "\t") + "0\t1,500\t\n1\t999\t\n2\t12,750\t\n",
         "line 2, column 'speed': '1,500' is read as 1.5; where the comma divides thousands, it is 1500"),
        (f"{HEADER}0;900;\n1;-12,750;0.25\n", "'-12,750' is read as -12.75; where the comma divides "
                                             "thousands, it is -12750: write the numbers "
                                             "without it; other columns have decimal points"),
        (f"{HEADER}999;5;\n1,000;6;0,5\n", "column 'time': '1,000' is read as 1; where the comma"),
    ],
)  # fmt: skip # a table
def test_what_may_be_read_two_ways(tmp_path, text, said):
    note = noted(tmp_path, text)
    assert note.startswith(f"{tmp_path / 'speed.csv'}: line ") and said in note


@pytest.mark.parametrize(
    "text",
    [
        f"{HEADER}0;900;\n1;1500;\n",
        f"{HEADER}0.000;1.500;\n0.010;2.000;\n",  # times have decimal points
        f"{HEADER}0;1.500;\n1;1.25;\n",
        f"{HEADER}0;0.500;\n1;1.500;\n",
        f"{HEADER}0;1.500;\n1;1e3;\n2;1.5e3;\n",
        f"{HEADER}0,000;1,500;\n0,010;2,000;\n",
        f"{HEADER}0;1,500;\n1;1,25;\n",
        f"{HEADER}0;1,5e3;\n1;1,500;\n",
        f"{HEADER}0;5;1,500\n",
        f"{HEADER}0;999;\n1;1,500,000;\n",  # is refused, as no number
        f"{HEADER}0;5;1.500\n",  # a column that is not read
        HEADER.replace(";", ",") + "0,1.500,\n",
        HEADER,
    ],
)
def test_what_is_read_one_way(tmp_path, text):
    assert noted(tmp_path, text) == ""
