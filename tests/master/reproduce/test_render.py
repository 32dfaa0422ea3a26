"""The files of a page: Markdown, HTML, pictures, and the index."""

from __future__ import annotations

import pytest

from evcosim.master.reproduce.page import Page, Row
from evcosim.master.reproduce.printed import sentence
from evcosim.master.reproduce.render import missed, write_index, write_page
from support.browser import browser
from support.pages import data_in


def test_a_page_is_markdown_html_and_pictures(written):
    page, folder = written
    markdown, html = (folder / "lane_keeping.md").read_text(), (folder / "lane_keeping.html").read_text()
    for row in (*page.rows, *page.own):
        assert f"**{row.verdict}**" in markdown
        assert row.what in markdown
    assert sentence(row.verdict for row in page.rows) in markdown
    panels = html.count('<section class="charts">')
    assert html.count("data:image/png;base64,") + panels == len(page.pictures)
    assert panels >= len([picture for picture in page.pictures if picture.panels]) > 0
    assert 'src="figures' not in html  # self-contained
    for picture in page.pictures:
        for suffix in (".png", ".svg"):
            assert (folder / "figures" / f"lane_keeping-{picture.stem}{suffix}").stat().st_size > 1000
    assert "[lane_keeping](lane_keeping.md)" in (folder / "README.md").read_text()
    assert '<a href="lane_keeping.html">' in (folder / "index.html").read_text()


def test_the_panels_of_a_page_work_in_a_browser(written):
    """The page forbids itself every script but ours, so that a changed byte of them would show nothing."""
    _, folder = written
    with browser() as found:
        found.open(folder / "lane_keeping.html", 390)
        charts = "[...document.querySelectorAll('section.charts')].map(s => s.charts.panels.length)"
        panels = data_in((folder / "lane_keeping.html").read_text(encoding="utf-8"))
        assert found.run(charts) == [len(data["panels"]) for data in panels]
        assert found.said == []
        assert found.run("document.documentElement.scrollWidth") <= 390
        asked = [address for address in found.asked if not address.startswith("data:")]
        assert asked == [(folder / "lane_keeping.html").as_uri()]


ROWS = (
    Row("(1)", "a | b < c", "1.0", "1 ± 0.1", "1.05", "reproduced"),
    Row("(2)", "x", "1.0", "1 ± 0.1", "2", "missed", "outside what was to be reached"),
    Row("(3)", "k λ*", "9", "", "3", "not reproducible", "two\nlines"),
    Row("Fig. 1", "in `Model` <b>", "drawn", "", "redrawn", "by construction", picture="curve"),
)
OWN = (Row("", "ours", "", "1 ± 0.1", "2", "missed"), Row("", "settling", "", "2", "2", "own"))
MATRIX = Row("§4", "A", "[1 0 0; 0 1 0] m", "", "Model.a_long_name_of_it = 1", "by construction")


@pytest.fixture
def made(tmp_path):
    """Write a page without pictures and an index; return its Markdown, its HTML and both indices."""
    page = Page("mine", "Title & co", "A. Author", "About", ROWS, OWN, (), ("evcosim run scooter",))
    write_page(page, tmp_path)
    write_index([page], tmp_path)
    names = ("mine.md", "mine.html", "README.md", "index.html")
    return tuple((tmp_path / name).read_text(encoding="utf-8") for name in names)


def test_cells_cannot_end_the_table(made):
    markdown, html, *_ = made
    assert r"| (1) | a \| b < c | 1.0 | 1.05 | 1 ± 0.1 | **reproduced** |  |" in markdown
    assert "| (3) | k λ* | 9 | 3 |  | **not reproducible** | two lines |" in markdown
    assert '<td data-head="what">a | b &lt; c</td>' in html
    assert "<title>Title &amp; co</title>" in html


def test_code_and_pictures_in_a_cell(made):
    markdown, html, *_ = made
    assert '<td data-head="what">in <code>Model</code> &lt;b&gt;</td>' in html
    assert '<td data-head="obtained"><a href="#curve">redrawn</a></td>' in html
    assert "| [redrawn](figures/mine-curve.png) |" in markdown


def test_a_matrix_is_folded_and_a_long_name_may_break(tmp_path):
    write_page(Page("mine", "Title", "A. Author", "About", (MATRIX,), (), (), ()), tmp_path)
    markdown, html = ((tmp_path / f"mine.{kind}").read_text(encoding="utf-8") for kind in ("md", "html"))
    matrix = '<summary>2 by 3 matrix m</summary><span class="matrix">1 0 0<br>0 1 0</span>'
    assert matrix in html
    assert "Model.<wbr>a_<wbr>long_<wbr>name_<wbr>of_<wbr>it = 1" in html
    assert "[1 0 0; 0 1 0] m" in markdown
    assert "wbr" not in markdown


def test_a_verdict_has_its_class(made):
    _, html, *_ = made
    assert "<td data-head=\"verdict\" class='missed'>missed</td>" in html
    assert "<td data-head=\"verdict\" class='not'>not reproducible</td>" in html


def test_own_numbers_stand_in_a_table_of_their_own_and_are_not_counted(made):
    markdown, html, index, _ = made
    head, own = markdown.split("## Own numbers")
    assert "| ours | 2 | 1 ± 0.1 | **missed** |  |" in own
    assert "settling" not in head
    assert "<h2>Own numbers</h2>" in html
    assert "3 printed numbers" in index


def test_the_index_counts_each_verdict(made):
    *_, index, html = made
    lines = index.splitlines()
    counts = "| 1 | 0 | 1 | 1 | 2 |"
    assert lines[4] == (
        "| system | paper | reproduced | calibrated | by construction | not reproducible | missed |"
    )
    assert lines[6] == f"| [mine](mine.md) | A. Author {counts}"
    assert lines[2].startswith(sentence(row.verdict for row in ROWS))
    assert lines[2].endswith("missed: mine: x; mine: ours.")
    assert lines[2] in html


def test_nothing_missed_is_said_too():
    assert missed([Page("mine", "t", "s", "a", ROWS[:1], OWN[1:], (), ())]) == "missed: none"


def test_a_page_stacks_its_cells_where_it_is_narrow(made):
    """Heads stand beside their cells there; commands wrap."""
    _, html, *_ = made
    assert "@media (max-width: 800px)" in html
    assert html.count('data-head="obtained"') == len(ROWS) + len(OWN)
    assert "<pre><div><span>evcosim</span> <span>run</span> <span>scooter</span></div></pre>" in html
