"""Tables in Markdown, and the place in a page of the docs where a command keeps its own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table; all columns but the first are aligned to the right."""
    rule = ["---", *("--:" for _ in header[1:])]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (header, rule, *rows))


def short(microseconds: float) -> str:
    """A time with three digits."""
    return f"{microseconds:.3g}" if microseconds < 1000.0 else f"{microseconds:.0f}"


def put(page: Path, name: str, text: str) -> None:
    """Replace what stands between `<!-- NAME -->` and `<!-- end NAME -->` in a page.

    Raises ValueError where the page has no such place.
    """
    begin, end = f"<!-- {name} -->", f"<!-- end {name} -->"
    before = page.read_text(encoding="utf-8")
    after, count = re.subn(
        f"{re.escape(begin)}.*?{re.escape(end)}", lambda _: f"{begin}\n{text}\n{end}", before, flags=re.DOTALL
    )
    if not count:
        raise ValueError(f"{page}: there is no place '{begin}' ... '{end}' for what was measured")
    page.write_text(after, encoding="utf-8")
