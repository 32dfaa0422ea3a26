"""The look of lines: told apart by color, dashes and width, in black and white too."""

import matplotlib
import pytest
from matplotlib.colors import to_rgb

from evcosim.cosim.figures.style import COLORS, DASHES, NAMED_DASHES, SHADES, Stroke, look, style
from evcosim.cosim.system.figure_spec import SignalSpec


def test_the_first_lines_of_a_chart_are_told_apart() -> None:
    looks = [(look(i)["color"], str(look(i)["linestyle"])) for i in range(8)]
    assert len(set(looks)) == 8
    assert look(0) == look(8)
    for part in (COLORS, [str(d) for d in DASHES]):
        assert len(set(part)) == 8


def test_a_later_line_is_never_wider_so_that_an_earlier_one_is_seen_behind_it() -> None:
    widths = [Stroke.of(i, "solid").width for i in range(8)]
    assert widths == sorted(widths, reverse=True)
    assert widths[0] > widths[1] > widths[2] > widths[-1] >= 1.0
    assert [Stroke.of(i, "solid").color for i in range(8)] == list(COLORS)


def test_the_shades_are_pale_and_the_first_ones_differ_in_gray() -> None:
    grays = [sum(w * x for w, x in zip((0.2126, 0.7152, 0.0722), to_rgb(s), strict=True)) for s in SHADES]
    assert grays[0] > grays[1] + 0.05 > grays[2] + 0.1
    assert min(grays) > 0.8  # lines stand out, black ones too
    assert len(set(SHADES)) == len(SHADES)


@pytest.mark.parametrize("name", NAMED_DASHES)
def test_a_file_may_name_each_of_the_dashes(name: str) -> None:
    assert SignalSpec.model_validate({"name": "a.x", "style": name}).style == name


def test_a_users_settings_count_for_nothing() -> None:
    with matplotlib.rc_context({"font.size": 30.0, "lines.linewidth": 9.0}):
        with style():
            assert (matplotlib.rcParams["font.size"], matplotlib.rcParams["lines.linewidth"]) == (10.0, 1.5)
        assert matplotlib.rcParams["font.size"] == 30.0
