"""The files of pages: Markdown with the pictures beside it, and HTML with everything in one file."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from pathlib import Path

from ...cosim.figures import draw as figures
from ...cosim.visible import visible
from ...cosim.writing import markdown_table, write_text
from .page import VERDICTS, Page, PublishedNumber

_HEAD = ("what", "published", "to reach", "obtained", "verdict", "reason")

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1240px; margin: 2rem auto; padding: 0 1rem;
  color: #1a1a1a; }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th, td { border-bottom: 1px solid #d0d0d0; padding: .35rem .6rem; text-align: left; vertical-align: top; }
th { background: #f3f3f3; position: sticky; top: 0; }
td.reproduced { color: #005a32; } td.calibrated, td.reached { color: #08519c; }
td.missed { color: #fff; background: #a50f15; font-weight: 600; } td.not { color: #7f4f00; }
figure { margin: 2rem 0; } figure img { max-width: 100%; height: auto; } figcaption { color: #444; }
pre { background: #f6f6f6; padding: .8rem; overflow-x: auto; }
"""


def write_page(page: Page, folder: Path) -> list[Path]:
    """Write NAME.md, NAME.html and figures/NAME-*.png and .svg, and return the paths.

    Raises ConfigError naming the file that cannot be written.
    """
    written: list[Path] = []
    for picture in page.pictures:
        written += figures.save(picture.figure, folder / "figures", f"{page.name}-{picture.stem}")
    images = {p.stem: written[2 * i] for i, p in enumerate(page.pictures)}
    for suffix, text in ((".md", _markdown(page)), (".html", _html(page, images))):
        path = folder / f"{page.name}{suffix}"
        write_text(path, visible(text))
        written.append(path)
    return written


def write_index(pages: Sequence[Page], folder: Path) -> Path:
    """Write README.md, the papers with the count of each verdict, and return its path. Raises ConfigError."""
    rows = [
        (
            f"[{page.name}]({page.name}.md)",
            page.source,
            *(str(sum(row.verdict == verdict for row in page.rows)) for verdict in VERDICTS),
        )
        for page in pages
    ]
    lines = ["# Reproduced papers", "", *markdown_table(("system", "paper", *VERDICTS), rows)]
    path = folder / "README.md"
    write_text(path, visible("\n".join(lines) + "\n"))
    return path


def _cells(row: PublishedNumber, mark: str = "") -> tuple[str, ...]:
    """Return the cells below _HEAD, the verdict between two marks."""
    return (row.what, row.published, row.reach, row.obtained, f"{mark}{row.verdict}{mark}", row.reason)


def _markdown(page: Page) -> str:
    lines = [f"# {page.title}", "", page.source, "", page.about, ""]
    lines += ["```sh", *page.commands, "```", ""]
    lines += markdown_table(_HEAD, [_cells(row, "**") for row in page.rows])
    for picture in page.pictures:
        lines += [
            "",
            f"![{picture.caption}](figures/{page.name}-{picture.stem}.png)",
            "",
            f"*{picture.caption}*",
        ]
    return "\n".join(lines) + "\n"


def _html(page: Page, images: dict[str, Path]) -> str:
    e = html.escape
    rows = "\n".join(
        "<tr>"
        + "".join(
            f'<td class="{row.verdict.split()[0]}">{e(c)}</td>' if i == 4 else f"<td>{e(c)}</td>"
            for i, c in enumerate(_cells(row))
        )
        + "</tr>"
        for row in page.rows
    )
    pictures = "\n".join(
        f'<figure><img alt="{e(p.caption)}" src="data:image/png;base64,'
        f'{base64.b64encode(images[p.stem].read_bytes()).decode()}"><figcaption>{e(p.caption)}</figcaption></figure>'
        for p in page.pictures
    )
    head = "".join(f"<th>{name}</th>" for name in _HEAD)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{e(page.title)}</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><style>{_STYLE}</style></head><body>
<h1>{e(page.title)}</h1>
<p><em>{e(page.source)}</em></p>
<p>{e(page.about)}</p>
<pre>{e(chr(10).join(page.commands))}</pre>
<table><thead><tr>{head}</tr></thead><tbody>
{rows}
</tbody></table>
{pictures}
</body></html>
"""
