"""Widths of letters: those of the font that matplotlib comes with, and enough for any other letter."""

from __future__ import annotations

import string

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from evcosim.cosim.figures.letter_widths import width

TEXTS = (string.ascii_letters, string.digits, string.punctuation, "a b", "", "VCU_ThrottleRequest")


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("bold", [False, True])
def test_letters_are_as_wide_as_those_of_the_font(text, bold):
    font = FontProperties(family="DejaVu Sans", size=10.0, weight="bold" if bold else "normal")
    drawn, _, _ = text_to_path.get_text_width_height_descent(text, font, ismath=False)
    assert width(text, 10.0, bold=bold) == pytest.approx(drawn / 72.0, rel=0.03, abs=1e-6)


def test_other_letters_have_room():
    font = FontProperties(family="DejaVu Sans", size=10.0)
    for letter in "\u2192\u00e4\u03a8\u03a9\u00b2\u0416":
        drawn, _, _ = text_to_path.get_text_width_height_descent(letter, font, ismath=False)
        assert width(letter, 10.0) >= 0.97 * drawn / 72.0, letter
    assert width("ab", 20.0) == 2.0 * width("ab", 10.0)
