"""`evcosim plot` draws results again."""

from __future__ import annotations

from support.pages import data_in


def test_plot(evcosim, two_runs):
    assert evcosim("plot", "a").out.strip() == "a/figure.png"
    assert (two_runs / "a" / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert evcosim("plot", "a/results.csv", "-o", "own.svg", "--signals", "vehicle.*").code == 0
    svg = (two_runs / "own.svg").read_text(encoding="utf-8")
    assert "<svg" in svg
    nothing = evcosim("plot", "a", "--signals", "vehicle.sped")
    assert (nothing.code, "did you mean 'vehicle.speed'" in nothing.err) == (2, True)
    assert "did you mean 'vehicle.*'" in evcosim("plot", "a", "--signals", "vehcle.*").err
    assert evcosim("plot", "a", "-o", "figure.txt").code == 2


def test_a_page_again(evcosim, two_runs):
    assert evcosim("plot", "a", "-o", "again.html").out.strip() == "again.html"
    assert (two_runs / "again.html").read_bytes() == (two_runs / "a" / "report.html").read_bytes()
    assert evcosim("plot", "a", "--signals", "vehicle.*", "-o", "some.html").code == 0
    (data,) = data_in((two_runs / "some.html").read_text(encoding="utf-8"))
    assert {signal["title"].partition(".")[0] for signal in data["signals"]} == {"vehicle"}


def test_plot_of_a_system_that_is_gone(evcosim, system, tmp_path):
    path = system({"cart": "Fragile"}, stop_time=1.0)
    assert evcosim("run", path, "--no-plot", "-q", "-o", "out").code == 0
    path.unlink()
    assert evcosim("plot", "out").code == 0


def test_numbers_that_can_be_read_two_ways_are_warned_of(evcosim, tmp_path):
    (tmp_path / "a.csv").write_text("time;x\n0;1.500\n1;2.500\n")
    answer = evcosim("plot", tmp_path / "a.csv", "-o", tmp_path / "a.html")
    assert answer.code == 0 and "warning: " in answer.err and "'1.500' is read as 1.5" in answer.err
