"""Figs. 4 to 19 of the two-motor car."""

from __future__ import annotations

from evcosim.master.reproduce.multi_drive_figures import pictures


def test_each_picture_has_two_figures_with_equal_ranges(multi_drive_runs):
    drawn = pictures(multi_drive_runs)
    assert [picture.stem for picture in drawn] == [f"fig{i}-{i + 1}" for i in range(4, 20, 2)]
    for i, picture in zip(range(4, 20, 2), drawn, strict=True):
        assert picture.caption.startswith(f"Figs. {i} and {i + 1}: ")
        pid, mimo = picture.figure.axes[:2]
        assert pid.get_ylim() == mimo.get_ylim()
        assert pid.get_ylabel().startswith(f"Fig. {i}: PIDs")
        assert mimo.get_ylabel().startswith(f"Fig. {i + 1}: MIMO")
