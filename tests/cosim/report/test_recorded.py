"""The rows of a run in a page: all of them, or the extremes of stretches, which it says."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.report import recorded as module
from evcosim.cosim.report.columns import Columns
from evcosim.cosim.report.recorded import recorded, stretch
from evcosim.cosim.results import results as results_module
from evcosim.cosim.results.results import Results, ResultVariable
from support.pages import small_run, times_of, unpacked


def points(results, drawn=()):
    page = Columns()
    found = recorded(results, drawn, page)
    data = page.as_data()

    def of(name):
        column = data["columns"][found.columns[name]]
        return times_of(data["grids"][column["grid"]]), unpacked(column)

    return found, of


def test_every_row_of_a_short_run():
    run = small_run()
    found, of = points(run, ["car.speed"])
    assert found.said == "401 rows: every signal in full resolution"
    assert set(found.columns) == {*run.names, *run.texts}
    for name in run.names:
        times, values = of(name)
        np.testing.assert_array_equal(times, run.time)
        np.testing.assert_allclose(values, run.column(name), atol=1e-6)


def test_texts_and_flags_have_numbers_with_names():
    found, of = points(small_run())
    assert found.items["ecu.ready"] == ((0, "false"), (1, "true"))
    assert found.items["ecu.state"][2] == (5, "failed")
    names = dict(found.items["ecu.mode"])
    assert [names[code] for code in (of("ecu.mode")[1][0], of("ecu.mode")[1][-1])] == ["warm-up", "</script>"]


@pytest.fixture
def few(monkeypatch):
    """Few rows are many here, and a piece has fewer than a run."""
    monkeypatch.setattr(module, "FULL_ROWS", 1000)
    monkeypatch.setattr(module, "_OF_FIGURE", 200)
    monkeypatch.setattr(module, "_LEAST", 50)
    monkeypatch.setattr(module, "PIECE", 256)
    monkeypatch.setattr(results_module, "PIECE", 256)


@pytest.mark.parametrize("count", [1001, 1003, 1020, 4999])
def test_a_long_run_keeps_its_spikes_its_ends_and_their_order(few, count):
    time = np.arange(count) * 0.01
    values = np.sin(time)
    values[count // 3], values[-2] = 9.0, -9.0
    run = Results(time, np.column_stack([values, time]), [ResultVariable("a.x"), ResultVariable("a.t")])
    found, of = points(run, ["a.x"])
    at, kept = of("a.x")
    assert len(at) < 300 and found.said.startswith(
        f"{count:,} rows: the figure's signals as the extremes of each"
    )
    assert (kept.max(), kept.min()) == (9.0, -9.0)
    assert (at[0], at[-1], kept[0]) == (time[0], time[-1], values[0])
    assert kept[-1] == pytest.approx(values[-1], abs=1e-6)
    assert np.all(np.diff(at) > 0.0)
    width = stretch(count, 200)
    spike = at[np.argmax(kept)]
    assert abs(spike - time[count // 3]) <= 0.01 * width
    assert np.all(np.diff(of("a.t")[1]) >= 0.0)  # a rising line rises


def test_a_gap_of_a_long_run_counts_only_where_there_is_nothing_else(few):
    values = np.arange(3000.0)
    values[700] = np.nan
    values[1500:1800] = np.inf
    run = Results(np.arange(3000) * 0.01, values[:, None], [ResultVariable("a.x")])
    at, kept = points(run, ["a.x"])[1]("a.x")
    width = 0.01 * stretch(3000, 200)
    assert np.all((at[np.isnan(kept)] > 15.0 - width) & (at[np.isnan(kept)] < 18.0 + width))
    assert np.isnan(kept).any()


def test_many_signals_of_a_run_are_thinned_before_those_of_the_figure(few, monkeypatch):
    monkeypatch.setattr(module, "MOST", 5000)
    run = small_run(900)
    found, of = points(run, ["car.speed"])
    assert len(of("car.speed")[0]) == 900
    assert 0 < len(of("car.wind")[0]) < 900
    assert "the figure's signals in full resolution, the others as the extremes of each" in found.said
    assert len(of("ecu.mode")[0]) < 900


def test_more_texts_than_can_be_told_apart(monkeypatch):
    monkeypatch.setattr(module, "_TEXTS", 1)
    found, of = points(small_run())
    assert dict(found.items["ecu.mode"]) == {0: "warm-up", 1: "(another text)"}
    assert set(of("ecu.mode")[1]) == {0.0, 1.0}
