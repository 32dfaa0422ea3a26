"""The pictures of the braking two-wheeler."""

from __future__ import annotations


def test_pictures_have_the_numbers_of_the_paper(braking_page):
    captions = {picture.stem: picture.caption for picture in braking_page.pictures}
    figures = ["fig4", "fig5", "fig6", "fig7"]
    assert list(captions) == ["friction", "psi", "propositions", *figures, "lock", "vehicle", "delay"]
    letters = {"fig4": "(a)", "fig5": "(b)", "fig6": "(c)", "fig7": "(d)"}
    for stem, letter in letters.items():
        assert captions[stem].startswith(f"Fig. {stem[-1]}: {letter}")
    assert captions["friction"].startswith("Fig. 2")
    assert captions["psi"].startswith("Fig. 3")
