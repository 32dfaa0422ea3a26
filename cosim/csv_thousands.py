"""Points and commas in the numbers of a CSV file that may divide thousands: 1.500 is 1.5, or 1500.

Points divide them in German numbers, commas in English ones. Where values are separated by ';' or a tab, and
no number of the columns that are read shows that the mark is a decimal one, both are possible.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from .csv_numbers import CsvFile
from .csv_text import number_in

_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")
_NAMES = {".": "point", ",": "comma"}


def thousands_note(file: CsvFile, columns: Sequence[int]) -> str:
    """Return a warning for the first number of some columns that may be read two ways; "" where none may.

    Raises ConfigError as `CsvFile.numbers` does for a line of another length.
    """
    if file.separator == ",":
        return ""
    first, elsewhere = None, set()
    for line, row in file.full_rows():
        for j, cell in enumerate(row):
            text = cell.strip()
            mark = "." if "." in text else "," if "," in text else ""
            if not mark or number_in(text, file.separator) is None:
                continue
            if j not in columns:
                elsewhere.add(mark)
            elif not _GROUPED.fullmatch(text):
                return ""
            elif first is None:
                first = (line, j, text, mark)
    if first is None:
        return ""
    line, j, text, mark = first
    other = "," if mark == "." else "."
    more = f"; other columns have decimal {_NAMES[other]}s" if other in elsewhere else ""
    return (
        f"{file.path}: line {line}, column '{file.names[j]}': {text!r} is read as "
        f"{number_in(text, file.separator):g}; where the {_NAMES[mark]} divides thousands, it is "
        f"{text.replace(mark, '')}: write the numbers without it{more}"
    )
