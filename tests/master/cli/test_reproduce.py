"""`evcosim reproduce`: exit code and message."""

from __future__ import annotations

import dataclasses

import jsonschema
import pytest

from evcosim.master.cli.json_schemas import schema_of
from evcosim.master.reproduce import papers
from evcosim.master.reproduce.page import Page, Row
from evcosim.master.reproduce.printed import VERDICTS, sentence
from support.answers import refused


def page_of(verdict):
    row = Row("(1)", "x", "1.0", "1 ± 0.1", "1.05", verdict)
    own = Row("", "y", "", "2", "2", "own")
    return Page("lane_keeping", "Lane keeping", "a paper", "about", (row,), (own,), (), ())


def test_the_command_fails_when_a_number_is_missed(evcosim, monkeypatch):
    for verdict, code, text in (("missed", 1, "missed: lane_keeping: x"), ("reproduced", 0, "missed: none")):
        page = page_of(verdict)
        monkeypatch.setattr(papers, "reproduce", lambda *_, page=page: [page])
        answer = evcosim("reproduce", "lane_keeping", "-o", "pages")
        assert answer.code == code
        assert " ".join(answer.out.split()).endswith(text)


def test_the_last_line_counts_as_the_index_does(evcosim, monkeypatch):
    monkeypatch.setattr(papers, "reproduce", lambda *_: [page_of("calibrated")] * 2)
    said = evcosim("reproduce", "lane_keeping", "-o", "pages").out
    assert " ".join(said.split()).endswith(f"figures/ {sentence(['calibrated'] * 2)}; missed: none")
    assert max(map(len, said.splitlines())) <= 100  # the width of the tests' terminal


def test_a_full_disk_hides_no_number(evcosim, monkeypatch):
    def full(*_):
        raise papers.UnwrittenError("pages/x.html: cannot be written: full", [page_of("reproduced")])

    monkeypatch.setattr(papers, "reproduce", full)
    answer = evcosim("reproduce", "lane_keeping", "-o", "pages")
    assert (answer.code, answer.err) == (1, "evcosim: pages/x.html: cannot be written: full\n")
    assert "missed: none" in answer.out
    assert "in pages" not in answer.out


def test_a_line_for_each_paper_tells_that_it_lives(evcosim, monkeypatch):
    """On stderr, when the last run of the paper has ended; with --json stderr is for messages alone."""

    def runs(names, _folder, _workers, progress, _units):
        left = [f"{name}: {task.name}" for name in names for task in papers.load(name).runs()]
        for i, task in enumerate(left):
            progress(i + 1, len(left), task)
        return [page_of("reproduced")]

    monkeypatch.setattr(papers, "reproduce", runs)
    answer = evcosim("reproduce", "braking", "scooter", "-o", "pages")
    said = [line.partition(" after")[0] for line in answer.err.splitlines()]
    assert said == [f"evcosim: {paper}: all runs have ended," for paper in ("braking", "scooter")]
    assert evcosim("reproduce", "braking", "--json", "-o", "pages").err == ""


def test_an_unknown_paper(evcosim, tmp_path):
    refused(evcosim("reproduce", "scoter", "-o", "pages"), "no paper 'scoter' (did you mean 'scooter'?)")
    assert not (tmp_path / "pages").exists()


@pytest.mark.parametrize("verdict", [*VERDICTS, "missed"])
def test_what_is_printed_as_json_is_what_its_schema_says(evcosim, monkeypatch, verdict):
    page = page_of(verdict)
    others = [dataclasses.replace(page, name=name) for name in ("scooter", "braking", "multi_drive")]
    monkeypatch.setattr(papers, "reproduce", lambda *_: [page, *others])
    printed = evcosim("reproduce", "--json").json
    assert list(printed) == ["lane_keeping", "scooter", "braking", "multi_drive"]
    schema = jsonschema.Draft202012Validator(schema_of("reproduce"))
    schema.validate(printed)
    (row,) = printed["lane_keeping"]["rows"]
    del row["verdict"]
    assert not schema.is_valid(printed)


def test_the_tables_as_json(evcosim, monkeypatch):
    monkeypatch.setattr(papers, "reproduce", lambda *_: [page_of("reproduced")])
    data = evcosim("reproduce", "lane_keeping", "--json").json["lane_keeping"]
    assert data["missed"] == 0
    assert data["rows"][0]["verdict"] == "reproduced"
    assert data["own"][0]["what"] == "y"
    assert data["counts"]["reproduced"] == 1
