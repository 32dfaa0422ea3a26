"""The pictures of the two-motor car, and the phase currents in them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from evcosim.master.reproduce.multi_drive_pictures import phase_currents
from evcosim.master.reproduce.render import write_page


def test_phase_currents_are_three_sines_of_the_effective_value(multi_drive_runs):
    drawn = phase_currents(multi_drive_runs["mimo"], 2.5, 2.9)
    phases = np.array([drawn[name] for name in "abc"])
    assert np.abs(phases.sum(axis=0)).max() < 1e-9
    effective = float(
        np.interp(2.7, multi_drive_runs["mimo"].time, multi_drive_runs["mimo"]["left_drive.current"])
    )
    assert np.sqrt(np.mean(phases**2)) == pytest.approx(effective, rel=1e-4)
    rising = np.count_nonzero((phases[0, :-1] < 0.0) & (phases[0, 1:] >= 0.0))
    assert rising / 0.4 == pytest.approx(148.6, abs=2.5)  # two pole pairs, gear 10, 46.66 rad/s, and the slip


def test_the_pictures_are_those_of_the_paper_and_those_beyond(multi_drive_page, tmp_path):
    stems = [picture.stem for picture in multi_drive_page.pictures]
    assert stems[8:] == [
        "battery",
        "slips",
        "cases",
        "resistance",
        "currents",
        "phases",
        "launch",
        "baseline",
        "jump",
        "coupling",
        "machine",
    ]
    beyond = [picture.caption for picture in multi_drive_page.pictures[11:] if picture.stem != "launch"]
    assert all(caption.startswith("Beyond the paper") for caption in beyond)
    for picture in multi_drive_page.pictures:  # each is drawn, and two are written, as all of a page are
        picture.figure.draw_without_rendering()
    last = dataclasses.replace(multi_drive_page, pictures=multi_drive_page.pictures[-2:])
    written = {path.name for path in write_page(last, tmp_path)}
    assert {"multi_drive.md", "multi_drive.html"} <= written
    for stem in stems[-2:]:
        assert {f"multi_drive-{stem}.png", f"multi_drive-{stem}.svg"} <= written
