"""The HTML of a page's sections: whatever text goes in, no tag and no sign that hides something comes out."""

from __future__ import annotations

import html
from collections.abc import Collection, Sequence

from ..visible import flowing, visible

_STACKED = 3  # columns; from here on the cells of a row stand over each other on a narrow screen


def escaped(text: object) -> str:
    """Return a text on one line as HTML."""
    return html.escape(flowing(str(text)))


def block(text: str) -> str:
    """Return a text of several lines as HTML that keeps them."""
    return f"<pre>{html.escape(visible(text))}</pre>"


def section(title: str, *parts: str) -> str:
    """Return a section with its title, of parts that are HTML; "" where all are empty."""
    inside = "".join(parts)
    return f"<section><h2>{escaped(title)}</h2>{inside}</section>" if inside else ""


def folded(title: str, *parts: str) -> str:
    """Return parts that are HTML behind a title that opens them; "" where all are empty."""
    inside = "".join(parts)
    return f"<details><summary>{escaped(title)}</summary>{inside}</details>" if inside else ""


def table(headers: Sequence[str], rows: Sequence[Sequence[object]], right: Collection[str] = ()) -> str:
    """Return a table of texts, the columns named in `right` at the right; "" without a row."""
    if not rows:
        return ""
    marks = [' class="right"' if header in right else "" for header in headers]
    head = "".join(f"<th{mark}>{escaped(header)}</th>" for mark, header in zip(marks, headers, strict=True))
    heads = [f' data-head="{escaped(header)}"' for header in headers]
    body = "".join(
        "<tr>"
        + "".join(f"<td{m}{h}>{escaped(c)}</td>" for m, h, c in zip(marks, heads, cells, strict=True))
        + "</tr>"
        for cells in rows
    )
    kind = ' class="stacks"' if len(headers) >= _STACKED else ""  # on a narrow screen
    return f'<div class="wide"><table{kind}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def listed(texts: Sequence[str]) -> str:
    """Return a list of texts; "" for none."""
    return f"<ul>{''.join(f'<li>{escaped(text)}</li>' for text in texts)}</ul>" if texts else ""
