"""A system at another step size."""

from __future__ import annotations

from evcosim.master.reproduce.sampling import sampled


def test_the_step_size_alone_changes():
    usual, fine = sampled("lane_keeping", None), sampled("lane_keeping", 1e-3)
    assert (usual.file.experiment.step_size, fine.file.experiment.step_size) == (0.01, 1e-3)
    assert fine.file.experiment.stop_time == usual.file.experiment.stop_time
    assert fine.file.units == usual.file.units
