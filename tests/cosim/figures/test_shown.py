"""Figures that a notebook shows by itself."""

from __future__ import annotations

import struct
import warnings

from evcosim.cosim.figures.canvas import canvas, drawing


def size(png: bytes) -> tuple[int, int]:
    """Return width and height of a PNG file, which stand in its first chunk."""
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    return struct.unpack(">II", png[16:24])


def test_a_figure_has_a_picture_for_notebooks():
    with canvas(height=3.0, title="two") as (figure, axes):
        axes[0, 0].plot([0.0, 1.0], [1.0, 2.0])
    assert size(figure._repr_png_()) == (1000, 350)
    assert figure._repr_png_() == figure._repr_png_()


def test_so_has_a_drawing():
    with drawing(0.0, 4.0, 0.0, 2.0) as (figure, _):
        pass
    assert size(figure._repr_png_()) == (400, 200)


def test_a_letter_that_the_font_lacks_is_no_warning():
    with canvas(title="\u4e2d") as (figure, _):
        pass
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert figure._repr_png_()
