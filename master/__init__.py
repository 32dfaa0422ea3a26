"""Running what `evcosim.cosim` describes: FMUs as units, the master algorithms, the command line.

from evcosim.master import simulate, Simulation, BusVariation
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..cosim.system.variation import BusVariation
    from .simulation import Simulation, simulate

__all__ = ["BusVariation", "Simulation", "simulate"]


def __getattr__(name: str) -> Any:
    # imported on first use, so that `evcosim --help` does not load fmpy, cantools and pydantic
    if name in __all__:
        from . import simulation

        return getattr(simulation, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
