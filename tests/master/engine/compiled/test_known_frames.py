"""What a structure knows of frames: layouts, but neither counters nor what parameters change."""

from __future__ import annotations

import pytest

from evcosim.cosim.can.wire import tables as T
from evcosim.master.engine.compiled.known_frames import Frames, frames_of
from evcosim.master.simulation import Simulation

pytestmark = pytest.mark.usefixtures("warm_units")


def frames(steps: int = 0, **options: object) -> Frames:
    """What is known of the frames of lane keeping after some steps."""
    with Simulation("lane_keeping", engine="compiled", isolation="none", **options) as simulation:
        simulation.step(steps)
        arrays = simulation._engine.frames.arrays
        found = frames_of(arrays)
        assert found is not None
        assert found.known("messages", T.PROFILE) == arrays["messages"][0, T.PROFILE] > 0
        return found


def test_it_does_not_change_in_a_run() -> None:
    assert frames(0).text == frames(50).text
    assert frames(stop_time=1.0).text == frames().text


def test_what_changes_is_not_known() -> None:
    found = frames()
    for column in (T.COUNTER, T.SENT, T.ARRIVED, T.INSTANCE, T.MAX_DELTA):
        assert found.known("messages", column) is None
    assert found.known("frame", 0) is None and not found.is_fixed("frame", 0)
    assert found.is_fixed("reals", 0) and found.is_fixed("state", T.STEP_TIME)
    assert not found.is_fixed("state", T.LOG_ROWS)
