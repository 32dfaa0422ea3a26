"""Figs. 4 to 7 of the braking paper."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.master.reproduce import braking_maneuvers


def test_the_estimated_slips_are_those_of_the_controller(braking_runs):
    """By (16), where the controller sees v_hat; its own are those of the bus."""
    results = braking_runs["front_only"]
    fast = results["vehicle.speed"][:-1] > 2.0
    front, rear = braking_maneuvers.estimated_slips(results)
    assert front[:-1][fast] == pytest.approx(results["controller.front_slip_estimate"][:-1][fast], abs=2e-3)
    assert np.abs(rear).max() < 1e-4  # the rear wheel gives the estimate


def test_locked_wheels_have_an_estimate_of_0(braking_runs):
    results = braking_runs["estimated_speed"]
    locked = results["vehicle.rear_wheel_speed"] + results["vehicle.front_wheel_speed"] == 0.0
    assert locked.any()
    assert all(not slip[locked].any() for slip in braking_maneuvers.estimated_slips(results))


def test_each_figure_has_both_plants_with_one_range_and_ends_before_the_standstill(braking_runs):
    drawn = {picture.stem: picture for picture in braking_maneuvers.pictures(braking_runs)}
    assert list(drawn) == ["fig4", "fig5", "fig6", "fig7", "ride"]
    for stem in ("fig4", "fig5", "fig6", "fig7"):
        above, below = drawn[stem].figure.axes
        assert above.get_ylim() == below.get_ylim()
        assert len(above.get_lines()) == len(below.get_lines()) == 4
        assert [line.get_drawstyle() for line in below.get_lines()] == ["default"] * 2 + ["steps-post"] * 2
    slips = [line.get_ydata() for panel in drawn["fig4"].figure.axes for line in panel.get_lines()]
    assert max(slip.max() for slip in slips) < 0.5  # nothing locks down to 2 m/s
