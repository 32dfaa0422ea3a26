"""The files of a page: Markdown, HTML, pictures, and the index."""

from __future__ import annotations

import pytest

from evcosim.master.reproduce.page import Page, near, not_reproducible
from evcosim.master.reproduce.render import write_index, write_page


def test_a_page_is_markdown_html_and_pictures(written):
    page, folder = written
    markdown, html = (folder / "lane_keeping.md").read_text(), (folder / "lane_keeping.html").read_text()
    for row in page.rows:
        assert f"**{row.verdict}**" in markdown
        assert row.what in markdown
    assert html.count("data:image/png;base64,") == len(page.pictures)
    assert 'src="figures' not in html  # self-contained
    for picture in page.pictures:
        for suffix in (".png", ".svg"):
            assert (folder / "figures" / f"lane_keeping-{picture.stem}{suffix}").stat().st_size > 1000
    assert "[lane_keeping](lane_keeping.md)" in (folder / "README.md").read_text()


@pytest.fixture
def made(tmp_path):
    """Write a page without pictures and an index; return its Markdown, its HTML and the index."""
    rows = (
        near("a | b < c", "1.0", 1.05, 1.0, 0.1),
        near("missed", "1.0", 2.0, 1.0, 0.1),
        not_reproducible("k λ*", "9", "3", "two\nlines"),
    )
    page = Page("mine", "Title & co", "A. Author", "About", rows, (), ("evcosim run scooter",))
    write_page(page, tmp_path)
    write_index([page], tmp_path)
    return tuple(
        (tmp_path / name).read_text(encoding="utf-8") for name in ("mine.md", "mine.html", "README.md")
    )


def test_cells_cannot_end_the_table(made):
    markdown, html, _ = made
    assert r"| a \| b < c | 1.0 | 1 ± 0.1 | 1.05 | **reproduced** |  |" in markdown
    assert "| k λ* | 9 | - | 3 | **not reproducible** | two lines |" in markdown
    assert "<td>a | b &lt; c</td>" in html
    assert "<title>Title &amp; co</title>" in html


def test_a_verdict_has_its_class(made):
    _, html, _ = made
    assert '<td class="missed">missed</td>' in html
    assert '<td class="not">not reproducible</td>' in html


def test_the_index_counts_each_verdict(made):
    *_, index = made
    lines = index.splitlines()
    assert lines[2] == "| system | paper | reproduced | calibrated | reached | not reproducible | missed |"
    assert lines[4] == "| [mine](mine.md) | A. Author | 1 | 0 | 0 | 1 | 1 |"
