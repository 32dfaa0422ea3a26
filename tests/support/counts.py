"""The sentence of the README that counts what `evcosim reproduce` shows.

python tests/support/counts.py --write     # after a change of master/reproduce/printed.toml
"""

from __future__ import annotations

import re
import sys
import textwrap
from pathlib import Path

from evcosim.master.reproduce import printed

README = Path(__file__).parents[2] / "README.md"
PATTERN = re.compile(r"\d+\s+printed\s+numbers,\s+equations,\s+figures\s+and\s+claims:[^.]*\.")


def sentence() -> str:
    """Return the sentence, of the table."""
    return f"{printed.sentence(row.verdict for row in printed.rows())}."


def counted(text: str) -> list[str]:
    """Return the sentences in a text that count, each on one line."""
    return [" ".join(found.split()) for found in PATTERN.findall(text)]


if __name__ == "__main__" and "--write" in sys.argv[1:]:
    lines = textwrap.fill(sentence(), 119)
    README.write_text(PATTERN.sub(lines, README.read_text(encoding="utf-8")), encoding="utf-8")
