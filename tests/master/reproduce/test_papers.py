"""The papers, how they are loaded, and how a run that fails is named."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli import main
from evcosim.master.reproduce import papers
from evcosim.master.reproduce.page import Page
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
