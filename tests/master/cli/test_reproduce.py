"""`evcosim reproduce`: exit code and message."""

from __future__ import annotations

from evcosim.master.reproduce import papers
from evcosim.master.reproduce.page import Page, near
from support.answers import refused


def page_of(*rows):
    return Page("lane_keeping", "Lane keeping", "a paper", "about", rows, (), ())


def test_the_command_fails_when_a_number_is_missed(evcosim, monkeypatch):
    for obtained, code, text in ((1.2, 1, "missed: lane_keeping: x"), (1.05, 0, "missed: none")):
        page = page_of(near("x", "1.0", obtained, 1.0, 0.1))
        monkeypatch.setattr(papers, "reproduce", lambda *_, page=page: [page])
        answer = evcosim("reproduce", "lane_keeping", "-o", "pages")
        assert answer.code == code
        assert text in answer.out


def test_an_unknown_paper(evcosim, tmp_path):
    refused(evcosim("reproduce", "scoter", "-o", "pages"), "no paper 'scoter' (did you mean 'scooter'?)")
    assert not (tmp_path / "pages").exists()


def test_the_tables_as_json(evcosim, monkeypatch):
    monkeypatch.setattr(papers, "reproduce", lambda *_: [page_of(near("x", "1.0", 1.05, 1.0, 0.1))])
    data = evcosim("reproduce", "lane_keeping", "--json").json["lane_keeping"]
    assert data["missed"] == 0
    assert data["rows"][0]["verdict"] == "reproduced"
