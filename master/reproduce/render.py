"""The files of pages: Markdown with the pictures beside it, and HTML with everything in one file."""

from __future__ import annotations

import base64
import dataclasses
import html
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from ...cosim.figures import draw as figures
from ...cosim.report.assets import policy, styles
from ...cosim.report.assets import scripts as panel_scripts
from ...cosim.visible import visible
from ...cosim.writing import markdown_table, write_text
from .page import MISSED, Page, Picture, Row
from .printed import VERDICTS, about_verdicts, counted, sentence

_HEAD = ("place", "what", "printed", "obtained", "to reach", "verdict", "reason")
_OWN_HEAD = ("what", "obtained", "to reach", "verdict", "reason")
_OWN = "Own numbers"
_PICTURES = "Figures"
_LONG = re.compile(r"\S{16,}")  # a name that may not fit a column
_ABOUT_OWN = (
    "Numbers that the paper does not print, beside what they were found to be before. They are not counted "
    "with those above."
)

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1240px; margin: 2rem auto; padding: 0 1rem;
  color: #1a1a1a; overflow-wrap: break-word; }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th, td { border-bottom: 1px solid #d0d0d0; padding: .35rem .6rem; text-align: left; vertical-align: top; }
th { background: #f3f3f3; position: sticky; top: 0; }
summary { cursor: pointer; } .matrix { display: block; overflow-x: auto; white-space: nowrap; }
td.reproduced { color: #005a32; } td.calibrated, td.own { color: #08519c; } td.by { color: #4a4a4a; }
td { overflow-wrap: break-word; } code { font-size: 92%; }
td.missed { color: #fff; background: #a50f15; font-weight: 600; } td.not { color: #7f4f00; }
figure { margin: 2rem 0; } figure img { max-width: 100%; height: auto; } figcaption { color: #444; }
pre { background: #f6f6f6; padding: .8rem; white-space: pre-wrap; }
pre div { padding-left: 2em; text-indent: -2em; }
pre span { display: inline-block; text-indent: 0; max-width: 100%; overflow-wrap: anywhere; }
.printed { table-layout: fixed; } .printed th { box-sizing: border-box; width: 10%; }
.printed th:nth-child(1) { width: 7.5%; } .printed th:nth-child(2) { width: 20%; }
.printed th:nth-child(4) { width: 20%; } .printed th:nth-child(6) { width: 10.5%; }
.printed th:nth-child(7) { width: 22%; }
@media (max-width: 800px) {
  thead { display: none; }
  table, tbody, tr, td { display: block; }
  tr { border-bottom: 2px solid #b0b0b0; padding: .5rem 0; }
  td { border: 0; padding: .1rem .4rem .1rem 9rem; overflow-wrap: anywhere; min-height: 1.5em;
    position: relative; }
  td::before { content: attr(data-head); position: absolute; left: .4rem; color: #666; }
  .printed td, .ours td { padding-left: 5.2rem; }
  figure { margin: 2rem 0; overflow-x: auto; } figure img { max-width: none; width: 44rem; }
  figcaption { position: sticky; left: 0; }
  td:empty { display: none; }
}
"""


def write_picture(paper: str, picture: Picture, folder: Path) -> str:
    """Write figures/PAPER-STEM.png and .svg, and return the panels for the page.

    Raises ConfigError naming the file that cannot be written.
    """
    figures.save(picture.figure, folder / "figures", f"{paper}-{picture.stem}")
    return picture.panels


def write_page(page: Page, folder: Path, panels: Mapping[str, str] | None = None) -> list[Path]:
    """Write NAME.md, NAME.html and figures/NAME-*.png and .svg, and return the paths.

    With the `panels` of all pictures by stem, these have been written before. Raises ConfigError naming the
    file that cannot be written.
    """
    if panels is None:
        panels = {picture.stem: write_picture(page.name, picture, folder) for picture in page.pictures}
    beside = folder / "figures"
    written = [beside / f"{page.name}-{stem}.{kind}" for stem in panels for kind in ("png", "svg")]
    for suffix, text in ((".md", _markdown(page)), (".html", _html(page, panels, beside))):
        path = folder / f"{page.name}{suffix}"
        write_text(path, visible(text))
        written.append(path)
    return written


def write_index(pages: Sequence[Page], folder: Path) -> list[Path]:
    """Write README.md and index.html, the counts of each paper and of all, and return the paths.

    Raises ConfigError naming the file that cannot be written.
    """
    verdicts = [row.verdict for page in pages for row in page.rows]
    total = f"{sentence(verdicts)}; {missed(pages)}."
    head = ("system", "paper", *VERDICTS, MISSED)
    counts = [_counts(page) for page in pages]
    rows = [
        (f"[{page.name}]({page.name}.md)", page.source, *each)
        for page, each in zip(pages, counts, strict=True)
    ]
    means = [f"- *{verdict}*: {about}" for verdict, about in about_verdicts().items()]
    lines = ["# Reproduced papers", "", total, "", *markdown_table(head, rows), "", *means]
    texts = {"README.md": "\n".join(lines) + "\n", "index.html": _index(pages, total, head, counts)}
    for name, text in texts.items():
        write_text(folder / name, visible(text))
    return [folder / name for name in texts]


def missed(pages: Sequence[Page]) -> str:
    """Return the names of what is missed, in words, or "missed: none"."""
    names = [f"{page.name}: {row.what}" for page in pages for row in page.missed]
    return f"missed: {'; '.join(names) if names else 'none'}"


def _counts(page: Page) -> tuple[str, ...]:
    """Return the numbers below the verdicts and "missed"."""
    each = counted(row.verdict for row in page.rows).values()
    return (*map(str, each), str(len(page.missed)))


def _cells(row: Row, head: Sequence[str], mark: str = "") -> list[str]:
    """Return the cells of a row below a head, the verdict between two marks."""
    texts = vars(row) | {"to reach": row.reach, "verdict": f"{mark}{row.verdict}{mark}"}
    return [texts[name] for name in head]


def _with_link(page: Page, row: Row) -> Row:
    """Return a row whose value leads to its picture, in Markdown."""
    if not row.picture:
        return row
    link = f"[{row.obtained}](figures/{page.name}-{row.picture}.png)"
    return dataclasses.replace(row, obtained=link)


def _markdown(page: Page) -> str:
    lines = [f"# {page.title}", "", page.source, "", page.about, ""]
    lines += [f"{_summary(page)}.", "", "```sh", *page.commands, "```", ""]
    lines += markdown_table(_HEAD, [_cells(_with_link(page, row), _HEAD, "**") for row in page.rows])
    lines += ["", f"## {_PICTURES}"] if page.pictures else []
    for picture in page.pictures:
        lines += [
            "",
            f"![{picture.caption}](figures/{page.name}-{picture.stem}.png)",
            "",
            f"*{picture.caption}*",
        ]
    if page.own:
        lines += ["", f"## {_OWN}", "", _ABOUT_OWN, ""]
        lines += markdown_table(_OWN_HEAD, [_cells(row, _OWN_HEAD, "**") for row in page.own])
    return "\n".join(lines) + "\n"


def _summary(page: Page) -> str:
    return f"{sentence(row.verdict for row in page.rows)}; {missed([page])}"


def _html(page: Page, panels: Mapping[str, str], beside: Path) -> str:
    """Return the page; the images are in the folder `beside`."""
    e = html.escape
    pictures = "\n".join(_figure(page, p, panels[p.stem], beside) for p in page.pictures)
    own = f"<h2>{_OWN}</h2>\n<p>{e(_ABOUT_OWN)}</p>\n{_table(_OWN_HEAD, page.own)}" if page.own else ""
    return _document(
        page.title,
        f"""<h1>{e(page.title)}</h1>
<p><em>{e(page.source)}</em></p>
<p>{e(page.about)}</p>
<p>{e(_summary(page))}.</p>
<pre>{_commands(page.commands)}</pre>
{_table(_HEAD, page.rows)}
{f"<h2>{_PICTURES}</h2>" if pictures else ""}
{pictures}
{own}""",
    )


def _figure(page: Page, picture: Picture, panels: str, beside: Path) -> str:
    """Return a picture with its caption: its panels, to zoom into, or else the image itself."""
    caption = html.escape(picture.caption)
    if panels:
        link = f'<a href="figures/{page.name}-{picture.stem}.png">as a picture</a>'
        shown, caption = panels, f"{caption} ({link})"
    else:
        data = base64.b64encode((beside / f"{page.name}-{picture.stem}.png").read_bytes()).decode()
        shown = f'<img alt="{caption}" src="data:image/png;base64,{data}">'
    caption = f"<figcaption>{caption}</figcaption>"
    inside = f"{caption}{shown}" if panels else f"{shown}{caption}"  # a picture is seen at a glance
    return f'<figure id="{html.escape(picture.stem)}">{inside}</figure>'


def _commands(commands: Sequence[str]) -> str:
    """Return the HTML of commands, a line each, that wrap between their words and nowhere else."""
    lines = (" ".join(f"<span>{html.escape(word)}</span>" for word in line.split()) for line in commands)
    return "".join(f"<div>{line}</div>" for line in lines)


def _index(pages: Sequence[Page], total: str, head: Sequence[str], counts: Sequence[Sequence[str]]) -> str:
    e = html.escape
    rows = [
        [f'<a href="{e(page.name)}.html">{e(page.name)}</a>', e(page.source), *each]
        for page, each in zip(pages, counts, strict=True)
    ]
    body = "\n".join(_line([(name, cell, "") for name, cell in zip(head, row, strict=True)]) for row in rows)
    means = "".join(f"<li><em>{e(name)}</em>: {e(about)}</li>" for name, about in about_verdicts().items())
    title = "Reproduced papers"
    return _document(title, f"<h1>{title}</h1>\n<p>{e(total)}</p>\n{_framed(head, body)}\n<ul>{means}</ul>")


def _table(head: Sequence[str], rows: Sequence[Row]) -> str:
    """Return a table whose cells know their heads, so that they can stand below each other on a phone."""
    lines = [
        _line(
            [
                (name, _cell(row, name, cell), row.verdict.split()[0] if name == "verdict" else "")
                for name, cell in zip(head, _cells(row, head), strict=True)
            ]
        )
        for row in rows
    ]
    return _framed(head, "\n".join(lines), "printed" if head == _HEAD else "ours")


def _cell(row: Row, name: str, text: str) -> str:
    """Return the HTML of a cell: names of code as such, the value of a figure as a link to its picture.

    A matrix is folded; a long name may break behind its dots, underscores and slashes.
    """
    if name == "printed" and text.startswith("[") and ";" in text:
        return _matrix(text)
    made = _LONG.sub(lambda found: re.sub(r"([._/])(?=\w)", r"\1\0", found[0]), text)
    made = html.escape(made).replace("\0", "<wbr>")
    made = re.sub(r"`([^`]*)`", r"<code>\1</code>", made)
    return f'<a href="#{html.escape(row.picture)}">{made}</a>' if row.picture and name == "obtained" else made


def _matrix(text: str) -> str:
    """Return a matrix, "[a b; c d]" with a unit or none, as HTML that opens to its rows."""
    inside, _, unit = text.removeprefix("[").partition("]")
    rows = inside.split("; ")
    size = f"{len(rows)} by {len(rows[0].split())} matrix{unit}"
    lines = "<br>".join(html.escape(row) for row in rows)
    return f'<details><summary>{html.escape(size)}</summary><span class="matrix">{lines}</span></details>'


def _line(cells: Sequence[tuple[str, str, str]]) -> str:
    """Return a row of cells, each with its head, its HTML and its class."""
    made = (
        f'<td data-head="{name}"{f" class={kind!r}" if kind else ""}>{cell}</td>'
        for name, cell, kind in cells
    )
    return f"<tr>{''.join(made)}</tr>"


def _framed(head: Sequence[str], body: str, kind: str = "") -> str:
    names = "".join(f"<th>{name}</th>" for name in head)
    begin = f"<table class={kind!r}>" if kind else "<table>"
    return f"{begin}<thead><tr>{names}</tr></thead><tbody>\n{body}\n</tbody></table>"


def _document(title: str, body: str) -> str:
    """Return a page; one with panels has what they need, and like them nothing from the network."""
    has_panels = 'class="charts"' in body
    head, scripts = (policy() + styles(), panel_scripts()) if has_panels else ("", "")
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">{head}<title>{html.escape(title)}</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><style>{_STYLE}</style></head><body>
{body}
{scripts}</body></html>
"""
