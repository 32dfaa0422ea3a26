"""The papers, how they are loaded, and how a run that fails is named."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli import main
from evcosim.master.reproduce import papers
from evcosim.master.studies.parallel import TaskError


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
