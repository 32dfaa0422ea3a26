"""docs/units.md: its tables from cosim/units/spellings.py and cosim/units/names.py.

.venv/bin/python tests/support/units_page.py   # writes the page anew, after a change of the tables
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from pathlib import Path

from evcosim.cosim.units.names import DOUBTFUL, NAMES
from evcosim.cosim.units.spellings import EXACT, NO_UNIT
from evcosim.cosim.units.words import WORDS, Row
from evcosim.cosim.writing import markdown_table

PAGE = Path(__file__).parents[2] / "docs" / "units.md"
_BLOCK = re.compile(r"(<!-- spellings: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
_ROWS = {"words": WORDS, "exact": EXACT}


def rewritten(page: str) -> str:
    """Return the page with its tables made anew; all else stays."""
    return _BLOCK.sub(lambda part: f"{part[1]}\n{_table(part[2])}\n{part[3]}", page)


def _table(name: str) -> str:
    if name == "none":
        return ", ".join(f"`{text}`" for text in NO_UNIT if text) + "\n"
    if name == "names":
        return "\n" + _wrapped(f"`{text}`" for text in NAMES) + "\n"
    if name == "doubtful":
        return (
            "\n".join(markdown_table(("name", "may be"), [(f"`{n}`", m) for n, m in DOUBTFUL.items()])) + "\n"
        )
    return (
        "\n".join(markdown_table(("written", "means", "met in"), [_row(row) for row in _ROWS[name]])) + "\n"
    )


def _wrapped(words: Iterable[str]) -> str:
    """Return words in lines of a page's width."""
    return textwrap.fill(", ".join(words), 120, break_long_words=False, break_on_hyphens=False)


def _row(row: Row) -> tuple[str, str, str]:
    spelling, meaning, source = row
    return f"`{spelling}`", " or ".join(f"`{part.strip()}`" for part in meaning.split("|")), source


if __name__ == "__main__":
    PAGE.write_text(rewritten(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
