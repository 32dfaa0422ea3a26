"""`evcosim compare`: exit code, table, figure and JSON of two results."""

from __future__ import annotations


def test_compare(evcosim, two_runs):
    same = evcosim("compare", "a", "a")
    assert (same.code, same.out.startswith("equal")) == (0, True)
    other = evcosim("compare", "a", "b", "--plot", "both.png")
    assert other.code == 1
    assert "vehicle.speed" in other.out
    assert (two_runs / "both.png").stat().st_size > 10_000
    assert evcosim("compare", "a", "b", "--tolerance", "1e9").code == 0
    data = evcosim("compare", "a", "b", "--json").json
    assert data["equal"] is False
    assert evcosim("compare", "a", "b", "--tolerance", "-1").code == 2


def test_a_page_of_two_runs(evcosim, two_runs):
    said = evcosim("compare", "a", "b", "--plot", "both.html")
    assert said.code == 1 and said.out == evcosim("compare", "a", "b").out
    page = (two_runs / "both.html").read_text(encoding="utf-8")
    assert "<title>a and b</title>" in page and "What differs in how they were made" in page
    assert evcosim("compare", "a", "b", "--signals", "vehicle.speed", "--plot", "one.HTML").code == 1
    assert "vehicle.speed: difference" in (two_runs / "one.HTML").read_text(encoding="utf-8")
