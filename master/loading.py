"""From an FMU that was read to a unit of a run: which class answers `unit.Unit` for it."""

from __future__ import annotations

from ..cosim.interface import UnitInterface
from .fmi.fmi2 import Fmi2Unit
from .fmi.fmu import Fmu
from .unit import Unit


def load_unit(fmu: Fmu, name: str, interface: UnitInterface) -> Unit:
    """Instantiate an FMU; `interface` is how the system sees it.

    Raises FmuError naming the file and the reason when it cannot run here.
    """
    return Fmi2Unit(fmu, name, interface)
