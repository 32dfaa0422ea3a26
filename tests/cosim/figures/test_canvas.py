"""Empty figures for charts that are not over time."""

import matplotlib
import numpy as np
import pytest

from evcosim.cosim.figures.canvas import canvas, grid
from evcosim.cosim.figures.saving import save
from evcosim.cosim.figures.style import WIDTH, look


def test_a_chart_that_is_not_over_time_looks_like_the_others(tmp_path):
    with canvas(2, 2, height=2.0, title="chart") as (figure, axes):
        assert axes.shape == (2, 2)
        for i, one in enumerate(axes.flat):
            one.plot([0.0, 1.0], [0.0, i], **look(i))
    png, _ = save(figure, tmp_path)
    assert png.stat().st_size > 1000


@pytest.mark.parametrize("title", ["", "chart"])
def test_the_height_is_that_of_a_row_and_the_width_always_the_same(title: str) -> None:
    sizes = {}
    for rows in (1, 2, 5):
        with canvas(rows, 2, height=2.0, title=title) as (figure, axes):
            sizes[rows] = tuple(figure.get_size_inches())
            assert axes.shape == (rows, 2)
    assert {width for width, _ in sizes.values()} == {WIDTH}
    assert sizes[5][1] - sizes[2][1] == pytest.approx(3 * 2.0)
    assert (figure._suptitle is None) == (title == "")


def test_the_style_holds_within_the_block_alone() -> None:
    before = matplotlib.rcParams["axes.grid"]
    with canvas():
        assert matplotlib.rcParams["axes.grid"] is True
    assert matplotlib.rcParams["axes.grid"] == before


def test_heights_and_widths_are_in_proportion() -> None:
    figure, axes = grid(2, 2, 6.0, "", share_x=False, heights=[2.0, 1.0], widths=[3.0, 1.0])
    figure.set_layout_engine("none")
    boxes = np.array([[one.get_position().size for one in row] for row in axes])
    assert boxes[0, :, 1] == pytest.approx(2.0 * boxes[1, :, 1])
    assert boxes[:, 0, 0] == pytest.approx(3.0 * boxes[:, 1, 0])


def test_columns_that_share_an_axis_move_together() -> None:
    _, axes = grid(2, 1, 4.0, "", share_x=True)
    axes[0, 0].set_xlim(3.0, 7.0)
    assert axes[1, 0].get_xlim() == (3.0, 7.0)
