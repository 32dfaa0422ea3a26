"""Built-in systems whose frames take time."""

from __future__ import annotations

import dataclasses
from typing import Any

from evcosim.cosim.system.system import System, load_system


def timed(name: str, **more: Any) -> System:
    """A built-in system whose buses all have `timing = "frame"`, unless it is given, and more settings."""
    system = load_system(name)
    buses = {
        bus: entry.model_copy(update={"timing": "frame"} | more) for bus, entry in system.file.buses.items()
    }
    return dataclasses.replace(system, file=system.file.model_copy(update={"buses": buses}))
