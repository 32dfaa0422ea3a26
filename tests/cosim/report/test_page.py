"""The page of a run: the order of its parts, equal bytes for equal runs, and no way out of it."""

from __future__ import annotations

import re

import pytest

from evcosim import simulate
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.report.page import report, write_report
from evcosim.cosim.results.results import Results
from support.pages import hostile_run, small_run


def test_equal_runs_make_equal_bytes():
    first, second = (report(simulate("scooter", stop_time=2.0)) for _ in range(2))
    assert first == second


def test_warnings_come_first_then_the_curves(tmp_path):
    write_report(
        tmp_path / "report.html",
        small_run(warnings=["mind this"], system="cart", metrics={"a": {"value": 1.0}}),
    )
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    places = [
        page.index(part) for part in ("mind this", '<section class="charts">', "<h2>Metrics", "run.json")
    ]
    assert places == sorted(places)
    assert "<title>cart</title>" in page


def test_nothing_is_read_from_elsewhere():
    page = report(hostile_run())
    assert "default-src 'none'" in page
    outside = re.sub(r"<script>.*?</script>|<style>.*?</style>|<pre>.*?</pre>", "", page, flags=re.DOTALL)
    assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:|//)", outside)
    assert page.count("<script") == page.count("</script>") == 3


def test_a_failed_run_shows_no_metrics_that_nobody_evaluated():
    run = simulate("scooter", stop_time=1.0)
    assert "<h2>Metrics" in report(run)
    failed = Results(
        run.time, run.data, run.variables, run.manifest | {"error": "x"}, run.figure, run.metric_specs
    )
    assert "<h2>Metrics" not in report(failed)


def test_results_report(tmp_path):
    path = tmp_path / "page.html"
    assert small_run().report(path) == path
    assert path.read_text(encoding="utf-8") == report(small_run())
    with pytest.raises(ConfigError, match="cannot be written"):
        small_run().report(tmp_path)
