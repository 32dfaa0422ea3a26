"""Pages of papers: verdicts, what is written, what the command answers; lane keeping is the real one."""

from __future__ import annotations

import dataclasses
import math

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli import main
from evcosim.master.reproduce import papers
from evcosim.master.reproduce.page import at_least, at_most, holds, near, not_reproducible
from evcosim.master.reproduce.scooter_numbers import linearized
from evcosim.master.studies.parallel import TaskError


@pytest.mark.parametrize(
    ("row", "verdict"),
    [
        (near("x", "1.0", 1.05, 1.0, 0.1), "reproduced"),
        (near("x", "1.0", 1.05, 1.0, 0.1, calibrated="k chosen"), "calibrated"),
        (near("x", "-", 1.05, 1.0, 0.1), "reached"),
        (near("x", "1.0", 1.2, 1.0, 0.1, calibrated="k chosen"), "missed"),
        (near("x", "-", math.nan, 1.0, 0.1), "missed"),
        (at_most("x", "2", 2.0, 2.0), "reproduced"),
        (at_most("x", "2", 2.1, 2.0), "missed"),
        (at_least("x", "2", 2.0, 2.0), "reproduced"),
        (at_least("x", "2", 1.9, 2.0), "missed"),
        (holds("x", "yes", "yes", "yes", True), "reproduced"),
        (holds("x", "yes", "yes", "no", False), "missed"),
        (not_reproducible("x", "9", "3", "because"), "not reproducible"),
    ],
)
def test_verdicts(row, verdict):
    assert row.verdict == verdict
    assert (row.reason == "") == (verdict in ("reproduced", "reached"))


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    return papers.reproduce(["lane_keeping"], folder), folder


def test_lane_keeping_misses_nothing(written):
    (page,), _ = written
    assert page.missed == ()
    assert [row.what for row in page.rows if row.verdict == "not reproducible"] == ["K-hat"]
    assert {picture.stem for picture in page.pictures} == {"fig7", "fig8", "fig9", "delay"}


def test_a_page_is_markdown_html_and_pictures(written):
    (page,), folder = written
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


def test_a_run_that_fails_is_named(tmp_path, monkeypatch):
    paper = papers.load("lane_keeping")
    broken = dataclasses.replace(paper.runs()[0], function=float, arguments=("no road",), keywords={})
    monkeypatch.setattr(papers, "load", lambda name: dataclasses.replace(paper, runs=lambda: (broken,)))
    with pytest.raises(TaskError, match=r"lane_keeping: bus: .*no road"):
        papers.reproduce(["lane_keeping"], tmp_path)


def test_an_unknown_paper_is_said_before_anything_runs(capsys, tmp_path):
    with pytest.raises(ConfigError, match=r"no paper 'scoter' \(did you mean 'scooter'\?\)"):
        papers.load("scoter")
    assert main(["reproduce", "scoter", "-o", str(tmp_path / "pages")]) == 2
    assert not (tmp_path / "pages").exists()
    assert "did you mean 'scooter'?" in capsys.readouterr().err


def test_the_command_fails_when_a_number_is_missed(monkeypatch, written, tmp_path, capsys):
    (page,), _ = written
    missed = near("x", "1.0", 1.2, 1.0, 0.1)
    for rows, code in (((missed,), 1), (page.rows, 0)):
        answer = [dataclasses.replace(page, rows=rows)]
        monkeypatch.setattr(papers, "reproduce", lambda *_, answer=answer: answer)
        assert main(["reproduce", "lane_keeping", "-o", str(tmp_path)]) == code
    assert "missed: lane_keeping: x" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("speed", "pole"),
    [(25.0, 0.0411), (30.0, 0.0300), (35.0, 0.0253), (40.0, 0.0228), (45.0, 0.0214), (49.0, 0.0206)],
)
def test_the_scooters_linearization(speed, pole):
    gain, found = linearized(speed)
    assert gain == pytest.approx(0.46, rel=1e-3)
    assert found == pytest.approx(pole, abs=5e-5)
