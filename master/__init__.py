"""Running what `evcosim.cosim` describes: FMUs as units, the engines, studies, the command line.

`Simulation` and `simulate` are found here too, where version 0.1 had them; `evcosim` is their place.
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = False  # a type checker takes it as true
if TYPE_CHECKING:
    from .simulation import Simulation as Simulation
    from .simulation import simulate as simulate
else:  # on first use, so that a process of an isolated unit loads neither

    def __getattr__(name: str) -> object:
        if name in ("Simulation", "simulate"):
            return getattr(importlib.import_module(".simulation", __name__), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
