"""`evcosim compare`: exit code, table, figure and JSON of two results."""

from __future__ import annotations

from evcosim.cosim.results.results import Results


def test_compare(evcosim, two_runs):
    same = evcosim("compare", "a", "a")
    assert (same.code, same.out.startswith("equal")) == (0, True)
    other = evcosim("compare", "a", "b", "--plot", "both.png")
    assert other.code == 1
    assert "vehicle.speed" in other.out
    assert (two_runs / "both.png").stat().st_size > 10_000
    in_range = evcosim("compare", "a", "b", "--tolerance", "1e9")
    assert in_range.code == 0
    assert "metric " in other.out and not any("metric " in answer.out for answer in (same, in_range))
    line = next(line for line in other.out.splitlines() if line.startswith("mean speed "))
    said = [Results.read(name).manifest["metrics"]["mean speed"]["value"] for name in ("a", "b")]
    assert line.split()[2::2] == [f"{value:.6g}" for value in said]
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
