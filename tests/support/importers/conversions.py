"""The connections of the built-in systems whose two ends differ in their unit of measure, and the factor."""

from __future__ import annotations

import functools
from typing import NamedTuple

from evcosim.cosim.system.system import system_names
from evcosim.cosim.units.conversion import between
from evcosim.master.cli.info_system import described


class Converted(NamedTuple):
    """A connection between FMUs; `factor` and `offset` turn a value of the first into one of the second."""

    system: str
    source: str
    source_unit: str
    target: str
    target_unit: str
    factor: float
    offset: float


@functools.cache
def converted() -> list[Converted]:
    """Return the connections with another unit at each end, of all built-in systems."""
    found = []
    for system in system_names():
        told = described(system)
        for one in told["connections"]:
            if not one["to"] or one["from_unit"] == one["to_unit"]:
                continue
            map_ = between(one["from_unit"], one["to_unit"])
            ends = (one["from"], one["from_unit"], one["to"], one["to_unit"])
            found.append(Converted(system, *ends, map_.scale, map_.offset))
    return found
