"""The pictures of the braking two-wheeler."""

from __future__ import annotations


def test_pictures_have_the_numbers_of_the_paper(braking_page):
    captions = {picture.stem: picture.caption for picture in braking_page.pictures}
    figures = ["fig4", "fig5", "fig6", "fig7"]
    beyond = ["ride", "lock", "vehicle", "delay"]
    assert list(captions) == ["friction", "psi", "psi-roads", "propositions", *figures, *beyond]
    letters = {"fig4": "(a)", "fig5": "(b)", "fig6": "(c)", "fig7": "(d)"}
    for stem, letter in letters.items():
        assert captions[stem].startswith(f"Fig. {stem[-1]}: {letter}")
    assert captions["friction"].startswith("Fig. 2")
    assert captions["psi"].startswith("Fig. 3")


def test_panels_side_by_side_have_one_range(braking_page):
    pictures = {picture.stem: picture.figure for picture in braking_page.pictures}
    front, rear = pictures["psi"].axes
    assert front.get_ylim() == rear.get_ylim()
    assert [len(panel.get_lines()) for panel in (front, rear)] == [3, 3]
    assert [line.get_label() for line in rear.get_lines()] == ["λ_f = 0.1", "λ_f = 0.5", "λ_f = 0.9"]
