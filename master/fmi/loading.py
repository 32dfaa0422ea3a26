"""From an FMU that was read to a unit of a run, of the class for its version and interface."""

from __future__ import annotations

from typing import Any

from ...cosim.interface import UnitInterface
from ..unit import Unit
from .fmi1 import Fmi1ModelExchange, Fmi1Unit
from .fmi2 import Fmi2ModelExchange, Fmi2Unit
from .fmi3 import Fmi3ModelExchange, Fmi3Unit
from .fmu import Fmu

_CLASSES: dict[tuple[str, str], Any] = {
    ("1", "co_simulation"): Fmi1Unit,
    ("2", "co_simulation"): Fmi2Unit,
    ("3", "co_simulation"): Fmi3Unit,
    ("1", "model_exchange"): Fmi1ModelExchange,
    ("2", "model_exchange"): Fmi2ModelExchange,
    ("3", "model_exchange"): Fmi3ModelExchange,
}


def load_unit(fmu: Fmu, name: str, interface: UnitInterface, tolerance: float | None = None) -> Unit:
    """Instantiate an FMU; `interface` is how the system sees it, `tolerance` the relative one of its solver.

    Raises FmuError naming the file and the reason when it cannot run here.
    """
    made = _CLASSES[fmu.description.fmiVersion[0], fmu.interface_type]
    unit: Unit = made(fmu, name, interface, tolerance)
    return unit
