"""The figure of a bus budget: readable whatever the values are."""

from __future__ import annotations

import dataclasses
import math

import pytest

from evcosim.cosim.figures.bus_budget import draw_budget
from evcosim.cosim.figures.saving import save
from support.judged_budget import judged


@pytest.mark.parametrize("kind", ["max", "min"])
@pytest.mark.parametrize(
    "values",
    [[1.0, 1.1, 1.2, math.nan, 1e9], [math.nan] * 5, [1.5] * 5, [-1e12, 0.0, 1.4, 1.6, 3.0]],
    ids=["failed and far", "nothing", "flat", "both sides"],
)
def test_figure(values, kind):
    figure = draw_budget(judged(values, kind))
    figure.draw_without_rendering()
    low, high = figure.axes[0].get_ylim()
    assert low < 1.5 < high
    assert high - low < 20.0  # what diverged does not squeeze the rest


def test_five_panels_stand_in_two_rows_and_each_seed_is_a_dash():
    (one,) = judged([1.0, 1.1, 1.2, 1.3, 1.4]).series
    point = dataclasses.replace(one.points[0], values=(0.95, 0.97, 1.0), quantile=0.97)
    many = dataclasses.replace(one, points=(point, *one.points[1:]))
    found = dataclasses.replace(judged([1.0] * 5), series=(many, one, one, one, one))
    figure = draw_budget(found)
    figure.draw_without_rendering()
    tops = [round(axes.get_position().y1, 3) for axes in figure.axes]
    assert len(tops) == 6 and len(set(tops)) == 2
    dashes = [line for line in figure.axes[0].get_lines() if line.get_marker() == "_"]
    assert sorted(y for line in dashes for y in line.get_ydata()) == [0.95, 0.97, 1.0]
    assert [text.get_text() for text in figure.legends[0].get_texts()].count("each seed") == 1


def test_same_figure_same_bytes(tmp_path):
    found = judged([1.0, 1.1, 1.2, math.nan, 1e9])
    first, again = ([p.read_bytes() for p in save(draw_budget(found), tmp_path, "budget")] for _ in range(2))
    assert first == again


def test_a_broken_point_is_a_cross_and_one_without_a_value_is_at_the_edge():
    figure = draw_budget(judged([1.0, 1.1, 1.6, math.nan, 1e9]))
    axes = figure.axes[0]
    points = {
        line.get_xdata()[0]: line
        for line in axes.get_lines()
        if line.get_marker() in "oXv^" and line.get_markersize() == 8.0
    }
    assert "".join(points[i].get_marker() for i in range(5)) == "ooX^^"
    low, high = axes.get_ylim()
    assert [points[i].get_ydata()[0] for i in range(3)] == [1.0, 1.1, 1.6]
    assert all(low < points[i].get_ydata()[0] < high for i in range(5))
    texts = {text.get_text() for text in axes.texts}
    assert {"1", "1.1", "1.6", "no value", "1e+09"} == texts


def test_a_failed_run_is_marked_and_named():
    axes = draw_budget(judged([1.0, 1.1, 1.6, math.nan, math.nan], failed=(4,))).axes[0]
    markers = {
        line.get_xdata()[0]: line.get_marker() for line in axes.get_lines() if line.get_markersize() == 8.0
    }
    assert (markers[3], markers[4]) == ("^", "s")
    assert [text.get_text() for text in axes.texts][3:] == ["no value", "failed"]
