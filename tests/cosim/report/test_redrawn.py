"""Charts over time as panels: their lines, units and ranges; others are left as they are."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.figures.canvas import canvas
from evcosim.cosim.figures.style import COLORS, look
from evcosim.cosim.report.redrawn import redrawn
from support.pages import data_in, times_of, unpacked

T = np.arange(201) * 0.01


def drawn(label="time [s]", columns=1):
    with canvas(2, columns, title="a chart", share_x=True) as (figure, axes):
        for column in range(columns):
            axes[0, column].plot(T, np.sin(T), label="sine", **look(0))
            axes[0, column].plot(T, np.floor(T), label="steps", drawstyle="steps-post", **look(1))
            axes[0, column].axhline(0.5)
            axes[0, column].set_title(f"above{column or ''}")
            axes[1, column].plot(T[:100], T[:100] ** 2)
            axes[1, column].axhline(1.5, label="limit", **look(1))
            axes[1, column].set(xlabel=label, xlim=(0.5, 3.0), ylim=(-1.0, 2.0))
        axes[0, 0].set_ylabel("a\nspeed [m/s]")
        axes[1, 0].set_ylabel("slip [1]")
    return figure


def test_lines_have_their_values_units_strokes_and_names():
    (data,) = data_in(redrawn(drawn()))
    above, below = data["panels"]
    assert (above["title"], above["unit"], above["limits"]) == ("above: a speed", "m/s", None)
    assert (below["title"], below["unit"], below["limits"]) == ("above: slip", "", [-1.0, 2.0])
    sine, steps = above["lines"]
    assert [(line["label"], line["held"]) for line in (sine, steps)] == [("sine", False), ("steps", True)]
    assert (sine["color"], steps["color"], sine["dash"]) == (*COLORS[:2], [])
    assert len(steps["dash"]) == 2
    for line, values in ((sine, np.sin(T)), (steps, np.floor(T)), (below["lines"][0], T[:100] ** 2)):
        column = data["columns"][line["column"]]
        np.testing.assert_allclose(unpacked(column), values, atol=1e-5)
        np.testing.assert_array_equal(times_of(data["grids"][column["grid"]]), T[: len(values)])


def test_the_part_of_the_time_that_the_figure_shows_comes_first():
    (data,) = data_in(redrawn(drawn()))
    assert data["time"] == {"scale": 1.0, "unit": "s", "begin": 0.0, "end": 2.0, "shown": [0.5, 2.0]}


def test_a_curve_needs_no_name_and_a_level_without_one_is_a_mark():
    (data,) = data_in(redrawn(drawn()))
    lines = [line for panel in data["panels"] for line in panel["lines"]]
    assert [line["label"] for line in lines] == ["sine", "steps", "", "limit"]
    column = data["columns"][lines[-1]["column"]]
    assert list(unpacked(column)) == [1.5, 1.5]
    assert list(times_of(data["grids"][column["grid"]])) == [0.0, 2.0]


def test_panels_have_the_title_of_their_column_and_the_label_and_unit_of_their_row():
    panels = data_in(redrawn(drawn(columns=2)))[0]["panels"]
    assert [(panel["title"], panel["unit"]) for panel in panels] == [
        ("above: a speed", "m/s"), ("above1: a speed", "m/s"), ("above: slip", ""), ("above1: slip", ""),
    ]  # fmt: skip # a panel in each


@pytest.mark.parametrize("label", ["time [min]", "speed [m/s]", ""])
def test_what_is_not_over_time_stays_a_picture(label):
    assert redrawn(drawn(label)) == ""


def test_a_chart_without_lines_stays_a_picture():
    with canvas() as (figure, axes):
        axes[0, 0].set_xlabel("time [s]")
    assert redrawn(figure) == ""
