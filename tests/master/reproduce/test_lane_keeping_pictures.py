"""The pictures of lane keeping."""

from __future__ import annotations

import pytest


@pytest.fixture
def drawn(written):
    """The figures of the page, by their stems."""
    return {picture.stem: picture.figure for picture in written[0].pictures}


def test_pictures_have_the_numbers_and_the_content_of_the_paper(written, drawn):
    captions = {picture.stem: picture.caption for picture in written[0].pictures}
    assert captions["fig7"] == "Fig. 7: desired lane and response of the vehicle"
    assert captions["fig8"] == "Fig. 8: front steering angle"
    assert captions["fig9"] == "Fig. 9: rear steering angle"
    beyond = [stem for stem, caption in captions.items() if caption.startswith("Beyond the paper: ")]
    assert beyond == ["states", "steering", "disturbances", "delay"]
    assert len(drawn["fig7"].axes[0].lines) == 2  # the reference and the displacement together


def test_words_stand_in_legends_and_no_symbols(drawn):
    for figure in drawn.values():
        texts = [
            t.get_text() for axes in figure.axes if axes.get_legend() for t in axes.get_legend().get_texts()
        ]
        assert not any(symbol in text for text in texts for symbol in "βδθω_")


def test_steering_angles_are_steps_and_of_one_range(drawn):
    (front,), (rear,) = drawn["fig8"].axes, drawn["fig9"].axes
    assert front.get_ylim() == rear.get_ylim()
    assert {line.get_drawstyle() for line in (*front.lines, *rear.lines)} == {"steps-post"}


def test_panels_side_by_side_have_one_range(drawn):
    axes = drawn["disturbances"].axes
    for left, right in zip(axes[::2], axes[1::2], strict=True):
        assert left.get_ylim() == right.get_ylim()
        assert len(left.lines) == len(right.lines) == 2
