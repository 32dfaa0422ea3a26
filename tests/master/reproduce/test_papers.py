"""The papers, how they are loaded, and how a run that fails is named."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli import main
from evcosim.master.reproduce import papers
from evcosim.master.reproduce.page import Page
from evcosim.master.reproduce.render import write_index, write_page
from evcosim.master.studies.parallel import TaskError


def test_the_number_of_runs_of_each_paper():
    assert papers.counts(["braking"]) == {"braking": len(papers.load("braking").runs())}


def test_a_run_that_fails_is_named(tmp_path, monkeypatch):
    paper = papers.load("lane_keeping")
    broken = dataclasses.replace(paper.runs()[0], function=float, arguments=("no road",), keywords={})
    monkeypatch.setattr(papers, "load", lambda name: dataclasses.replace(paper, runs=lambda: (broken,)))
    with pytest.raises(TaskError, match=r"lane_keeping: bus: .*no road"):
        papers.reproduce(["lane_keeping"], tmp_path)


def test_pages_that_cannot_be_written_are_returned_with_the_error(tmp_path, monkeypatch):
    """The runs of the papers take minutes."""
    made = Page("lane_keeping", "Lane keeping", "a paper", "about", (), (), (), ())
    paper = dataclasses.replace(papers.load("lane_keeping"), runs=tuple, page=lambda results: made)
    monkeypatch.setattr(papers, "load", lambda name: paper)
    (tmp_path / "lane_keeping.md").mkdir()
    with pytest.raises(papers.UnwrittenError, match=r"lane_keeping.md: cannot be written: .*") as caught:
        papers.reproduce(["lane_keeping"], tmp_path)
    assert caught.value.pages == [made]
    assert (tmp_path / "index.html").exists()


def test_an_unknown_paper_is_said_before_anything_runs(capsys, tmp_path):
    with pytest.raises(ConfigError, match=r"no paper 'scoter' \(did you mean 'scooter'\?\)"):
        papers.load("scoter")
    assert main(["reproduce", "scoter", "-o", str(tmp_path / "pages")]) == 2
    assert not (tmp_path / "pages").exists()
    assert "did you mean 'scooter'?" in capsys.readouterr().err


def files_in(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_what_workers_draw_is_what_this_process_draws(written, tmp_path):
    _, folder = written
    paper = papers.load("lane_keeping")
    page = paper.page({task.name: task() for task in paper.runs()})
    assert not [picture for picture in page.pictures if "figure" in vars(picture)]  # none was drawn yet
    write_page(page, tmp_path)
    write_index([page], tmp_path)
    assert files_in(tmp_path) == files_in(folder)


@pytest.fixture
def short(monkeypatch):
    """The paper of lane keeping, with two of its pictures, and what its runs return."""
    paper = papers.load("lane_keeping")
    monkeypatch.setattr(papers, "load", lambda name: paper)
    page = Page("lane_keeping", "Lane keeping", "a paper", "about", (), (), (), ())

    def shortened(found):
        return dataclasses.replace(page, pictures=tuple(paper.pictures(found))[:2])

    return dataclasses.replace(paper, page=shortened)


def test_pictures_that_cannot_be_written(short, monkeypatch, tmp_path):
    monkeypatch.setattr(papers, "load", lambda name: short)
    (tmp_path / "figures").write_text("in the way")
    with pytest.raises(papers.UnwrittenError, match=r"figures.*: cannot be written") as caught:
        papers.reproduce(["lane_keeping"], tmp_path)
    assert [page.name for page in caught.value.pages] == ["lane_keeping"]
    assert not (tmp_path / "lane_keeping.html").exists()


def test_a_page_is_there_when_its_pictures_are_and_progress_is_told(short, monkeypatch, tmp_path):
    """Also where a run of another paper fails: what was done before stays."""
    broken = dataclasses.replace(short.runs()[0], function=float, arguments=("no road",), keywords={})
    other = dataclasses.replace(papers.load("braking"), name="braking", runs=lambda: (broken,))
    both = {"lane_keeping": short, "braking": other}
    monkeypatch.setattr(papers, "load", both.__getitem__)
    said = []
    with pytest.raises(TaskError, match=r"braking: bus: .*no road"):
        papers.reproduce(list(both), tmp_path, 1, lambda *each: said.append(each))
    assert (tmp_path / "lane_keeping.html").exists()
    count = len(short.runs()) + 1 + 2
    assert [done for done, _, _ in said] == list(range(1, count + 1))
    shares = [done / total for done, total, _ in said]
    assert shares == sorted(shares)
    assert said[-1][2].startswith("lane_keeping: picture ")
