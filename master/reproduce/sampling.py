"""A system at another step size."""

from __future__ import annotations

import dataclasses

from ...cosim.system.system import System, load_system


def sampled(name: str, step_size: float | None) -> System:
    """Return a built-in system that steps each `step_size` [s]; None: as its file says."""
    system = load_system(name)
    if step_size is None:
        return system
    experiment = system.file.experiment.model_copy(update={"step_size": step_size})
    return dataclasses.replace(system, file=system.file.model_copy(update={"experiment": experiment}))
