"""A system with a variation of all its buses, beside what its file says of each (`[buses.NAME]`)."""

from __future__ import annotations

import dataclasses

from ..can.bus_settings import BusVariation
from ..errors import ConfigError
from .system import System


def varied(system: System, variation: BusVariation, step_size: float) -> System:
    """Return the system with the variation on all its buses; `step_size` is the run's [s].

    Raises ConfigError when the system has no bus, where every variation would look harmless.
    """
    if not system.file.buses:
        raise ConfigError(f"{system.path}: a variation of its buses was asked for, but the system has none")
    buses = {name: variation.of(entry, step_size) for name, entry in system.file.buses.items()}
    return dataclasses.replace(system, file=system.file.model_copy(update={"buses": buses}))
