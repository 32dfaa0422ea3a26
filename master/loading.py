"""From an FMU that was read to a unit of a run: which class answers `unit.Unit` for it."""

from __future__ import annotations

from collections.abc import Callable

from ..cosim.interface import UnitInterface
from .fmi.fmi1 import Fmi1Unit
from .fmi.fmi2 import Fmi2Unit
from .fmi.fmi3 import Fmi3Unit
from .fmi.fmu import Fmu
from .unit import Unit

_CO_SIMULATION: dict[str, Callable[[Fmu, str, UnitInterface], Unit]] = {
    "1": Fmi1Unit,
    "2": Fmi2Unit,
    "3": Fmi3Unit,
}


def load_unit(fmu: Fmu, name: str, interface: UnitInterface) -> Unit:
    """Instantiate an FMU; `interface` is how the system sees it.

    Raises FmuError naming the file and the reason when it cannot run here.
    """
    return _CO_SIMULATION[fmu.description.fmiVersion[0]](fmu, name, interface)
