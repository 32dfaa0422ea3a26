"""Points in the numbers of a CSV file that may divide thousands, as German ones do: 1.500 is 1.5, or 1500.

Where values are separated by ';' or a tab, and no number of the columns that are read shows that its point is
a decimal one, both are possible.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from .csv_numbers import CsvFile
from .csv_text import number_in

_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}\.\d{3}")


def thousands_note(file: CsvFile, columns: Sequence[int]) -> str:
    """Return a warning for the first number of some columns that may be read two ways; "" where none may.

    Raises ConfigError as `CsvFile.numbers` does for a line of another length.
    """
    if file.separator == ",":
        return ""
    first, commas = None, False
    for line, row in file.full_rows():
        for j, cell in enumerate(row):
            text = cell.strip()
            if "," in text:
                commas |= number_in(text, file.separator) is not None
            elif j in columns and "." in text:
                if not _GROUPED.fullmatch(text):
                    if number_in(text, file.separator) is not None:
                        return ""
                elif first is None:
                    first = (line, j, text)
    if first is None:
        return ""
    line, j, text = first
    other = "; other columns have decimal commas" if commas else ""
    return (
        f"{file.path}: line {line}, column '{file.names[j]}': {text!r} is read as {float(text):g}; where the "
        f"point divides thousands, it is {text.replace('.', '')}: write the numbers without it{other}"
    )
